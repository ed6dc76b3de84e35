// Loads the module that reads DICOM: beside the program, or in ../lib/supple of its folder.
// Cost: about 15 ms and 8 MB, once, when the first DICOM file is met.
#include <filesystem>
#include <vector>

#include <dlfcn.h>

#include "volumes/base/error.h"
#include "volumes/dicom/dicom.h"
#include "volumes/dicom/dicom_module.h"

namespace supple {

namespace {

std::filesystem::path program_folder() {
  std::error_code error;
  return std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
}

const DicomModule& load_module() {
  const std::filesystem::path folder = program_folder();
  const std::vector<std::filesystem::path> places = {
      folder / kDicomModuleFile, folder.parent_path() / "lib" / "supple" / kDicomModuleFile};
  for (const std::filesystem::path& place : places) {
    std::error_code unknown;
    if (!std::filesystem::exists(place, unknown)) continue;
    // Never closed: volumes that it made and exceptions in flight use its code.
    void* module = dlopen(place.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (module == nullptr) throw SystemError(place.string() + ": " + dlerror());
    const auto* entry = static_cast<const DicomModule*>(dlsym(module, kDicomModuleSymbol));
    if (entry == nullptr || entry->header_bytes != sizeof(VolumeHeader) ||
        entry->options_bytes != sizeof(ReadOptions)) {
      throw SystemError(place.string() + ": this module belongs to another build of the program");
    }
    return *entry;
  }
  throw SystemError(places.front().string() + ": the module that reads DICOM is missing");
}

}  // namespace

std::unique_ptr<VolumeFile> open_dicom(const std::string& path, const ReadOptions& options) {
  static const DicomModule& module = load_module();
  return module.open(path, options);
}

}  // namespace supple
