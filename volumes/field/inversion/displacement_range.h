// How far the voxels of each brick move, brick by brick: enough to tell which output bricks its
// cells can reach and which did not move at all, without looking at the cells. Cost: 2 ns per
// voxel of the bricks that move.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "volumes/field/offset_field.h"

namespace supple {

/// Box of displacements; empty while lo > hi.
struct VectorRange {
  Vec3f lo{3e38f, 3e38f, 3e38f}, hi{-3e38f, -3e38f, -3e38f};

  bool empty() const { return lo.x > hi.x; }
  bool is_zero() const { return empty() || (lo == Vec3f(0) && hi == Vec3f(0)); }
};

/// Ranges of one brick's valid voxels; [n]: of those whose coordinate is 0 along x where n & 4,
/// along y where n & 2, along z where n & 1, which are corners of the cells of a lower neighbour.
using BrickRanges = std::array<VectorRange, 8>;

/// The ranges of a field. Bricks that are not stored rest, and cost 4 bytes each.
class DisplacementRanges {
 public:
  /// `dims`: of the volume, whose border voxels go on for half a voxel.
  explicit DisplacementRanges(const Vec3i& dims) : m_dims(dims) {}

  /// Looks at these bricks of u, in which it may have changed; all others are as they were, at
  /// first at rest. Throws InputError for values that are not finite or beyond 10^6 voxels.
  void update(const VectorBricks& u, const std::vector<std::int32_t>& bricks);

  /// Nodes that the cells of source brick b can reach; empty when it has none.
  IndexBox reach(const BrickTopology& bricks, std::size_t b) const;
  /// True when no corner of the cells of source brick b moved.
  bool is_still(const BrickTopology& bricks, std::size_t b) const;
  std::size_t bytes() const;

 private:
  VectorRange range(const BrickTopology& bricks, std::int32_t b, int n) const;
  Vec3f beyond_border(const Vec3i& origin, const VectorRange& moves) const;
  bool is_at_lower_border(const Vec3i& origin, int axis) const;
  bool is_at_upper_border(const Vec3i& origin, int axis) const;

  Vec3i m_dims;
  std::vector<std::int32_t> m_slots;  // per brick; -1: at rest
  std::vector<BrickRanges> m_ranges;
};

/// The bricks of u that are stored, and those below them whose cells have corners in them:
/// ascending. The cells of all others rest.
std::vector<std::int32_t> bricks_that_move(const VectorBricks& u);

}  // namespace supple
