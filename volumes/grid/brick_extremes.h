// The least and the largest density of a brick and of its lowest faces, edges and corner: what
// cells that begin in bricks below can reach in it. Cost: 68 bytes; 0.1 µs while the densities are
// in cache.
#pragma once

#include <array>

#include "volumes/grid/brick_topology.h"

namespace supple {

/// Part 0 is the brick. Bit 4, 2 and 1 of a part say that only its lowest voxels along x, y and z
/// count.
struct BrickExtremes {
  static constexpr std::size_t kParts = 8;

  std::array<float, kParts> lo, hi;  // lo > hi: none
  bool integers = true;              // of all densities
};

/// Extremes of the finite densities of the voxels that are active in the mask.
/// @param values 512 densities in brick order.
BrickExtremes find_extremes(const float* values, const BrickMask& mask);

}  // namespace supple
