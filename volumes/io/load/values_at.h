// The densities of a few voxels of a file.
#pragma once

#include <vector>

#include "volumes/io/format/volume_file.h"

namespace supple {

/// Values in the order of the voxels, which must lie in the volume; NaN where the file holds no
/// number. Cost: reading the file, from where it stands, up to the last of their slices.
std::vector<float> values_at(VolumeFile& file, const std::vector<Vec3i>& voxels);

}  // namespace supple
