// Offsets carried on beyond the material without folds in the air (`void extend`).
//
// Where two parts of the material come near each other, the extensions of both meet in the air
// between them with a jump (smooth_extension.h), and a cell there turns its inside out. Its nodes
// in the air and their neighbours then take the mean of their six neighbours, again and again,
// until no cell folds. Nodes at which tissue is seen keep their offsets. Bounded: folds that no air
// can undo stay. Cost: 0.2 µs per voxel of the bricks that touch the material, and 3 µs per node
// and pass.
#pragma once

#include <unordered_map>

#include "volumes/field/dense/smooth_extension.h"
#include "volumes/field/offset_field.h"
#include "volumes/grid/voxel_sets.h"

namespace supple {

class UnfoldedExtension {
 public:
  /// `elements`: nodes that read others count as air; null: all nodes of `offsets` stay. A volume
  /// of one slice is only carried on.
  UnfoldedExtension(const OffsetField& offsets, const BrickTopology* elements);

  /// Trilinear between voxels; defined everywhere.
  Vec3d sample(const Vec3d& pos_index) const;
  /// True if an offset around the position is no longer that of the field or of its extension.
  bool is_replaced(const Vec3d& pos_index) const;

 private:
  Vec3d at(const Vec3i& voxel) const;
  bool is_folded_cell(const Vec3i& cell) const;
  bool is_fixed(const Vec3i& voxel) const;
  std::vector<Vec3i> all_folded_cells() const;
  /// One pass; the cells that are folded after it.
  std::vector<Vec3i> smooth(const std::vector<Vec3i>& folded);

  const OffsetField& m_offsets;
  const BrickTopology* m_elements;
  SmoothExtension m_smooth;
  std::unordered_map<Vec3i, Vec3d, VoxelHash> m_replaced;
};

}  // namespace supple
