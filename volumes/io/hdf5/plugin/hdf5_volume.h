// Volumes and warps of an HDF5 file.
#pragma once

#include <memory>
#include <string>

#include "volumes/io/format/volume_file.h"

namespace supple::hdf5 {

/// The volume that `options` choose in the file `name`; `path` is as the user gave it, `name` or
/// "name:/dataset". Throws InputError.
std::unique_ptr<VolumeFile> open_file(const std::string& name, const std::string& path,
                                      const ReadOptions& options);

}  // namespace supple::hdf5
