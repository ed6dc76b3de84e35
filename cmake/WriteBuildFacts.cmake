# Run by every build, since the commit changes between configurations; the header changes only with
# what it says. INPUT, OUTPUT and SOURCE_DIR are given; SUPPLE_LIBRARIES goes through.
set(SUPPLE_COMMIT "")
find_program(GIT git)
if(GIT)
  execute_process(COMMAND ${GIT} -C ${SOURCE_DIR} rev-parse --short=12 HEAD
                  OUTPUT_VARIABLE SUPPLE_COMMIT OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
endif()
if(SUPPLE_COMMIT STREQUAL "")
  set(SUPPLE_COMMIT unknown)
endif()
configure_file(${INPUT} ${OUTPUT} @ONLY)
