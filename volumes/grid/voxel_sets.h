// The algebra of voxel sets: brick topologies and lists of voxels.
#pragma once

#include <vector>

#include "volumes/grid/brick_topology.h"

namespace supple {

/// The voxels 0 … dims - 1.
BrickTopology box_topology(const Vec3i& dims);

/// The sorted union of two topologies.
BrickTopology unite(const BrickTopology& a, const BrickTopology& b);

/// The active voxels of `a` that are not active in `b`.
BrickTopology subtract(const BrickTopology& a, const BrickTopology& b);

/// The active voxels whose 26 neighbours are active too.
BrickTopology eroded(const BrickTopology& topology);

/// All voxels of the occupied bricks and of the 26 bricks around each.
BrickTopology touching_bricks(const BrickTopology& topology);

/// Ascending (voxel_less), each once.
void sort_unique(std::vector<Vec3i>& voxels);

}  // namespace supple
