// A brick of a body with diagonal links and one layer all around it, as a sweep reads them.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/relax/brick_springs.h"
#include "lib/relax/link_kinds.h"

namespace supple {

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

}  // namespace supple
