// ITK transform files with one displacement field, as ITK, ANTs and write_warp write them.
#pragma once

#include <memory>

#include "volumes/io/hdf5/plugin/hdf5_file.h"

namespace supple {

/// A volume of 3 components: vectors in mm along L, P, S on the field's grid. Linear transforms
/// around the field in a CompositeTransform are taken into it without loss: see itk_transform.cpp.
/// Throws InputError for other transforms, several fields, or none.
std::unique_ptr<VolumeFile> open_itk_transform(std::shared_ptr<const hdf5::Hdf5File> file,
                                               const ReadOptions& options);

}  // namespace supple
