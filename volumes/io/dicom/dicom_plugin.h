// Interface between the program and its DICOM plugin (volumes/base/plugin.h).
#pragma once

#include <memory>
#include <string>

#include "volumes/base/plugin.h"
#include "volumes/io/format/volume_file.h"

namespace supple {

struct DicomPlugin {
  static constexpr PluginName kName{"supple_dicom.so", "supple_dicom_plugin", "reads DICOM"};
  static constexpr std::array<std::size_t, 2> kSizes{sizeof(VolumeHeader), sizeof(ReadOptions)};

  std::array<std::size_t, 2> sizes;
  std::unique_ptr<VolumeFile> (*open)(const std::string& path, const ReadOptions& options);
};

}  // namespace supple
