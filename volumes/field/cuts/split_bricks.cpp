// The split bricks of a cut body: gathered where something that reaches them has changed.
#include <algorithm>
#include <iterator>

#include "volumes/base/parallel.h"
#include "volumes/field/cuts/cut_inversion.h"
#include "volumes/field/inversion/reachable_bricks.h"
#include "volumes/grid/cell.h"
#include "volumes/grid/mask_steps.h"
#include "volumes/grid/padded_rows.h"
#include "volumes/grid/voxel_sets.h"

namespace supple {

namespace {

Vec3i brick_step(const Vec3i& origin) {
  return {origin.x >> 3, origin.y >> 3, origin.z >> 3};
}

/// True if a cell whose corners move like this reaches a box.
bool reaches(const Vec3i& cell, const std::array<Vec3f, 8>& u, const CutBox& box) {
  for (int a = 0; a < 3; ++a) {
    double lo = HUGE_VAL, hi = -HUGE_VAL;
    for (int n = 0; n < 8; ++n) {
      const double moved = cell[a] + (n >> (2 - a) & 1) + double(u[std::size_t(n)][a]);
      lo = std::min(lo, moved);
      hi = std::max(hi, moved);
    }
    if (lo > box.hi[a] || hi < box.lo[a]) return false;
  }
  return true;
}

bool reaches(const CutPiece& piece, const CutBox& box) {
  for (int a = 0; a < 3; ++a) {
    if (piece.cell[a] + double(piece.lo[a]) > box.hi[a]) return false;
    if (piece.cell[a] + double(piece.hi[a]) < box.lo[a]) return false;
  }
  return true;
}

/// Pieces of a brick.
struct PieceRun {
  const CutPiece *begin = nullptr, *end = nullptr;
};

/// Pieces that are whole cells of one source: sides come first, then sources ascending.
PieceRun whole_pieces_of(const CutBrick& brick, const Vec3i& source) {
  const auto comes_before = [](const CutPiece& piece, const Vec3i& origin) {
    return !piece.is_whole || voxel_less(brick_step(piece.cell), brick_step(origin));
  };
  const CutPiece* const first = brick.pieces().data();
  const CutPiece* const end = first + brick.pieces().size();
  PieceRun run;
  run.begin = run.end = std::lower_bound(first, end, source, comes_before);
  while (run.end != end && brick_step(run.end->cell) == brick_step(source)) ++run.end;
  return run;
}

}  // namespace

/// The whole cells of a source that reach the brick. Only those are looked at that may, by how far
/// the corners of the source's cells move. Those that have not moved are taken over.
void CutInversion::add_pieces(const VectorBricks& u, const TornCells& torn, std::size_t b,
                              const SplitBrick* before, CutBrick& brick) const {
  CutBox box;
  box.add(Vec3d(brick.origin()) - Vec3d(kReachSlack));
  box.add(Vec3d(brick.origin()) + Vec3d(kBrickDim + kReachSlack));
  const Vec3i& origin = m_cells.origin(b);
  BrickMask cells{};
  IndexBox near;
  for (int a = 0; a < 3; ++a) {
    near.lo[a] = std::max(0, int(std::floor(box.lo[a] - m_corner_moves[b].hi[a])) - 1 - origin[a]);
    near.hi[a] =
        std::min(kBrickDim - 1, int(std::ceil(box.hi[a] - m_corner_moves[b].lo[a])) - origin[a]);
  }
  if (near.empty()) return;
  const std::uint64_t row = (0xffu >> (kBrickDim - 1 - near.hi.z)) & (0xffu << near.lo.z);
  for (int x = near.lo.x; x <= near.hi.x; ++x) {
    for (int y = near.lo.y; y <= near.hi.y; ++y) cells[std::size_t(x)] |= row << (8 * y);
  }
  keep(cell_mask(m_cells, b), cells);
  for (const TornCell& cell : torn.in(b)) {
    const int offset = brick_offset(cell.cell);
    cells[std::size_t(offset >> 6)] &= ~(std::uint64_t(1) << (offset & 63));
  }
  static constexpr BrickMask kNone{};
  std::array<const Vec3f*, kCellCorners> vectors;
  std::array<const BrickMask*, kCellCorners> elements;
  for (int n = 0; n < kCellCorners; ++n) {
    const Vec3i above = origin + cell_corner(n) * kBrickDim;
    const std::int32_t moving = m_cells.find(above), solid = m_elements.find(above);
    vectors[std::size_t(n)] = moving < 0 ? nullptr : u.vectors.brick_or_zero(std::size_t(moving));
    elements[std::size_t(n)] = solid < 0 ? &kNone : &m_elements.mask(std::size_t(solid));
  }
  PieceRun known = before == nullptr ? PieceRun() : whole_pieces_of(before->cut, origin);
  for_each_active(cells, [&](int offset) {
    const Vec3i local = brick_local(offset);
    std::array<Vec3f, 8> moves;
    unsigned solid = 0;
    for (int n = 0; n < kCellCorners; ++n) {
      const Vec3i corner = local + cell_corner(n);
      const auto from = std::size_t(4 * (corner.x >> 3) + 2 * (corner.y >> 3) + (corner.z >> 3));
      moves[std::size_t(n)] = vectors[from][brick_offset(corner)];
      solid |= unsigned(mask_test(*elements[from], brick_offset(corner))) << n;
    }
    const bool is_at_border = beyond_border(origin + local, m_dims) != 0;
    if (!is_at_border && !reaches(origin + local, moves, box)) return;
    while (known.begin != known.end && voxel_less(known.begin->cell, origin + local)) ++known.begin;
    if (known.begin != known.end && known.begin->cell == origin + local &&
        known.begin->u == moves) {
      brick.add(*known.begin);
      return;
    }
    CutPiece piece(origin + local, moves);
    piece.elements = std::uint8_t(solid);
    piece.go_on(m_dims);
    if (!is_at_border || reaches(piece, box)) brick.add(piece);
  });
}

/// The pieces that reach these bricks: sides in the order of their cells, then whole cells in
/// ascending order of their sources.
std::vector<std::shared_ptr<SplitBrick>> CutInversion::gather(
    const VectorBricks& u, const TornCells& torn, const std::vector<Stale>& stale) const {
  std::unordered_map<Vec3i, std::size_t, VoxelHash> number;
  IndexBox around;
  for (std::size_t n = 0; n < stale.size(); ++n) {
    const Vec3i step = brick_step(stale[n].origin);
    number.emplace(stale[n].origin, n);
    around = join(around, {step, step});
  }
  const auto for_reached = [&](const IndexBox& box, auto&& visit) {
    IndexBox part;
    for (int a = 0; a < 3; ++a) {
      part.lo[a] = std::max(box.lo[a], around.lo[a]);
      part.hi[a] = std::min(box.hi[a], around.hi[a]);
    }
    if (part.empty()) return;
    const Vec3d extent = Vec3d(part.hi - part.lo) + Vec3d(1);
    if (extent.x * extent.y * extent.z > double(stale.size())) {
      for (std::size_t n = 0; n < stale.size(); ++n) {
        if (part.contains(brick_step(stale[n].origin))) visit(n);
      }
      return;
    }
    for_bricks_of(part.lo * kBrickDim, part.hi * kBrickDim, [&](const Vec3i& origin) {
      const auto found = number.find(origin);
      if (found != number.end()) visit(found->second);
    });
  };
  std::vector<std::vector<std::size_t>> sources(stale.size());
  std::vector<std::vector<const CutPiece*>> sides(stale.size());
  for (std::size_t b = 0; b < m_reach.size(); ++b) {
    for_reached(m_reach[b], [&](std::size_t n) { sources[n].push_back(b); });
    if (source(b) == nullptr || source(b)->sides.empty()) continue;
    for_reached(source(b)->sides_reach, [&](std::size_t n) {
      for (const CutPiece& side : source(b)->sides) {
        const IndexBox reach = box_of(side, kReachSlack).bricks();
        if (reach.contains(brick_step(stale[n].origin))) sides[n].push_back(&side);
      }
    });
  }
  std::vector<std::shared_ptr<SplitBrick>> bricks(stale.size());
  parallel_for(bricks.size(), [&](std::size_t n) {
    bricks[n] = std::make_shared<SplitBrick>(stale[n].origin);
    std::stable_sort(sides[n].begin(), sides[n].end(), [](const CutPiece* a, const CutPiece* b) {
      return voxel_less(a->cell, b->cell);
    });
    for (const CutPiece* side : sides[n]) bricks[n]->cut.add(*side);
    for (const std::size_t b : sources[n]) {
      add_pieces(u, torn, b, stale[n].before, bricks[n]->cut);
    }
  });
  return bricks;
}

/// Gathers the bricks that are split. Where sides overlap, the shortest offset may be of either, so
/// the neighbours are split, too. Returns the bricks that are others than before.
std::vector<Vec3i> CutInversion::gather_all(const VectorBricks& u, const TornCells& torn,
                                            Progress* progress) {
  std::unordered_map<Vec3i, Split, VoxelHash> known;
  std::vector<Vec3i> next, others;
  for (const auto& [origin, count] : m_near) next.push_back(origin);
  sort_unique(next);
  while (!next.empty()) {
    report(progress, 1);
    std::vector<Stale> stale;
    for (const Vec3i& origin : next) {
      const auto found = m_split.find(origin);
      Split& split = known[origin];
      if (found != m_split.end()) split = std::move(found->second);
      if (!split.brick || split.is_stale) stale.push_back({origin, split.brick.get()});
    }
    const std::vector<std::shared_ptr<SplitBrick>> gathered = gather(u, torn, stale);
    m_gathered += std::int64_t(stale.size());
    std::vector<std::uint8_t> is_other(stale.size());
    parallel_for(stale.size(), [&](std::size_t n) {
      Split& split = known.at(stale[n].origin);
      split.is_stale = false;
      if (split.brick && split.brick->cut.pieces() == gathered[n]->cut.pieces()) return;
      is_other[n] = 1;
      gathered[n]->solve(split.brick.get(), m_dims);
      split.brick = gathered[n];
    });
    for (std::size_t n = 0; n < stale.size(); ++n) {
      if (is_other[n]) others.push_back(stale[n].origin);
    }
    std::vector<Vec3i> beside;
    for (const Vec3i& origin : next) {
      const bool overlaps = mask_count(known.at(origin).brick->overlaps) > 0;
      for (int side = 0; overlaps && side < 27; ++side) {
        const Vec3i neighbour = origin + surrounding_step(side) * kBrickDim;
        if (known.count(neighbour) == 0) beside.push_back(neighbour);
      }
    }
    sort_unique(beside);
    next = std::move(beside);
  }
  for (const auto& [origin, split] : m_split) {
    if (split.brick) others.push_back(origin);  // split no more
  }
  m_split = std::move(known);
  return others;
}

std::vector<Vec3i> CutInversion::split(const VectorBricks& u, const TornCells& torn,
                                       const CutFaces& faces, const VectorBrickFinder& lattice,
                                       const std::vector<Vec3i>& touched, Progress* progress) {
  std::vector<Vec3i> others = gather_all(u, torn, progress);
  // Nobody reads the offsets that the lattice has in split bricks.
  std::copy_if(touched.begin(), touched.end(), std::back_inserter(others),
               [&](const Vec3i& origin) { return m_split.count(origin) == 0; });
  sort_unique(others);
  const VectorBrickFinder all = [&](const Vec3i& origin) -> VectorBrickView {
    const auto found = m_split.find(origin);
    return found == m_split.end() ? lattice(origin) : found->second.brick->nodes();
  };
  const auto is_other = [&](const Vec3i& origin) {
    return std::binary_search(others.begin(), others.end(), origin, voxel_less);
  };
  const auto sees_others = [&](const Vec3i& origin) {
    bool sees = false;
    for (int n = 1; n < kCellCorners; ++n) {
      sees = sees || is_other(origin + cell_corner(n) * kBrickDim);
    }
    return sees;
  };
  std::vector<Split*> splits;
  m_bricks.clear();
  for (auto& [origin, split] : m_split) {
    splits.push_back(&split);
    m_bricks.push_back(split.brick);
  }
  parallel_for(splits.size(), [&](std::size_t n) {
    Split& split = *splits[n];
    const Vec3i& origin = split.brick->cut.origin();
    BrickMask cells{};
    if (!split.brick->above.are_known() || sees_others(origin)) {
      cells = split.brick->above.follow(all, origin);
    }
    add(std::exchange(split.brick->unsettled, BrickMask{}), cells);
    split.brick->cut.find_interpolated(all, m_dims, cells);
    if (is_other(origin) || split.knows_other_faces) {
      split.brick->look_beside(faces, !split.knows_other_faces);
    }
  });
  for (Split* split : splits) {
    if (std::exchange(split->knows_other_faces, false)) {
      others.push_back(split->brick->cut.origin());
    }
  }
  sort_unique(others);
  std::sort(m_bricks.begin(), m_bricks.end(), [](const auto& a, const auto& b) {
    return voxel_less(a->cut.origin(), b->cut.origin());
  });
  return others;
}

VectorBricks CutInversion::joined(const VectorBricks& lattice) const {
  std::vector<Vec3i> origins;
  std::vector<BrickMask> masks;
  for (std::size_t b = 0; b < lattice.topology.brick_count(); ++b) {
    if (m_split.count(lattice.topology.origin(b)) != 0) continue;
    origins.push_back(lattice.topology.origin(b));
    masks.push_back(lattice.topology.mask(b));
  }
  for (const auto& brick : m_bricks) {
    origins.push_back(brick->cut.origin());
    masks.push_back(brick->valid);
  }
  VectorBricks result{BrickTopology(std::move(origins), std::move(masks)), {}};
  result.vectors.resize(result.topology.brick_count());
  for (std::size_t b = 0; b < result.topology.brick_count(); ++b) {
    const Vec3i& origin = result.topology.origin(b);
    const auto found = m_split.find(origin);
    const Vec3f* const from =
        found != m_split.end() ? found->second.brick->offsets.data()
                               : lattice.vectors.brick(std::size_t(lattice.topology.find(origin)));
    if (from != nullptr) std::copy_n(from, kBrickVoxels, result.vectors.touch(b));
  }
  return result;
}

BrickTopology CutInversion::overlaps(const BrickTopology& lattice) const {
  std::vector<Vec3i> origins;
  std::vector<BrickMask> masks;
  for (const auto& brick : m_bricks) {
    origins.push_back(brick->cut.origin());
    masks.push_back(brick->overlaps);
  }
  for (std::size_t b = 0; b < lattice.brick_count(); ++b) {
    if (m_split.count(lattice.origin(b)) != 0) continue;
    origins.push_back(lattice.origin(b));
    masks.push_back(lattice.mask(b));
  }
  return {std::move(origins), std::move(masks)};
}

}  // namespace supple
