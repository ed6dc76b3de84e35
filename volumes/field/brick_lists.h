// Lists of bricks of one topology: those that a change has reached, and those that see it.
// Cost: a byte per brick of the topology and 50 ns per brick listed.
#pragma once

#include <cstdint>
#include <vector>

#include "volumes/grid/brick_topology.h"

namespace supple {

/// Numbers of bricks, ascending, each once.
using BrickList = std::vector<std::int32_t>;

/// All bricks of a topology.
BrickList all_bricks(const BrickTopology& topology);
BrickList unite(const BrickList& a, const BrickList& b);
/// The bricks and all that touch them.
BrickList with_neighbours(const BrickTopology& topology, const BrickList& bricks);
/// The bricks, and those below them whose cells have corners in them.
BrickList with_lower_neighbours(const BrickTopology& topology, const BrickList& bricks);
/// The bricks, and those above them in which their cells have corners.
BrickList with_upper_neighbours(const BrickTopology& topology, const BrickList& bricks);

/// The bricks of a list for which `holds(b)` is true.
template <class Holds>
BrickList bricks_where(const BrickList& bricks, Holds&& holds) {
  BrickList found;
  for (const std::int32_t b : bricks) {
    if (holds(std::size_t(b))) found.push_back(b);
  }
  return found;
}

}  // namespace supple
