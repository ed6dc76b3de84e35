// One sweep of relaxation over one brick of a body with diagonal links, as sweep_kernel.h is for
// six: every free node steps towards the mean of its neighbours, no further than all its limits
// allow.
//
// Rows of the brick are of four colours by the parities of i and j, nodes of a row of two; bricks
// of eight (diagonal_brick.h). No link joins two nodes of one colour, so that nodes that step one
// colour after the other may each take up the whole slack of their links.
#pragma once

#include "lib/relax/diagonal_brick.h"
#include "lib/relax/link_table.h"
#include "lib/relax/sweep_kernel.h"

namespace supple {

/// Least and most offsets of a brick's nodes, 2^-32 voxel.
struct NodeBounds {
  double least[kBrickVoxels], most[kBrickVoxels];
};

struct DiagonalSweep {
  SweepRule rule;
  /// Every node steps from where the others were before the sweep; share is then half.
  bool at_once = false;
  const NodeBounds* bounds = nullptr;
};

/// `free` nodes step; writes 512 offsets to `out` and, unless all step at once, to the brick. The
/// outcome's energy is that of the links whose end in the brick comes before the other end in a
/// pass through all colours: summed over all bricks it is the energy before the pass, though
/// bricks around may have stepped.
SweepOutcome sweep_brick(DiagonalBrick& brick, const LinkTable& table, const BrickMask& free,
                         const DiagonalSweep& sweep, double* out);

}  // namespace supple
