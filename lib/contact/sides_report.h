// Report on contact of the sides of cuts in a step.
#pragma once

#include <cstdint>

#include "volumes/base/vec.h"

namespace supple {

/// Drags that have no room are shortened to a multiple of this part.
constexpr int kContactParts = 1024;

struct SidesReport {
  std::int64_t overlapping = 0;  // points of lips that were behind the other lip
  double deepest_voxels = 0;     // of those that overlapped
  double max_move_voxels = 0;    // that took them apart
  std::int64_t left = 0;         // points that still are too deep behind it
  std::int64_t deepened = 0;     // of these, deeper than before the move
  double left_voxels = 0;        // the deepest of those that are left
  /// Voxel of a side at rest where the deepest point is, of those that are left if any are.
  Vec3i voxel{0, 0, 0};
  /// Part of the drag, in 1/kContactParts, for which elements held on both sides leave room.
  int parts = kContactParts;
  /// True where bones have moved and left no room: points that are left were pressed between them.
  bool is_crushed = false;
};

}  // namespace supple
