// Voxels at which a displacement is another than before, and their former vectors.
#pragma once

#include <vector>

#include "volumes/field/brick_lists.h"
#include "volumes/field/offset_field.h"

namespace supple {

struct DisplacedBrick {
  std::int32_t number;
  BrickMask voxels{};         // those that differ
  std::vector<Vec3f> before;  // of all voxels of the brick; empty: nothing is known of before
};

/// Displaced bricks, ascending.
using DisplacedBricks = std::vector<DisplacedBrick>;

/// All bricks, of whose former vectors nothing is known.
DisplacedBricks all_moved(const BrickTopology& topology);
BrickList numbers_of(const DisplacedBricks& moved);
/// The entry of the brick with this number, or null.
const DisplacedBrick* find_moved(const DisplacedBricks& moved, std::int32_t number);

/// Copies of bricks of a field, to tell what has moved since.
class KeptVectors {
 public:
  KeptVectors(const VectorBricks& u, const BrickList& bricks);
  /// The bricks of which a vector has other bits now. May be called once.
  DisplacedBricks moved(const VectorBricks& u);

 private:
  DisplacedBricks m_kept;
};

}  // namespace supple
