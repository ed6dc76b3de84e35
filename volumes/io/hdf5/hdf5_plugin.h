// Interface between the program and its HDF5 plugin (volumes/base/plugin.h).
#pragma once

#include <memory>
#include <string>

#include "volumes/base/plugin.h"
#include "volumes/io/format/dense_writer.h"
#include "volumes/io/format/volume_file.h"

namespace supple {

struct Hdf5Plugin {
  static constexpr PluginName kName{"supple_hdf5.so", "supple_hdf5_plugin",
                                    "reads and writes HDF5"};
  static constexpr std::array<std::size_t, 4> kSizes{sizeof(VolumeHeader), sizeof(ReadOptions),
                                                     sizeof(DenseImage), sizeof(WriteOptions)};

  std::array<std::size_t, 4> sizes;
  /// `path` is as the user gave it, `name` the file in it; the rest names a dataset. Throws
  /// InputError. A damaged file may crash the library.
  std::unique_ptr<VolumeFile> (*open)(const std::string& name, const std::string& path,
                                      const ReadOptions& options);
  /// Throws InputError and SystemError as create_dense.
  std::unique_ptr<DenseWriter> (*create)(const std::string& path, const DenseImage& image,
                                         const WriteOptions& options);
};

/// The plugin's entry; throws SystemError where the plugin cannot be loaded.
const Hdf5Plugin& hdf5_plugin();

}  // namespace supple
