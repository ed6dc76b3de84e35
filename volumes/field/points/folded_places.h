// Places that several places of a body may have come to: wherever a motion covers a place twice,
// off the border of the body, some cell that turns its inside out covers it too. So these are the
// lattice cells that the box of a folded cell touches, and those around nodes at which parts of the
// body lie that came together there without a fold.
// Cost: 100 bytes per brick touched.
#pragma once

#include <unordered_map>

#include "volumes/field/inversion/cell_corners.h"
#include "volumes/grid/voxel_sets.h"

namespace supple {

class FoldedPlaces {
 public:
  /// A folded cell, its moved corners relative to it, at most 10^8 voxels away. Throws InputError
  /// for one torn over more than 2^24 voxels.
  void add(const Vec3i& cell, const CellCorners& corners);
  /// The cells around a node.
  void add(const Vec3i& node);
  bool contains(const Vec3d& x) const;

 private:
  void mark(const Vec3i& voxel);

  std::unordered_map<Vec3i, BrickMask, VoxelHash> m_bricks;
};

}  // namespace supple
