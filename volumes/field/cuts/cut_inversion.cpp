// Bricks of the output that a cut body reaches, found brick by brick of the source.
#include "volumes/field/cuts/cut_inversion.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "volumes/base/parallel.h"
#include "volumes/field/inversion/reachable_bricks.h"
#include "volumes/field/inversion/source_cells.h"
#include "volumes/grid/cell.h"
#include "volumes/grid/mask_steps.h"
#include "volumes/grid/voxel_sets.h"

namespace supple {

namespace {

// Bricks this near to a moved torn cell are split: samples there are shaded as the face, and nodes
// beside the gap must not be interpolated with those across it. In voxels.
constexpr double kNearFace = 3;
constexpr double kNearCell = 1;

/// Adds the bricks of a box; boxes of neighbours mostly are of the same bricks.
void add_bricks_of(const CutBox& box, std::vector<Vec3i>& origins) {
  const IndexBox bricks = box.bricks();
  if (bricks.empty()) return;
  for_bricks_of(bricks.lo * kBrickDim, bricks.hi * kBrickDim, [&](const Vec3i& origin) {
    const auto last = std::ptrdiff_t(std::min<std::size_t>(origins.size(), 8));
    if (std::find(origins.end() - last, origins.end(), origin) == origins.end()) {
      origins.push_back(origin);
    }
  });
}

/// The sides of the torn cells of a brick as they were, which are asked for in their order: how
/// deep their corners are follows from which of them are their own, as long as the faces are the
/// same.
class KnownDepths {
 public:
  explicit KnownDepths(const std::vector<CutPiece>* sides) : m_sides(sides) {}

  /// The piece of that cell with the same corners, of as many sides; null: none.
  const CutPiece* of(const TornCell& cell, int side) {
    if (m_sides == nullptr) return nullptr;
    const auto& sides = *m_sides;
    while (m_first < sides.size() && voxel_less(sides[m_first].cell, cell.cell)) ++m_first;
    std::size_t end = m_first;
    while (end < sides.size() && sides[end].cell == cell.cell) ++end;
    if (end - m_first != std::size_t(cell.sides.count)) return nullptr;
    const CutPiece& piece = sides[m_first + std::size_t(side)];
    for (std::size_t n = 0; n < kCellCorners; ++n) {
      if ((piece.depth[n] > 0) != (cell.sides.of[n] == side)) return nullptr;
    }
    return &piece;
  }

