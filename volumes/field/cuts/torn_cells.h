// The parted cells of a cut body whose sides are apart, with what each side has where its own
// corners end: linearly along links where there are two in a row, else constant. Cells that share a
// corner of a side share what they extrapolate, so that a side is continuous from cell to cell.
// Cost: about 5 µs per parted cell.
#pragma once

#include "volumes/field/cuts/cut_body.h"

namespace supple {

/// Displacements of the corners of a parted cell, as each side has them.
struct TornCell {
  Vec3i cell;
  CellSides sides;
  std::vector<std::array<Vec3f, 8>> u;  // per side

  bool operator==(const TornCell& other) const {
    return cell == other.cell && sides == other.sides && u == other.u;
  }
};

/// The torn cells of every brick of CutBody::cells().
class TornCells {
 public:
  explicit TornCells(const BrickTopology& cells) : m_bricks(cells), m_cells(cells.brick_count()) {}

  /// Follows u, on the body's cells, and the body, where either has changed in these bricks. Sides
  /// that are nowhere further apart than `closed` voxels count as one. Returns the bricks in which
  /// torn cells are others than before.
  BrickList follow(const VectorBricks& u, const CutBody& body, const BrickList& changed,
                   double closed);

  /// Sorted.
  const std::vector<TornCell>& in(std::size_t b) const { return m_cells[b]; }
  const BrickTopology& bricks() const { return m_bricks; }
  std::int64_t count() const { return m_count; }
  bool empty() const { return m_count == 0; }
  bool holds(const Vec3i& cell) const;

 private:
  BrickTopology m_bricks;
  std::vector<std::vector<TornCell>> m_cells;
  std::int64_t m_count = 0;
};

}  // namespace supple
