// What program and module agree on. The module carries its own copies of the few sources of
// volumes/ that it needs; objects cross the border through VolumeFile's virtual functions and as
// exceptions.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "volumes/io/volume_file.h"

namespace supple {

struct DicomModule {
  std::size_t header_bytes;  // sizeof(VolumeHeader): program and module are of one build
  std::size_t options_bytes;
  std::unique_ptr<VolumeFile> (*open)(const std::string& path, const ReadOptions& options);
};

/// The module's only exported symbol, a DicomModule.
constexpr const char* kDicomModuleSymbol = "supple_dicom_module";
constexpr const char* kDicomModuleFile = "supple_dicom.so";

}  // namespace supple
