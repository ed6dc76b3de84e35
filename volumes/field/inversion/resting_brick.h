// The complete cells of a source brick in which nothing moves, and the nodes at their corners:
// offsets are 0 there. Cost: 0.1 µs, at the border of a body 1 µs.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "volumes/grid/brick_topology.h"

namespace supple {

class RestingBrick {
 public:
  /// Brick b of `voxels`; `full`: per brick, whether it has all voxels. `rests(n)`: whether the
  /// cells of brick n do; -1 is none.
  RestingBrick(const BrickTopology& voxels, const std::vector<std::uint8_t>& full, std::size_t b,
               const std::function<bool(std::int32_t)>& rests);

  /// Cells that start in the brick and have all eight corners.
  int cells() const { return m_cells; }
  /// Nodes in the brick that are corners of resting cells, its own and those of bricks below it.
  const BrickMask& nodes() const { return m_nodes; }

 private:
  int m_cells = kBrickVoxels;
  BrickMask m_nodes;
};

}  // namespace supple
