// Stands in for load_module.cpp where the program is built without SUPPLE_DICOM.
#include "volumes/base/error.h"
#include "volumes/dicom/dicom.h"

namespace supple {

std::unique_ptr<VolumeFile> open_dicom(const std::string& path, const ReadOptions&) {
  throw InputError({path, "format", "DICOM, which this program was built without",
                    "another format, or a program built with SUPPLE_DICOM=ON"});
}

}  // namespace supple
