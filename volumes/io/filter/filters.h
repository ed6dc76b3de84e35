// Filters between a volume file and its reader: each reads the slices of another file and gives its
// own, so that a chain of them needs no more memory than the slices that the filters look at.
#pragma once

#include <memory>
#include <optional>

#include "volumes/base/fields.h"
#include "volumes/base/progress.h"
#include "volumes/io/format/volume_file.h"

namespace supple {

/// The voxels of the box, scalars or vectors, with their values and places as they are. Throws
/// InputError (field "box") where the box is empty or leaves the volume.
std::unique_ptr<VolumeFile> crop(std::unique_ptr<VolumeFile> file, const IndexBox& box);

/// The smallest box around all voxels with a density within [lo, hi], grown by `margin_mm` inside
/// the volume. Reads the whole file. Throws InputError (field "range") where there is none.
IndexBox box_of_densities(VolumeFile& file, double lo, double hi, double margin_mm,
                          Progress* progress = nullptr);

/// Convolution with a Gaussian of that standard deviation along each index axis, cut off at four
/// deviations. At the border of the volume, and beside values that are not finite, the weights that
/// are left are scaled to a sum of 1. The type stays; integers are rounded. Throws InputError
/// (field "sigma"): not positive, or over 1000 voxels. Cost: two slices in doubles for every voxel
/// of the cut-off along k.
std::unique_ptr<VolumeFile> smooth(std::unique_ptr<VolumeFile> file, double sigma_mm);

enum class ResampleKernel { linear, nearest, cubic };

/// The same box with other voxel sizes: outer faces of the first voxels stay where they are, counts
/// are rounded. Linear along each axis; where voxels grow, the kernel grows with them, so that no
/// value is skipped. `nearest` is for labels; `cubic` passes through all voxels, keeps edges sharp
/// and may overshoot beside them. Throws InputError (field "spacing") for a spacing that is no
/// length, or one that gives more than 2^31 - 1 voxels along an axis.
std::unique_ptr<VolumeFile> with_spacing(std::unique_ptr<VolumeFile> file, const Vec3d& spacing_mm,
                                         ResampleKernel interpolation = ResampleKernel::linear);

/// Range of densities that stay, and the replacement of the others.
struct Threshold {
  double lo = 0, hi = 0;          // both belong to the range
  std::optional<double> outside;  // rounded into the file's type; none: `minimum` of the volume
  bool is_mask = false;           // 1 and 0 as uint8 in place of the densities
};
/// NaN lies in no range. `minimum`: of the volume, for a threshold without `outside`.
std::unique_ptr<VolumeFile> threshold(std::unique_ptr<VolumeFile> file, const Threshold& range,
                                      double minimum);

}  // namespace supple
