// For voxels of the source: the nearest void voxel inside the source box (design.md section 2: a
// vacated voxel of a dense export shows air, not the tissue that was there).
//
// Exact Euclidean feature transform, one axis at a time: nearest along k, then lower envelopes of
// parabolas along j and i (Felzenszwalb and Huttenlocher 2012, with the place of the minimum kept).
// It runs in a window around the wanted voxels that grows until no void voxel beyond it can be
// nearer. Distances are in mm along the axes; on a sheared grid the axes count as perpendicular.
// Cost: about 30 ns and 4 bytes per voxel of the window (one core).
#pragma once

#include "volumes/field/offset_field.h"

namespace supple {

/// Vectors from each voxel of `wanted` to the nearest voxel of the box [0, dims) that is not active
/// in `source`; invalid where the box has none. Voxels of `wanted` outside the box are left out.
VectorBricks nearest_void(const BrickTopology& source, const BrickTopology& wanted,
                          const Vec3i& dims, const Vec3d& spacing_mm);

}  // namespace supple
