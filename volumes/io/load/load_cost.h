// Memory and work of a volume that is read, for plans.
#pragma once

#include "volumes/base/unit_cost.h"

namespace supple {

constexpr UnitCost kReadVoxelCost = {"read_voxel", 6,
                                     "A voxel of the file's box, read and put into bricks"};
constexpr double kGridBytes = 2300;  // of a brick that is opened

}  // namespace supple
