// What program and module agree on (volumes/base/module.h).
#pragma once

#include <memory>
#include <string>

#include "volumes/base/module.h"
#include "volumes/io/volume_file.h"

namespace supple {

struct DicomModule {
  static constexpr ModuleName kName{"supple_dicom.so", "supple_dicom_module", "reads DICOM"};
  static constexpr std::array<std::size_t, 2> kSizes{sizeof(VolumeHeader), sizeof(ReadOptions)};

  std::array<std::size_t, 2> sizes;
  std::unique_ptr<VolumeFile> (*open)(const std::string& path, const ReadOptions& options);
};

}  // namespace supple