 private:
  const std::vector<CutPiece>* m_sides;
  std::size_t m_first = 0;
};

}  // namespace

CutInversion::CutInversion(const BrickTopology& cells, const BrickTopology& elements,
                           const Vec3i& dims)
    : m_cells(cells),
      m_elements(thickened(elements, dims)),
      m_dims(dims),
      m_moves(cells.brick_count()),
      m_corner_moves(cells.brick_count()),
      m_reach(cells.brick_count()),
      m_sources(cells.brick_count()),
      m_whole(cells) {}

CutInversion::Source& CutInversion::touch(std::size_t b) {
  if (!m_sources[b]) m_sources[b] = std::make_unique<Source>();
  return *m_sources[b];
}

void CutInversion::follow(const VectorBricks& u, const TornCells& torn, const CutFaces& faces,
                          const Changes& changes) {
  const BrickList moved_bricks = numbers_of(changes.u);
  follow_moves(u, changes.u);
  make_sides(u, torn, faces, changes.torn, changes.faces);
  for (const std::int32_t b : changes.faces) {
    reach_faces(m_reach[std::size_t(b)]);
    if (m_sources[std::size_t(b)]) reach_faces(m_sources[std::size_t(b)]->sides_reach);
  }
  m_whole_changed = find_corners(torn, with_upper_neighbours(m_cells, changes.torn));
  replace_whole(m_whole_changed);
  const BrickList moved = with_lower_neighbours(m_cells, unite(moved_bricks, m_whole_changed));
  find_near(u, torn, unite(moved, changes.torn));
}

/// Corners of the cells of a brick lie in it and in its upper neighbours.
void CutInversion::follow_moves(const VectorBricks& u, const DisplacedBricks& changed) {
  parallel_for(changed.size(), [&](std::size_t n) {
    const auto b = std::size_t(changed[n].number);
    CutBox move;
    if (u.vectors.brick(b) == nullptr) {
      move.add(Vec3d(0));
    } else {
      for_each_active(m_cells.mask(b),
                      [&](int offset) { move.add(Vec3d(u.vectors.brick_or_zero(b)[offset])); });
    }
    m_moves[b] = move;
  });
  const BrickList beside = with_lower_neighbours(m_cells, numbers_of(changed));
  std::vector<IndexBox> before;
  for (const std::int32_t number : beside) {
    const auto b = std::size_t(number);
    CutBox move;
    for (int n = 0; n < kCellCorners; ++n) {
      const std::int32_t upper = m_cells.find(m_cells.origin(b) + cell_corner(n) * kBrickDim);
      if (upper >= 0) move.add(m_moves[std::size_t(upper)]);
    }
    if (!move.empty()) widen_at_border(m_cells.origin(b), move);
    CutBox reach;
    reach.add(Vec3d(m_cells.origin(b)) + move.lo - Vec3d(kReachSlack));
    reach.add(Vec3d(m_cells.origin(b)) + Vec3d(kBrickDim) + move.hi + Vec3d(kReachSlack));
    m_corner_moves[b] = move;
    before.push_back(std::exchange(m_reach[b], reach.bricks()));
  }
  reach_moved(u, changed, beside, before);
}

/// Widens the moves of cells by those beyond the border, as if cells there began at their corners.
/// Beyond m of its faces a trilinear cell has 2^m times its range, half its length away.
void CutInversion::widen_at_border(const Vec3i& origin, CutBox& moves) const {
  double part = 0.5;
  Vec3d below(0), above(0);
  for (int a = 0; a < 3; ++a) {
    const int last_cell = m_dims[a] - 2 - origin[a];
    if (m_dims[a] > 1 && origin[a] == 0) below[a] = kBeyondBorder;
    if (m_dims[a] > 1 && last_cell >= 0 && last_cell < kBrickDim) above[a] = kBeyondBorder;
    if (below[a] + above[a] > 0) part *= 2;
  }
  const Vec3d range = (moves.hi - moves.lo) * (part - 0.5);
  moves.lo -= range + below;
  moves.hi += range + above;
}

void CutInversion::make_sides(const VectorBricks& u, const TornCells& torn, const CutFaces& faces,
                              const BrickList& torn_changed, const BrickList& faces_changed) {
  const BrickList changed = bricks_where(unite(torn_changed, faces_changed), [&](std::size_t b) {
    return m_sources[b] != nullptr || !torn.in(b).empty();
  });
  std::vector<std::vector<CutPiece>> found(changed.size());
  parallel_for(changed.size(), [&](std::size_t n) {
    const auto b = std::size_t(changed[n]);
    const bool sees_others =
        std::binary_search(faces_changed.begin(), faces_changed.end(), changed[n]);
    KnownDepths known(sees_others || !m_sources[b] ? nullptr : &m_sources[b]->sides);
    for (const TornCell& cell : torn.in(b)) {
      for (int side = 0; side < cell.sides.count; ++side) {
        const CutPiece* const before = known.of(cell, side);
        found[n].emplace_back(
            cell.cell, cell.u[std::size_t(side)],
            before != nullptr ? before->depth : faces.depths_of_corners(cell, side));
        found[n].back().elements = before != nullptr ? before->elements : elements_of(cell.cell);
        found[n].back().go_on(m_dims);
        nodes_of(found[n].back().ends(), cell.cell);
      }
    }
  });
  for (std::size_t n = 0; n < changed.size(); ++n) {
    Source& source = touch(std::size_t(changed[n]));
    if (source.sides == found[n]) continue;
    reach_sides(u, source.sides, found[n]);
    CutBox reach;
    for (const CutPiece& side : found[n]) reach.add(box_of(side, kReachSlack));
    source.sides = std::move(found[n]);
    source.sides_reach = reach.bricks();
  }
}

/// Finds the corners of torn cells; returns the bricks in which they are others.
BrickList CutInversion::find_corners(const TornCells& torn, const BrickList& changed) {
  BrickList others;
  for (const std::int32_t number : changed) {
    const auto b = std::size_t(number);
    std::array<BrickMask, 8> cells{};
    for (int n = 0; n < kCellCorners; ++n) {
      const std::int32_t below = m_cells.find(m_cells.origin(b) - cell_corner(n) * kBrickDim);
      if (below < 0) continue;
      for (const TornCell& cell : torn.in(std::size_t(below))) {
        mask_set(cells[std::size_t(n)], brick_offset(cell.cell));
      }
    }
    const BrickMask corners = supple::corners_of(cells);
    if (corners == (m_sources[b] ? m_sources[b]->corners : BrickMask{})) continue;
    touch(b).corners = corners;
    others.push_back(number);
  }
  return others;
}

/// Bricks stay, so that they keep their numbers: one that is left without voxels has one in its
/// middle, which is a corner of no complete cell.
void CutInversion::replace_whole(const BrickList& bricks) {
  if (bricks.empty()) return;
  std::vector<BrickMask> masks;
  for (std::size_t b = 0; b < m_cells.brick_count(); ++b) masks.push_back(m_whole.mask(b));
  for (const std::int32_t b : bricks) {
    BrickMask& mask = masks[std::size_t(b)];
    for (std::size_t word = 0; word < mask.size(); ++word) {
      mask[word] = m_cells.mask(std::size_t(b))[word] & ~m_sources[std::size_t(b)]->corners[word];
    }
    if (mask_count(mask) == 0) mask_set(mask, brick_offset(Vec3i(kBrickDim / 2)));
  }
  m_whole = BrickTopology(m_cells.index().origins(), std::move(masks));
}

/// Finds the bricks around torn cells, and those which whole cells beside them reach, which share
/// corners with them.
void CutInversion::find_near(const VectorBricks& u, const TornCells& torn,
                             const BrickList& bricks) {
  static constexpr BrickMask kNone{};
  const auto beside_corners = [&](std::size_t b) {
    std::array<BrickMask, kCellCorners> corners{};
    for (int n = 0; n < kCellCorners; ++n) {
      const std::int32_t above = m_cells.find(m_cells.origin(b) + cell_corner(n) * kBrickDim);
      const bool has_any = above >= 0 && source(std::size_t(above)) != nullptr;
      corners[std::size_t(n)] = has_any ? source(std::size_t(above))->corners : kNone;
    }
    return cells_beside(corners);
  };
  const BrickList looked_at = bricks_where(bricks, [&](std::size_t b) {
    return source(b) != nullptr || mask_count(beside_corners(b)) > 0;
  });
  std::vector<std::vector<Vec3i>> near(looked_at.size());
  std::vector<Counts> counts(looked_at.size());
  parallel_for(looked_at.size(), [&](std::size_t n) {
    const auto b = std::size_t(looked_at[n]);
    if (source(b) != nullptr) {
      for (const CutPiece& side : source(b)->sides) add_bricks_of(box_of(side, kNearFace), near[n]);
    }
    BrickMask cells = beside_corners(b);
    keep(cell_mask(m_cells, b), cells);
    for_each_active(cells, [&](int offset) {
      const Vec3i cell = m_cells.origin(b) + brick_local(offset);
      std::array<Vec3f, 8> moves;
      if (torn.holds(cell) || !corners_of(u, cell, moves)) return;
      const CutPiece whole = whole_piece(cell, moves);
      const bool is_tissue = whole.elements == 0xff;
      if (is_tissue) {
        counts[n].min_det = std::min(counts[n].min_det, min_corner_det(whole.corners()));
      }
      ++counts[n].cells;
      counts[n].folded_cells += whole.is_folded;
      counts[n].folded_air_cells += whole.is_folded && !is_tissue;
      add_bricks_of(box_of(whole, kNearCell), near[n]);
    });
    sort_unique(near[n]);
  });
  for (std::size_t n = 0; n < looked_at.size(); ++n) {
    Source& source = touch(std::size_t(looked_at[n]));
    source.counts = counts[n];
    if (source.near == near[n]) continue;
    for (const Vec3i& origin : near[n]) ++m_near[origin];
    for (const Vec3i& origin : source.near) {
      const auto found = m_near.find(origin);
      if (--found->second == 0) m_near.erase(found);
    }
    source.near = std::move(near[n]);
  }
}

bool CutInversion::corners_of(const VectorBricks& u, const Vec3i& cell,
                              std::array<Vec3f, 8>& moves) const {
  for (int n = 0; n < kCellCorners; ++n) {
    if (!u.at(cell + cell_corner(n), moves[std::size_t(n)])) return false;
  }
  return true;
}

CutPiece CutInversion::whole_piece(const Vec3i& cell, const std::array<Vec3f, 8>& moves) const {
  CutPiece piece(cell, moves);
  piece.elements = elements_of(cell);
  piece.go_on(m_dims);
  return piece;
}

/// The corners of a cell that are elements, bit 4 x + 2 y + z.
std::uint8_t CutInversion::elements_of(const Vec3i& cell) const {
  unsigned bits = 0;
  for (int n = 0; n < kCellCorners; ++n) {
    bits |= unsigned(m_elements.is_active(cell + cell_corner(n))) << n;
  }
  return std::uint8_t(bits);
}

void CutInversion::count(const TornCells& torn, InversionCertificate& certificate) const {
  certificate.torn_cells = torn.count();
  certificate.cells += torn.count();
  for (const auto& source : m_sources) {
    if (!source) continue;
    certificate.cells += source->counts.cells;
    certificate.folded_cells += source->counts.folded_cells;
    certificate.folded_air_cells += source->counts.folded_air_cells;
    certificate.min_det = std::min(certificate.min_det, source->counts.min_det);
  }
}

}  // namespace supple
