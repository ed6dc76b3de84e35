// One sweep of relaxation over one brick of a body with diagonal links, as sweep_kernel.h is for
// six: every free node steps towards the mean of its neighbours, no further than all its limits
// allow.
//
// Rows of the brick are of four colours by the parities of i and j, nodes of a row of two; bricks
// of eight. No link joins two nodes of one colour, so that nodes that step one
// colour after the other may each take up the whole slack of their links.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/relax/brick_springs.h"
#include "lib/relax/link_kinds.h"
#include "lib/relax/link_table.h"
#include "lib/relax/sweep_kernel.h"

namespace supple {

// A brick of a body with diagonal links and one layer all around it, as a sweep reads them.

struct DiagonalBrick {
  PaddedBrick<double> offsets;        // 2^-32 voxel; edges and corners of the layer as well
  PaddedBrick<std::int32_t> classes;  // where of_one_class is negative
  LinkMasks links;
  int of_one_class;  // of every element here and around; negative: they differ
  int colour;        // 0 to 7; bricks of one colour do not touch, not even at a corner
};

/// Per brick, the class of all its elements, or -1 where they differ.
std::vector<std::int16_t> classes_of_bricks(const Body& body);

int brick_colour(const Vec3i& origin);

/// Fills in brick b and the layer around it; `one_class` is that of classes_of_bricks().
void load_brick(const Body& body, int links, std::size_t b, const BrickArray<double>& offsets,
                const std::vector<std::int16_t>& one_class, DiagonalBrick& out);

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
