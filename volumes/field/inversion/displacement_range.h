// How far the voxels of each brick move, brick by brick: enough to tell which output bricks its
// cells can reach and which did not move at all, without looking at the cells. Cost: 2 ns per
// voxel.
#pragma once

#include <array>
#include <vector>

#include "volumes/field/vector_bricks.h"

namespace supple {

/// Box of displacements; empty while lo > hi.
struct VectorRange {
  Vec3f lo{3e38f, 3e38f, 3e38f}, hi{-3e38f, -3e38f, -3e38f};

  bool empty() const { return lo.x > hi.x; }
  bool is_zero() const { return empty() || (lo == Vec3f(0) && hi == Vec3f(0)); }
};

/// Of the valid voxels of one brick; [n]: of those whose coordinate is 0 along x where n & 4, along
/// y where n & 2, along z where n & 1, which are corners of the cells of a lower neighbour.
using BrickRanges = std::array<VectorRange, 8>;

/// Throws InputError for values that are not finite or beyond 10^6 voxels.
BrickRanges ranges_of(const VectorBricks& u, std::size_t b);

/// Nodes that the cells of source brick b can reach; empty when it has none.
IndexBox reach_of(const BrickTopology& bricks, const std::vector<BrickRanges>& ranges,
                  std::size_t b);

/// True when no corner of the cells of source brick b moved.
bool is_still(const BrickTopology& bricks, const std::vector<BrickRanges>& ranges, std::size_t b);

}  // namespace supple
