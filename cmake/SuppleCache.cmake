# Compilers behind ccache, where it is installed and works, and nothing else was chosen. A clone in another
# folder hits, too: paths are relative to the source, and precompiled headers are known by their contents.
find_program(SUPPLE_CCACHE ccache)
mark_as_advanced(SUPPLE_CCACHE)
if(SUPPLE_CCACHE AND NOT DEFINED CMAKE_CXX_COMPILER_LAUNCHER)
  # It fails where it may not write its folder.
  execute_process(COMMAND ${SUPPLE_CCACHE} ${CMAKE_CXX_COMPILER} -x c++ -c /dev/null -o ${PROJECT_BINARY_DIR}/ccache.o
                  RESULT_VARIABLE failed OUTPUT_QUIET ERROR_QUIET)
  if(failed EQUAL 0)
    set(CMAKE_CXX_COMPILER_LAUNCHER
        ${CMAKE_COMMAND} -E env CCACHE_BASEDIR=${PROJECT_SOURCE_DIR} CCACHE_NOHASHDIR=1
        CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime ${SUPPLE_CCACHE})
    add_compile_options($<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>
                        "$<$<CXX_COMPILER_ID:Clang>:SHELL:-Xclang -fno-pch-timestamp>")
  endif()
endif()
