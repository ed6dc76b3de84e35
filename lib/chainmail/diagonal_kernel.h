// Closure of one 8^3 brick under axis links and diagonals: as brick_kernel.h, with sweeps that
// carry levels from plane to plane along 9 links per voxel, then from row to row along 3, then
// along rows. A sweep over planes or rows does not close them (a diagonal up and one down lead to
// another row), so sweeps alternate until all three change nothing.
#pragma once

#include <array>
#include <cstdint>

#include "lib/body/link_masks.h"
#include "lib/chainmail/brick_kernel.h"

namespace supple {

/// Directions of diagonals towards later voxels: those to the next plane, then those to the next
/// row.
constexpr std::array<int, 10> kUpDiagonals = {18, 19, 20, 21, 23, 24, 25, 26, 15, 17};
constexpr int kPlaneDiagonals = 8;

/// Costs of the diagonals inside a brick by the offset of their low end, both ways; kNoLink where
/// there is none, and around the 512. 54 kB, of which symmetric costs use half.
struct alignas(64) DiagonalCosts {
  static constexpr int kAround = 80;  // reads reach 73 to either side
  Level costs[2][10][kAround + kBrickVoxels + kAround];
  std::array<const Level*, 10> up, down;  // of voxel 0; null: no such link in the brick
};

/// Looks up the costs of axis links and diagonals among the voxels of the brick.
void look_up_costs(const LinkCosts& costs, const std::uint8_t* classes, const LinkMasks& links,
                   BrickCosts& axes, DiagonalCosts& diagonals);

/// Raises 512 levels (64-byte aligned) to the closure; returns the number of sweeps.
int close_brick(const BrickCosts& axes, const DiagonalCosts& diagonals, Level* levels);

}  // namespace supple
