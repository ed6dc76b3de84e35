// Memory and work of what a state becomes: displacements, files, warps; for plans.
#pragma once

#include "volumes/base/unit_cost.h"

namespace supple {

constexpr UnitCost kDisplacementVoxelCost = {"displacement_voxel", 12,
                                             "A voxel of bricks that move"};
constexpr UnitCost kStillBrickCost = {"still_brick", 570, "A brick of the body that does not move"};
constexpr UnitCost kWarpVoxelCost = {"warp_voxel", 15,
                                     "A voxel of a dense warp or volume, written"};
constexpr UnitCost kStateBrickCost = {"state_brick", 14000, "A brick of a state, written"};
constexpr UnitCost kStateVectorBrickCost = {"state_vector_brick", 50000, "The same with offsets"};

constexpr double kExtendBytes = 50;  // of any brick while displacements are extended
/// Bytes of a state while it is written: a brick of coordinates that moved, and any brick of
/// elements, displacements and offsets, whose values are made one after the other.
constexpr double kMovedGridBytes = 6300, kElementGridBytes = 200, kLeafBytes = 170;

}  // namespace supple
