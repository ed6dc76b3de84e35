// The displacement of a body at any place: trilinear in its cells, linear for a step beyond the
// border of the volume, carried on smoothly elsewhere beyond them, and in cells that a cut has
// opened that of the side on which a place lies. Cost: that of a SmoothExtension and a copy of u;
// 0.2 µs per place.
#pragma once

#include <unordered_map>

#include "volumes/field/cuts/cut_offsets.h"
#include "volumes/field/dense/smooth_extension.h"
#include "volumes/field/inversion/trilinear_cell.h"

namespace supple {

class CarriedDisplacement {
 public:
  /// `displacement`: extended as for invert_cut().
  CarriedDisplacement(const Displacement& displacement, const CutElements& body);

  struct Place : CellPlace {
    bool is_known = true;    // false: beyond the body and its shell
    bool is_folded = false;  // in a cell that turns its inside out
    bool is_torn = false;    // between the sides of an open cut; u is that of the nearest side
  };

  /// The displacement on the place's own side of a cut. Index space.
  Place at(const Vec3d& X) const;
  /// The displacement as if no cut had opened: continuous everywhere.
  CellPlace stretched(const Vec3d& X) const;
  /// The same, the whole cell: there is one everywhere (for point_solver.h).
  bool cell(const Vec3i& voxel, TrilinearCell& cell) const;
  bool cell_at(const Vec3d& X, Vec3i& voxel, TrilinearCell& cell) const;
  /// True if a cut has opened in the cell around X.
  bool is_in_torn_cell(const Vec3d& X) const;
  bool has_torn_cells() const { return !m_sides.empty(); }
  /// `visit(CutPiece)` for every side of every torn cell.
  template <class Visit>
  void for_torn_sides(Visit&& visit) const {
    for (const auto& [cell, sides] : m_sides) {
      for (const CutPiece& side : sides) visit(side);
    }
  }

  /// u on body and shell; a body of one slice is thickened (source_cells.h).
  const VectorBricks& known() const { return m_u; }

 private:
  Vec3d at_node(const Vec3i& voxel) const;
  bool is_known(const Vec3i& voxel, const Vec3d& t) const;
  Vec3i cell_around(const Vec3d& X) const;
  void tear(const std::vector<TornCell>& torn, const CutFaces& faces);

  Vec3i m_dims;
  VectorBricks m_u;
  SmoothExtension m_smooth;
  std::unordered_map<Vec3i, std::vector<CutPiece>, VoxelHash> m_sides;  // of torn cells
};

}  // namespace supple
