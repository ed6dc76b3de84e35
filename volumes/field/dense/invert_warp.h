// The inverse of a dense warp of any program, with certificate.
#pragma once

#include "volumes/field/dense/warp.h"
#include "volumes/field/inversion/invert.h"
#include "volumes/geometry/geometry.h"

namespace supple {

/// The warp as a displacement of the voxels of its own grid, all of them valid. Memory: 12 bytes
/// per grid point.
Displacement displacement_of_warp(const Warp& warp);

/// Points of `grid` where the offset field says nothing. Cost: 50 ns per point and core.
std::int64_t count_uncovered(const OffsetField& offsets, const Geometry& grid);

}  // namespace supple
