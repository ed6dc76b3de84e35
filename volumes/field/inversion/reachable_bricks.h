// Which nodes and bricks of the output lattice a deformed field can reach; found before the
// inversion proper, so that its memory is the bricks in reach, never a box.
#pragma once

#include <string>

#include "volumes/field/brick_lists.h"
#include "volumes/field/inversion/source_cells.h"

namespace supple {

/// Lattice nodes in the box of a deformed cell, relative to its lowest corner. Throws InputError
/// for a cell stretched over more than 2^24 nodes: that is a tear, not a deformation.
IndexBox nodes_of(const CellCorners& corners, const Vec3i& cell);

/// True for the reach of a source brick that is spread over more than 64 bricks.
bool is_torn(const IndexBox& reach);

/// Nodes in reach of the cells of a source brick (displacement_range.h).
struct BrickReach {
  std::int32_t brick;
  IndexBox nodes;
};

/// Sorted, unique origins of the output bricks that the cells of these bricks of u can reach.
std::vector<Vec3i> reachable_origins(const VectorBricks& u, const std::vector<BrickReach>& reaches);

/// Calls `visit(origin)` for every brick that holds a voxel of lo … hi, ascending.
template <class Visit>
void for_bricks_of(const Vec3i& lo, const Vec3i& hi, Visit&& visit) {
  for (int x = lo.x & ~7; x <= hi.x; x += kBrickDim) {
    for (int y = lo.y & ~7; y <= hi.y; y += kBrickDim) {
      for (int z = lo.z & ~7; z <= hi.z; z += kBrickDim) visit(Vec3i(x, y, z));
    }
  }
}
/// The origins of all bricks that hold a voxel of lo … hi.
inline void add_box(const Vec3i& lo, const Vec3i& hi, std::vector<Vec3i>& origins) {
  for_bricks_of(lo, hi, [&](const Vec3i& origin) { origins.push_back(origin); });
}

}  // namespace supple
