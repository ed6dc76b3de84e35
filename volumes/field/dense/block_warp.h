// Blocks of a volume that is larger than memory, seen through offsets on a grid of their own, which
// may be coarser: what a block reads, and its values.
//
// Values are those of dense_resampled() with offsets_from_warp() where the target has the volume's
// grid; on another grid the field is read at the target's own voxels. They are the same however the
// target is cut into blocks: every voxel is computed from its place in the whole. A block runs on
// the calling thread alone, since its callers run many of them side by side. Cost: 4 ns per voxel
// where the field's axes are the target's and the target has the volume's grid; 100 ns on others.
#pragma once

#include <optional>

#include "volumes/field/dense/block_row.h"
#include "volumes/field/dense/grid_positions.h"

namespace supple {

class BlockWarp {
 public:
  /// `field`: the grid of resample-direction vectors in mm LPS; none: nothing moves.
  BlockWarp(const Geometry& volume, const Geometry& target, const std::optional<Geometry>& field);

  /// Nodes of the field around a box of the target; empty where it lies beyond the field.
  IndexBox nodes_of(const IndexBox& box) const;
  /// Voxels of the volume that a box of the target reads through these vectors, which are at least
  /// those of nodes_of(); empty where all of it is void. Found from the vectors of the box itself,
  /// to within a node's step and two voxels.
  IndexBox voxels_of(const IndexBox& box, const BlockOf<Vec3f>& vectors) const;
  /// The values of a box of the target, trilinear or those of the nearest voxel, rounded (halves
  /// away from zero) where T is a whole number. `fill`: of places outside of the volume or the
  /// field, and of values that are not finite. T: the types of ValueType. Throws InputError where
  /// `vectors` or `source` lacks something that the box reads.
  template <class T>
  void resample(const IndexBox& box, const BlockOf<Vec3f>& vectors, const BlockOf<T>& source,
                bool is_nearest, double fill, T* out) const;

 private:
  Vec3d offset_of(const Vec3f& vector_mm) const;
  void place_row(const IndexBox& box, int j, int k, RowPlaces& places) const;

  Geometry m_volume, m_target;
  std::optional<Geometry> m_field;
  GridPositions m_in_volume, m_in_field;
  bool m_is_same_grid;  // the target is the volume's grid
  bool m_is_aligned;    // axes of the field are those of the target
};

}  // namespace supple
