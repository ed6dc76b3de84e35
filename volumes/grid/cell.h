// The one numbering of a cell's corners: x slowest, z fastest, as voxels lie in a brick; and the
// border of a volume, where cells end and voxels go on for half their width.
#pragma once

#include "volumes/base/vec.h"

namespace supple {

/// Corner n, 0 to 7, of the cell of voxels whose lowest corner is the origin.
constexpr int kCellCorners = 8;
inline Vec3i cell_corner(int n) {
  return {n >> 2, (n >> 1) & 1, n & 1};
}

/// Voxels by which border voxels go on beyond the outer voxel centres of a volume.
constexpr double kBeyondBorder = 0.5;

/// The place at which a volume of these dimensions is read. Up to half a voxel beyond the outer
/// voxel centres lies a border voxel, which has one value, as in the buffers of ITK; farther out is
/// the place itself. A volume of one slice has nothing beside it.
inline Vec3d within_border(Vec3d index, const Vec3i& dims) {
  for (int a = 0; a < 3; ++a) {
    const double last = dims[a] - 1;
    if (last == 0 || (index[a] < 0 && index[a] >= -kBeyondBorder)) index[a] = 0;
    if (index[a] > last && index[a] <= last + kBeyondBorder) index[a] = last;
  }
  return index;
}

}  // namespace supple
