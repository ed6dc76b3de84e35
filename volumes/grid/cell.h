// The one numbering of a cell's corners: x slowest, z fastest, as voxels lie in a brick.
#pragma once

#include "volumes/base/vec.h"

namespace supple {

/// Corner n, 0 to 7, of the cell of voxels whose lowest corner is the origin.
constexpr int kCellCorners = 8;
inline Vec3i cell_corner(int n) {
  return {n >> 2, (n >> 1) & 1, n & 1};
}

}  // namespace supple
