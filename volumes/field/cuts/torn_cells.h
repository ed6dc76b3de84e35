// The parted cells of a cut body whose sides are apart, with what each side has where its own
// corners end: linearly along links where there are two in a row, else constant (virtual_nodes.h).
#pragma once

#include <memory>

#include "volumes/field/cuts/virtual_nodes.h"

namespace supple {

/// The torn cells of every brick of CutBody::cells().
class TornCells {
 public:
  explicit TornCells(const BrickTopology& cells)
      : m_bricks(cells), m_cells(cells.brick_count()), m_nodes(cells.brick_count()) {}

  /// Follows u, on the body's cells, where it has `moved`, and the body, where its links or parted
  /// cells are others, in these bricks. Sides that are nowhere further apart than `closed` voxels
  /// count as one. Returns the bricks in which torn cells are others than before.
  BrickList follow(const VectorBricks& u, const CutBody& body, const BrickList& moved,
                   const BrickList& parted, double closed);

  /// The torn cells that begin in brick b, sorted.
  const std::vector<TornCell>& in(std::size_t b) const { return m_cells[b]; }
  const BrickTopology& bricks() const { return m_bricks; }
  std::int64_t count() const { return m_count; }
  bool empty() const { return m_count == 0; }
  bool holds(const Vec3i& cell) const;

 private:
  BrickTopology m_bricks;
  std::vector<std::vector<TornCell>> m_cells;
  std::vector<std::unique_ptr<VirtualNodes>> m_nodes;  // null: no cells are parted, or not known
  std::int64_t m_count = 0;
};

}  // namespace supple
