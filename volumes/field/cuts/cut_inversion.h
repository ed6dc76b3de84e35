// Which bricks a cut splits, what reaches them, and how their offsets join those of the rest.
#pragma once

#include <cmath>
#include <unordered_set>

#include "volumes/field/cuts/cut_offsets.h"

namespace supple {

/// A box of places, in voxels.
struct CutBox {
  Vec3d lo{HUGE_VAL, HUGE_VAL, HUGE_VAL}, hi{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};

  bool empty() const { return lo.x > hi.x; }
  void add(const Vec3d& p) {
    for (int a = 0; a < 3; ++a) {
      lo[a] = std::min(lo[a], p[a]);
      hi[a] = std::max(hi[a], p[a]);
    }
  }
  /// In steps of bricks.
  IndexBox bricks() const {
    IndexBox box;
    for (int a = 0; a < 3; ++a) {
      box.lo[a] = int(std::floor(lo[a])) >> 3;
      box.hi[a] = int(std::floor(hi[a])) >> 3;
    }
    return box;
  }
};

class CutInversion {
 public:
  CutInversion(const VectorBricks& u, const std::vector<TornCell>& torn, const CutFaces& faces,
               const BrickTopology& elements, const Vec3i& dims);

  /// u without the corners of torn cells: what a lattice of offsets can hold.
  VectorBricks whole_part() const;
  /// The bricks that the cut splits; counts into the certificate what `whole_part` lacks, and puts
  /// their overlaps in place of those that are there.
  std::vector<CutBrick> split_bricks(OffsetField& field, Progress* progress);
  /// The offsets of split bricks at their nodes in place of those that are there.
  VectorBricks joined(const VectorBricks& offsets, const std::vector<CutBrick>& bricks) const;
  /// Tells the bricks in which cells they need not be asked; `offsets`: joined().
  void find_interpolated(const VectorBricks& offsets, std::vector<CutBrick>& bricks) const;

 private:
  bool is_torn(const Vec3i& cell) const { return m_torn_at.count(cell) != 0; }
  void find_source_boxes();
  bool corners_of(const Vec3i& cell, std::array<Vec3f, 8>& u) const;
  CutPiece whole_piece(const Vec3i& cell, const std::array<Vec3f, 8>& u) const;
  std::uint8_t elements_of(const Vec3i& cell) const;
  void count_folds(const CutPiece& piece, InversionCertificate& certificate) const;
  std::vector<Vec3i> first_bricks(InversionCertificate& certificate) const;
  std::vector<CutBrick> fill(const std::vector<Vec3i>& origins) const;
  void add_pieces(std::size_t source, CutBrick& brick) const;
  BrickMask overlaps_of(const CutBrick& brick) const;

  const VectorBricks& m_u;
  const BrickTopology& m_elements;
  Vec3i m_dims;
  std::vector<CutPiece> m_sides;  // of the torn cells
  std::unordered_set<Vec3i, VoxelHash> m_torn_at;
  std::unordered_set<Vec3i, VoxelHash> m_corners;  // of torn cells
  std::vector<CutBox> m_boxes;                     // moved cells of every source brick
};

}  // namespace supple
