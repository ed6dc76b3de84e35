# The library for host programs: libsupple.so with everything but the command line, its headers below
# <supple/...>, a CMake package and a pkg-config file.
include(CMakePackageConfigHelpers)

file(WRITE ${PROJECT_BINARY_DIR}/supple_library.cpp "")
add_library(supple_library SHARED ${PROJECT_BINARY_DIR}/supple_library.cpp)
add_library(supple::supple ALIAS supple_library)
target_link_libraries(supple_library PRIVATE supple_scene supple_raycast supple_lib supple_volumes)
set_property(TARGET supple_library PROPERTY LINK_LIBRARY_OVERRIDE
             "WHOLE_ARCHIVE,supple_volumes,supple_lib,supple_raycast,supple_scene")
target_link_options(supple_library PRIVATE
                    -Wl,--version-script=${PROJECT_SOURCE_DIR}/cmake/library.map)
# Public headers take their vectors from Imath.
target_link_libraries(supple_library PUBLIC Imath::Imath)
target_include_directories(supple_library INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
target_compile_features(supple_library INTERFACE cxx_std_17)
set_target_properties(supple_library PROPERTIES
  OUTPUT_NAME supple EXPORT_NAME supple VERSION ${PROJECT_VERSION}
  SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}
  LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/lib)

set(plugins supple_hdf5 supple_pictures)
if(SUPPLE_DICOM)
  list(APPEND plugins supple_dicom)
endif()
install(TARGETS supple_library EXPORT SuppleTargets LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
# The same library for newer processors: the loader takes it from glibc-hwcaps where the processor
# has the level (glibc 2.33 and later), for the program, too, which uses the shared library then.
if(SUPPLE_LEVELS)
  if(SUPPLE_BENCH)
    message(FATAL_ERROR "SUPPLE_LEVELS with SUPPLE_BENCH: benchmarks link the library statically")
  endif()
  include(ExternalProject)
  foreach(level IN LISTS SUPPLE_LEVELS)
    set(folder ${PROJECT_BINARY_DIR}/${level})
    ExternalProject_Add(supple_${level}
      SOURCE_DIR ${PROJECT_SOURCE_DIR} BINARY_DIR ${folder} BUILD_ALWAYS ON INSTALL_COMMAND ""
      CMAKE_ARGS -DCMAKE_BUILD_TYPE=${CMAKE_BUILD_TYPE} -DCMAKE_CXX_COMPILER=${CMAKE_CXX_COMPILER}
                 -DCMAKE_C_COMPILER=${CMAKE_C_COMPILER} -DCMAKE_CXX_FLAGS=${CMAKE_CXX_FLAGS}
                 -DCMAKE_PREFIX_PATH=${CMAKE_PREFIX_PATH} -DSUPPLE_DICOM=${SUPPLE_DICOM}
                 -DCMAKE_CXX_COMPILER_LAUNCHER=${CMAKE_CXX_COMPILER_LAUNCHER}
                 -DCMAKE_SHARED_LINKER_FLAGS=-s -DSUPPLE_NATIVE=OFF
                 -DSUPPLE_LEVEL=${level} -DSUPPLE_TESTS=OFF -DSUPPLE_BENCH=OFF
      BUILD_COMMAND ${CMAKE_COMMAND} --build ${folder} --target supple_library
      DEPENDS supple_library supple supple-lab ${plugins})  # each build takes all processors
    set(soname libsupple.so.${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
    install(FILES ${folder}/lib/libsupple.so.${PROJECT_VERSION} RENAME ${soname}
            DESTINATION ${CMAKE_INSTALL_LIBDIR}/glibc-hwcaps/${level})
  endforeach()
endif()
install(TARGETS ${plugins} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/supple)
set_target_properties(supple supple-lab supple-examples PROPERTIES
  INSTALL_RPATH "$ORIGIN/../${CMAKE_INSTALL_LIBDIR}")
install(TARGETS supple supple-lab supple-examples RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
# Pages with the scenes, materials and cameras that they name, without their pictures.
install(FILES CHANGELOG.md README.md cmake/copyright DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR} PATTERN "*.png" EXCLUDE)
install(FILES tools/slicer/SuppleView.py DESTINATION ${CMAKE_INSTALL_DATADIR}/supple/slicer)
install(DIRECTORY examples DESTINATION ${CMAKE_INSTALL_DOCDIR})
set(CPACK_PACKAGE_CONTACT "Supple developers <supple@example.org>")
# The program writes its manual page and completions itself.
install(CODE "
  set(zsh site-functions)
  if(\"\${CMAKE_INSTALL_PREFIX}\" STREQUAL /usr)
    set(zsh vendor-completions)  # Debian's zsh looks there for those of packages
  endif()
  foreach(page \"--manual|${CMAKE_INSTALL_MANDIR}/man1/supple.1\"
      \"--completion;bash|${CMAKE_INSTALL_DATADIR}/bash-completion/completions/supple\"
      \"--completion;zsh|${CMAKE_INSTALL_DATADIR}/zsh/\${zsh}/_supple\"
      \"--completion;fish|${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d/supple.fish\")
    string(REGEX REPLACE \"\\\\|.*\" \"\" kind \"\${page}\")
    string(REGEX REPLACE \".*\\\\|\" \"\" place \"\${page}\")
    execute_process(COMMAND ${PROJECT_BINARY_DIR}/bin/supple help \${kind}
                    OUTPUT_VARIABLE text COMMAND_ERROR_IS_FATAL ANY)
    file(WRITE \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/\${place}\" \"\${text}\")
  endforeach()
  set(changelog \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_DOCDIR}/changelog\")
  string(TIMESTAMP date \"%a, %d %b %Y %H:%M:%S +0000\" UTC)
  file(WRITE \"\${changelog}\" \"supple (${PROJECT_VERSION}) unstable; urgency=medium\\n\\n\"
    \"  * See CHANGELOG.md.\\n\\n -- ${CPACK_PACKAGE_CONTACT}  \${date}\\n\")
  execute_process(COMMAND gzip -9nf \"\${changelog}\"
    \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_MANDIR}/man1/supple.1\"
    COMMAND_ERROR_IS_FATAL ANY)")

# Headers: `#include "volumes/…"` of the source becomes `#include <supple/volumes/…>`.
install(CODE "
  set(source \"${PROJECT_SOURCE_DIR}\")
  set(generated \"${PROJECT_BINARY_DIR}/generated\")
  set(target \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_INCLUDEDIR}/supple\")
  include(\"${PROJECT_SOURCE_DIR}/cmake/InstallHeaders.cmake\")")

install(EXPORT SuppleTargets NAMESPACE supple:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/supple)
configure_package_config_file(cmake/suppleConfig.cmake.in ${PROJECT_BINARY_DIR}/suppleConfig.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/supple)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/suppleConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/suppleConfig.cmake ${PROJECT_BINARY_DIR}/suppleConfigVersion.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/supple)
# Found from where the file lies, so that an installed tree may be moved.
file(RELATIVE_PATH SUPPLE_PREFIX_OF_PC /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
string(REGEX REPLACE "/$" "" SUPPLE_PREFIX_OF_PC "${SUPPLE_PREFIX_OF_PC}")
configure_file(cmake/supple.pc.in ${PROJECT_BINARY_DIR}/supple.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/supple.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
