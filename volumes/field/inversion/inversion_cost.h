// Memory and work of an inversion, for plans.
#pragma once

#include "volumes/base/unit_cost.h"

namespace supple {

constexpr UnitCost kInvertVoxelCost = {"invert_voxel", 55, "A voxel of bricks that move, inverted"};

constexpr double kInvertBytes = 600;                   // of a brick that moves while it is inverted
constexpr double kRestBytes = 30;                      // of any other then
constexpr double kSplitNs = 3e6, kSplitBytes = 350e3;  // of a brick beside a cut
/// Voxels from a cut link in which bricks are split (cut_inversion.cpp).
constexpr int kSplitRings = 3;
/// Buffers of threads that work, and of a brick that moves, at the most.
constexpr double kInvertCode = 6e6, kInvertedBytes = 100e3;

}  // namespace supple
