// Links of the voxels of one brick as bits, diagonals and links to other bricks included: the rule
// of diagonals.h for 512 voxels at a time. About 1,500 cycles.
#pragma once

#include <array>
#include <cstdint>

#include "lib/material/material.h"
#include "volumes/grid/brick_topology.h"
#include "volumes/grid/link_cuts.h"

namespace supple {

/// The bricks around a brick by direction, itself in the middle. -1: there is none, or none that a
/// path of bricks reaches which steps once along each axis, as the paths of links do.
using BrickNeighbours = std::array<std::int32_t, kDirections>;
BrickNeighbours neighbours_of(const BrickTopology& elements, std::size_t brick);

/// Per direction, the voxels of a brick that have a link that way.
using LinkMasks = std::array<BrickMask, kDirections>;
void find_links(const BrickTopology& elements, const LinkCuts& cuts, int links,
                const BrickNeighbours& bricks, LinkMasks& out);

}  // namespace supple
