// Orthogonal slices as radiologists look at them: axial and coronal with the patient's left on the
// right, sagittal with posterior on the right; superior up, anterior up in axial ones. A slice lies
// in a plane of voxels, that of the grid axes nearest to the patient's, and has square pixels.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "raycast/pictures/image.h"
#include "volumes/geometry/geometry.h"
#include "volumes/grid/brick_topology.h"

namespace supple {

enum class SlicePlane { axial, coronal, sagittal };

/// Densities that map to black and white, and the rim of the material at rest.
struct SliceStyle {
  double grey_lo = 0, grey_hi = 255;
  const BrickTopology* rest = nullptr;  // whose outline is drawn; null: none
  std::array<std::uint8_t, 3> outline = {255, 200, 0};

  /// Throws InputError unless grey_lo and grey_hi are finite and ascending.
  void validate() const;
};

/// The grid of one slice whose voxels (x, y, 0) are the pixels: the plane through a voxel position,
/// over the whole source box. A pixel lies on that position. Throws InputError: a position outside
/// the box, more than 16384 pixels a side, pixel_mm not positive.
Geometry slice_grid(const Geometry& geometry, SlicePlane plane, const Vec3d& through_index,
                    double pixel_mm);

/// A density at a position of the volume's index space.
using DensityAt = std::function<float(const Vec3d& index)>;

/// The densities on a slice's grid as an opaque grey picture, one call per pixel, all threads.
Image draw_slice(const Geometry& geometry, const Geometry& slice, const DensityAt& density,
                 const SliceStyle& style);

/// Pictures from left to right, top edges aligned, on black.
Image side_by_side(const std::vector<Image>& images, int gap);

}  // namespace supple
