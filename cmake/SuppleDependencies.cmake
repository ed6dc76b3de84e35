# Third-party packages. docs/building.md names the Debian package of each.
find_package(Threads REQUIRED)
find_package(TBB CONFIG REQUIRED)
find_package(Eigen3 3.4 CONFIG REQUIRED)
find_path(SPECTRA_INCLUDE_DIR Spectra/SymGEigsShiftSolver.h REQUIRED)
find_package(Imath CONFIG REQUIRED)
find_package(embree 3.13 CONFIG REQUIRED)
find_package(hwy CONFIG REQUIRED)
find_package(OpenCV REQUIRED COMPONENTS core imgproc)
find_package(OpenSSL REQUIRED COMPONENTS Crypto)
find_package(ZLIB REQUIRED)
find_package(BZip2 REQUIRED)
find_package(HDF5 REQUIRED COMPONENTS C)
find_package(PNG REQUIRED)
find_package(OpenEXR CONFIG REQUIRED)
find_package(TIFF REQUIRED)
find_package(pugixml CONFIG REQUIRED)
find_package(CLI11 REQUIRED)
find_package(tomlplusplus REQUIRED)
# Compiled once, in lib/material/toml_table.cpp.
target_compile_definitions(tomlplusplus::tomlplusplus INTERFACE TOML_HEADER_ONLY=0)
find_package(nlohmann_json REQUIRED)
# Debian's package of libjpeg-turbo has no CMake file for this interface of it.
find_path(TURBOJPEG_INCLUDE_DIR turbojpeg.h REQUIRED)
find_library(TURBOJPEG_LIBRARY turbojpeg REQUIRED)
add_library(TurboJPEG::turbojpeg UNKNOWN IMPORTED)
set_target_properties(TurboJPEG::turbojpeg PROPERTIES
  IMPORTED_LOCATION ${TURBOJPEG_LIBRARY}
  INTERFACE_INCLUDE_DIRECTORIES ${TURBOJPEG_INCLUDE_DIR})

# Debian's FindOpenVDB.cmake brings its own FindTBB and switches delayed loading on; an imported
# target by hand avoids both.
find_path(OPENVDB_INCLUDE_DIR openvdb/openvdb.h REQUIRED)
find_library(OPENVDB_LIBRARY openvdb REQUIRED)
find_library(LOG4CPLUS_LIBRARY log4cplus REQUIRED)  # where Debian's OpenVDB sends its messages
add_library(OpenVDB::openvdb UNKNOWN IMPORTED)
set_target_properties(OpenVDB::openvdb PROPERTIES
  IMPORTED_LOCATION ${OPENVDB_LIBRARY}
  INTERFACE_SYSTEM_INCLUDE_DIRECTORIES ${OPENVDB_INCLUDE_DIR}
  INTERFACE_COMPILE_DEFINITIONS OPENVDB_ABI_VERSION_NUMBER=10
  INTERFACE_LINK_LIBRARIES "TBB::tbb;Imath::Imath")

# Debian's NIFTI package config names a znz path that does not exist.
find_path(NIFTI2_INCLUDE_DIR nifti/nifti2_io.h REQUIRED)
find_library(NIFTI2_LIBRARY nifti2 REQUIRED)
find_library(ZNZ_LIBRARY znz REQUIRED)
add_library(NIFTI::nifti2 UNKNOWN IMPORTED)
set_target_properties(NIFTI::nifti2 PROPERTIES
  IMPORTED_LOCATION ${NIFTI2_LIBRARY}
  INTERFACE_INCLUDE_DIRECTORIES "${NIFTI2_INCLUDE_DIR};${NIFTI2_INCLUDE_DIR}/nifti"
  INTERFACE_LINK_LIBRARIES "${ZNZ_LIBRARY};ZLIB::ZLIB")

if(SUPPLE_DICOM)
  find_package(DCMTK CONFIG REQUIRED)
  find_package(OpenJPEG CONFIG REQUIRED)
endif()

if(SUPPLE_TESTS)
  find_package(GTest REQUIRED)
endif()
