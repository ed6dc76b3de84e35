# `cpack` in the build folder of the preset `portable` makes the Debian packages: supple, and
# python3-supple, which depends on one version of Python.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME supple)
set(CPACK_PACKAGE_VENDOR "Supple")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION "Supple drags, cuts and relaxes the voxels of a scan themselves,
by Enhanced ChainMail, relaxation, springs and finite elements, and
shows them deformed without resampling. Deformations go to ITK,
elastix, 3D Slicer and ANTs as offset fields.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/cmake/triggers)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PROJECT_BINARY_DIR}/lib)
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "libimath-dev, ffmpeg")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL Unspecified)
set(CPACK_DEBIAN_UNSPECIFIED_PACKAGE_NAME supple)
if(SUPPLE_PYTHON)
  find_package(Python3 COMPONENTS Interpreter QUIET)
  list(APPEND CPACK_COMPONENTS_ALL python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-supple)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS python3-nibabel)
  set(CPACK_DEBIAN_PYTHON_DESCRIPTION "The package supple of Python: volumes, deformations and
pictures as arrays of numpy, with the sessions, warps, metrics and scenes of
the command line.")
  math(EXPR next "${Python3_VERSION_MINOR} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "supple (= ${PROJECT_VERSION}), python3-numpy, python3 (>= \
${Python3_VERSION_MAJOR}.${Python3_VERSION_MINOR}~), python3 (<< ${Python3_VERSION_MAJOR}.${next})")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/cmake/python3-supple/postinst
                                                ${PROJECT_SOURCE_DIR}/cmake/python3-supple/prerm)
endif()
include(CPack)
