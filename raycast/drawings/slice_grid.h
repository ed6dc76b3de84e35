// Grids of slices, oriented as radiologists look at them: axial and coronal with the patient's left
// on the right, sagittal with posterior on the right; superior up, anterior up in axial ones. Such
// a slice lies in a plane of voxels, that of the grid axes nearest to the patient's; an oblique one
// lies anywhere. All have square pixels.
#pragma once

#include <optional>
#include <vector>

#include "volumes/geometry/geometry.h"

namespace supple {

enum class SlicePlane { axial, coronal, sagittal };

/// Unit vectors of a picture's rows, to the right, and columns, downwards; right x down points away
/// from the viewer.
struct SliceAxes {
  Vec3d right, down;
};
SliceAxes slice_axes(const Geometry& geometry, SlicePlane plane);
/// Axes of the plane across `normal_lps`, which points to the viewer. `up`: by default superior,
/// for planes within 25 degrees of an axial one anterior. Throws InputError: no direction, `up`
/// along the normal.
SliceAxes oblique_axes(const Vec3d& normal_lps, const std::optional<Vec3d>& up_lps);

/// The grid of one slice whose voxels (x, y, 0) are the pixels: the plane through a voxel position,
/// as far as the source box reaches. A pixel lies on that position. Throws InputError: a position
/// outside the box, more than 16384 pixels a side, pixel_mm not positive.
Geometry slice_grid(const Geometry& geometry, const SliceAxes& axes, const Vec3d& through_index,
                    double pixel_mm);
Geometry slice_grid(const Geometry& geometry, SlicePlane plane, const Vec3d& through_index,
                    double pixel_mm);

/// Slices of these axes that lie evenly from one side of the box to the other, each in the middle
/// of its share; or `every_mm` apart about `through_index`, those outside the box left out. The
/// place of each in the index frame, on the line through `through_index`, along right x down.
std::vector<Vec3d> stacked_places(const Geometry& geometry, const SliceAxes& axes,
                                  const Vec3d& through_index, int count,
                                  const std::optional<double>& every_mm);

}  // namespace supple
