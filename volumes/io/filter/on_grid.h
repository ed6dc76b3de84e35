// A volume on the grid of another one, of any place, spacing and direction.
#pragma once

#include <memory>

#include "volumes/base/progress.h"
#include "volumes/io/filter/filters.h"

namespace supple {

/// Each voxel of the grid takes the density at its place: of the nearest voxel, or trilinear.
/// Places less than half a voxel outside of the volume belong to its border, as in ITK; beyond that
/// they hold the smallest value of the volume. Values that are not finite have no weight; where
/// they had more than half of it the result is NaN. The type stays; integers are rounded. Where the
/// grid is coarser nothing is averaged (with_spacing does). Throws InputError (field
/// "interpolation") for a cubic one. Cost: 8 bytes per voxel of the volume, which is read at once.
std::unique_ptr<VolumeFile> on_grid(std::unique_ptr<VolumeFile> file, const Geometry& grid,
                                    ResampleKernel interpolation, Progress* progress = nullptr);

/// Memory that this takes for the volume.
std::int64_t on_grid_bytes(const Geometry& volume);

}  // namespace supple
