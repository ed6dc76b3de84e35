// A volume on the grid of another one, of any place, spacing and direction, or seen through vectors
// on it.
#pragma once

#include <memory>

#include "volumes/base/progress.h"
#include "volumes/field/dense/resample.h"
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

/// The same at the place where a vector in mm LPS leads from each voxel of the grid. Only the box
/// of the volume that is read so is loaded, and the smallest value is that of the box. `vectors` is
/// asked for all slices twice, and must outlive the result. Throws InputError (field "grid"), too,
/// where all vectors lead out of the volume.
std::unique_ptr<VolumeFile> on_grid(std::unique_ptr<VolumeFile> file, const Geometry& grid,
                                    const VectorSliceSource& vectors, ResampleKernel interpolation,
                                    Progress* progress = nullptr);

/// Memory that the first takes for the volume.
std::int64_t on_grid_bytes(const Geometry& volume);

}  // namespace supple
