// Which split bricks a change reaches: those that a cell reaches, or has reached, of which a corner
// has moved or which is torn or whole again, and those that other sides of torn cells reach.
#include <algorithm>
#include <array>

#include "volumes/base/parallel.h"
#include "volumes/field/cuts/cut_inversion.h"
#include "volumes/field/inversion/reachable_bricks.h"
#include "volumes/grid/cell.h"
#include "volumes/grid/mask_steps.h"
#include "volumes/grid/voxel_sets.h"

namespace supple {

namespace {

/// Calls `visit(entry)` for the split bricks of a box in steps of bricks.
template <class Splits, class Visit>
void for_split_in(const IndexBox& box, Splits& splits, Visit&& visit) {
  if (box.empty()) return;
  const Vec3d extent = Vec3d(box.hi - box.lo) + Vec3d(1);
  if (extent.x * extent.y * extent.z > double(splits.size())) {
    for (auto& entry : splits) {
      const Vec3i& origin = entry.first;
      if (box.contains({origin.x >> 3, origin.y >> 3, origin.z >> 3})) visit(entry);
    }
    return;
  }
  for_bricks_of(box.lo * kBrickDim, box.hi * kBrickDim, [&](const Vec3i& origin) {
    const auto found = splits.find(origin);
    if (found != splits.end()) visit(*found);
  });
}

using CellVectors = std::array<const Vec3f*, kCellCorners>;  // of a brick and of those above it

/// Box that a cell takes up with such vectors.
CutBox moved_box(const Vec3i& origin, int cell, const CellVectors& vectors, const Vec3i& dims) {
  CutBox box;
  std::array<Vec3f, 8> moves;
  for (int n = 0; n < kCellCorners; ++n) {
    const Vec3i at = brick_local(cell) + cell_corner(n);
    const auto from = std::size_t(4 * (at.x >> 3) + 2 * (at.y >> 3) + (at.z >> 3));
    moves[std::size_t(n)] = vectors[from][brick_offset(at)];
    box.add(Vec3d(origin + at) + Vec3d(moves[std::size_t(n)]));
  }
  if (beyond_border(origin + brick_local(cell), dims) != 0) {
    CutPiece piece(origin + brick_local(cell), moves);
    piece.go_on(dims);
    box.add(box_of(piece, 0));
  }
  box.lo -= Vec3d(2 * kReachSlack);
  box.hi += Vec3d(2 * kReachSlack);
  return box;
}

/// The pieces from `first` on that are of its cell.
std::size_t end_of_cell(const std::vector<CutPiece>& pieces, std::size_t first) {
  std::size_t end = first;
  while (end < pieces.size() && pieces[end].cell == pieces[first].cell) ++end;
  return end;
}

}  // namespace

/// Marks the split bricks that moved cells reach, and those that they have reached, as stale: cells
/// that begin in bricks `beside`.
void CutInversion::reach_moved(const VectorBricks& u, const DisplacedBricks& moved,
                               const BrickList& beside, const std::vector<IndexBox>& reach_before) {
  if (m_split.empty()) return;
  std::vector<std::vector<Vec3i>> reached(beside.size());
  parallel_for(beside.size(), [&](std::size_t n) {
    const auto b = std::size_t(beside[n]);
    bool may_reach = false;
    const auto see = [&](const auto&) { may_reach = true; };
    for_split_in(m_reach[b], m_split, see);
    for_split_in(reach_before[n], m_split, see);
    if (!may_reach) return;
    std::array<BrickMask, kCellCorners> voxels{};
    CellVectors now{}, before{};
    for (int k = 0; k < kCellCorners; ++k) {
      const std::int32_t above = m_cells.find(m_cells.origin(b) + cell_corner(k) * kBrickDim);
      if (above < 0) continue;
      const DisplacedBrick* const brick = find_moved(moved, above);
      now[std::size_t(k)] = before[std::size_t(k)] = u.vectors.brick_or_zero(std::size_t(above));
      if (brick == nullptr) continue;
      before[std::size_t(k)] = brick->before.data();
      voxels[std::size_t(k)] = brick->voxels;
    }
    BrickMask cells = cells_beside(voxels);
    keep(cell_mask(m_cells, b), cells);
    for_each_active(cells, [&](int cell) {
      for (const CellVectors* vectors : {&now, &before}) {
        for_split_in(moved_box(m_cells.origin(b), cell, *vectors, m_dims).bricks(), m_split,
                     [&](const auto& entry) {
                       if (reached[n].empty() || !(reached[n].back() == entry.first)) {
                         reached[n].push_back(entry.first);
                       }
                     });
      }
    });
    sort_unique(reached[n]);
  });
  for (const std::vector<Vec3i>& origins : reached) {
    for (const Vec3i& origin : origins) m_split.at(origin).is_stale = true;
  }
}

/// Sides of the torn cells of a source, those of a cell together. A cell that is torn is no whole
/// one.
void CutInversion::reach_sides(const VectorBricks& u, const std::vector<CutPiece>& before,
                               const std::vector<CutPiece>& now) {
  if (m_split.empty()) return;
  const auto reach = [&](const std::vector<CutPiece>& pieces, std::size_t first, std::size_t end) {
    for (; first < end; ++first) reach_stale(box_of(pieces[first], 2 * kReachSlack).bricks());
  };
  const auto reach_whole = [&](const Vec3i& cell) {
    std::array<Vec3f, 8> moves;
    if (corners_of(u, cell, moves)) {
      reach_stale(box_of(whole_piece(cell, moves), 2 * kReachSlack).bricks());
    }
  };
  std::size_t a = 0, b = 0;
  while (a < before.size() || b < now.size()) {
    const bool has_both = a < before.size() && b < now.size();
    const bool is_gone = b == now.size() || (has_both && voxel_less(before[a].cell, now[b].cell));
    const bool is_new = a == before.size() || (has_both && voxel_less(now[b].cell, before[a].cell));
    const std::size_t end_a = is_new ? a : end_of_cell(before, a);
    const std::size_t end_b = is_gone ? b : end_of_cell(now, b);
    if (is_gone || is_new) reach_whole(is_gone ? before[a].cell : now[b].cell);
    if (!std::equal(before.begin() + std::ptrdiff_t(a), before.begin() + std::ptrdiff_t(end_a),
                    now.begin() + std::ptrdiff_t(b), now.begin() + std::ptrdiff_t(end_b))) {
      reach(before, a, end_a);
      reach(now, b, end_b);
    }
    a = end_a;
    b = end_b;
  }
}

void CutInversion::reach_stale(const IndexBox& box) {
  for_split_in(box, m_split, [](auto& entry) { entry.second.is_stale = true; });
}

void CutInversion::reach_faces(const IndexBox& box) {
  for_split_in(box, m_split, [](auto& entry) { entry.second.knows_other_faces = true; });
}

}  // namespace supple
