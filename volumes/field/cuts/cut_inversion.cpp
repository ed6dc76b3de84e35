#include "volumes/field/cuts/cut_inversion.h"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>

#include "volumes/field/displacement.h"
#include "volumes/field/inversion/reachable_bricks.h"
#include "volumes/field/inversion/source_cells.h"
#include "volumes/field/ring_fill.h"
#include "volumes/grid/voxel_sets.h"

namespace supple {

namespace {

// Bricks this near to a moved torn cell are split: samples there are shaded as the face, and nodes
// beside the gap must not be interpolated with those across it. In voxels.
constexpr double kNearFace = 3;
constexpr double kNearCell = 1;
// A box of more output bricks is compared with them one by one.
constexpr double kManyBricks = 4096;

CutBox box_of(const CutPiece& piece, double margin) {
  CutBox box;
  box.add(Vec3d(piece.cell) + Vec3d(piece.lo) - Vec3d(margin));
  box.add(Vec3d(piece.cell) + Vec3d(piece.hi) + Vec3d(margin));
  return box;
}

using Bricks = std::unordered_set<Vec3i, VoxelHash>;

/// `visit(origin)` for every brick that the box touches.
template <class Visit>
void for_bricks_of(const CutBox& box, Visit&& visit) {
  const IndexBox bricks = box.bricks();
  for (int x = bricks.lo.x; x <= bricks.hi.x; ++x) {
    for (int y = bricks.lo.y; y <= bricks.hi.y; ++y) {
      for (int z = bricks.lo.z; z <= bricks.hi.z; ++z) visit(Vec3i(x, y, z) * kBrickDim);
    }
  }
}

}  // namespace

CutInversion::CutInversion(const VectorBricks& u, const std::vector<TornCell>& torn,
                           const CutFaces& faces, const BrickTopology& elements, const Vec3i& dims)
    : m_u(u), m_elements(elements), m_dims(dims) {
  for (const TornCell& cell : torn) {
    m_torn_at.insert(cell.cell);
    for (int n = 0; n < 8; ++n) m_corners.insert(cell.cell + Vec3i(n >> 2, n >> 1 & 1, n & 1));
    for (int side = 0; side < cell.sides.count; ++side) {
      m_sides.emplace_back(cell.cell, cell.u[std::size_t(side)],
                           faces.depths_of_corners(cell, side));
      m_sides.back().elements = elements_of(cell.cell);
      nodes_of(m_sides.back().corners(), cell.cell);
    }
  }
  find_source_boxes();
}

VectorBricks CutInversion::whole_part() const {
  std::vector<Vec3i> origins;
  std::vector<BrickMask> masks;
  for (std::size_t b = 0; b < m_u.topology.brick_count(); ++b) {
    origins.push_back(m_u.topology.origin(b));
    masks.push_back(m_u.topology.mask(b));
  }
  for (const Vec3i& voxel : m_corners) {
    const std::int32_t b = m_u.topology.find(voxel);
    const int offset = brick_offset(voxel);
    masks[std::size_t(b)][std::size_t(offset >> 6)] &= ~(std::uint64_t(1) << (offset & 63));
  }
  VectorBricks whole{BrickTopology(origins, masks), {}};
  whole.vectors.resize(whole.topology.brick_count());
  for (std::size_t b = 0; b < whole.topology.brick_count(); ++b) {
    const std::int32_t same = m_u.topology.find(whole.topology.origin(b));
    const Vec3f* const from = m_u.vectors.brick(std::size_t(same));
    if (from != nullptr) std::copy_n(from, kBrickVoxels, whole.vectors.touch(b));
  }
  return whole;
}

/// Corners of the cells of a brick lie in it and in its upper neighbours.
void CutInversion::find_source_boxes() {
  const BrickTopology& bricks = m_u.topology;
  std::vector<CutBox> moves(bricks.brick_count());
  tbb::parallel_for(std::size_t(0), moves.size(), [&](std::size_t b) {
    for_each_active(bricks.mask(b),
                    [&](int offset) { moves[b].add(Vec3d(m_u.vectors.brick_or_zero(b)[offset])); });
  });
  m_boxes.resize(moves.size());
  for (std::size_t b = 0; b < moves.size(); ++b) {
    CutBox move;
    for (int n = 0; n < 8; ++n) {
      const Vec3i step(n >> 2, n >> 1 & 1, n & 1);
      const std::int32_t upper = bricks.find(bricks.origin(b) + step * kBrickDim);
      if (upper < 0) continue;
      move.add(moves[std::size_t(upper)].lo);
      move.add(moves[std::size_t(upper)].hi);
    }
    m_boxes[b].add(Vec3d(bricks.origin(b)) + move.lo - Vec3d(1e-3));
    m_boxes[b].add(Vec3d(bricks.origin(b)) + Vec3d(kBrickDim) + move.hi + Vec3d(1e-3));
  }
}

bool CutInversion::corners_of(const Vec3i& cell, std::array<Vec3f, 8>& u) const {
  for (int n = 0; n < 8; ++n) {
    if (!m_u.at(cell + Vec3i(n >> 2, n >> 1 & 1, n & 1), u[std::size_t(n)])) return false;
  }
  return true;
}

CutPiece CutInversion::whole_piece(const Vec3i& cell, const std::array<Vec3f, 8>& u) const {
  CutPiece piece(cell, u);
  piece.elements = elements_of(cell);
  return piece;
}

/// The corners of a cell that are elements, bit 4 x + 2 y + z.
std::uint8_t CutInversion::elements_of(const Vec3i& cell) const {
  unsigned bits = 0;
  for (int n = 0; n < 8; ++n) {
    Vec3i voxel = cell + Vec3i(n >> 2, n >> 1 & 1, n & 1);
    for (int a = 0; a < 3; ++a) voxel[a] = m_dims[a] == 1 ? 0 : voxel[a];
    bits |= unsigned(m_elements.is_active(voxel)) << n;
  }
  return std::uint8_t(bits);
}

void CutInversion::count_folds(const CutPiece& piece, InversionCertificate& certificate) const {
  const bool is_tissue = piece.elements == 0xff;
  if (is_tissue) {
    certificate.min_det = std::min(certificate.min_det, min_corner_det(piece.corners()));
  }
  if (!piece.is_folded) return;
  ++certificate.folded_cells;
  certificate.folded_air_cells += !is_tissue;
}

/// Around the torn cells, and where the whole cells beside them reach, which share corners with
/// them.
std::vector<Vec3i> CutInversion::first_bricks(InversionCertificate& certificate) const {
  std::vector<Vec3i> bricks, cells;
  const auto add = [&](const Vec3i& origin) { bricks.push_back(origin); };
  certificate.torn_cells = std::int64_t(m_torn_at.size());
  for (const CutPiece& side : m_sides) {
    for_bricks_of(box_of(side, kNearFace), add);
  }
  for (const Vec3i& corner : m_corners) {
    for (int n = 0; n < 8; ++n) cells.push_back(corner - Vec3i(n >> 2, n >> 1 & 1, n & 1));
  }
  sort_unique(cells);
  for (const Vec3i& cell : cells) {
    std::array<Vec3f, 8> u;
    if (is_torn(cell) || !corners_of(cell, u)) continue;
    const CutPiece whole = whole_piece(cell, u);
    ++certificate.cells;
    count_folds(whole, certificate);
    for_bricks_of(box_of(whole, kNearCell), add);
  }
  certificate.cells += std::int64_t(m_torn_at.size());
  sort_unique(bricks);
  return bricks;
}

void CutInversion::add_pieces(std::size_t source, CutBrick& brick) const {
  CutBox box;
  box.add(Vec3d(brick.origin()) - Vec3d(1e-3));
  box.add(Vec3d(brick.origin()) + Vec3d(kBrickDim + 1e-3));
  const auto reaches = [&](const Vec3i& cell, const std::array<Vec3f, 8>& u) {
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
  };
  for_each_active(cell_mask(m_u.topology, source), [&](int offset) {
    const Vec3i cell = m_u.topology.origin(source) + brick_local(offset);
    std::array<Vec3f, 8> u;
    if (corners_of(cell, u) && reaches(cell, u) && !is_torn(cell)) {
      brick.add(whole_piece(cell, u));
    }
  });
}

/// The pieces of the given bricks, in ascending order of their sources.
std::vector<CutBrick> CutInversion::fill(const std::vector<Vec3i>& origins) const {
  std::unordered_map<Vec3i, std::size_t, VoxelHash> number;
  for (std::size_t n = 0; n < origins.size(); ++n) number.emplace(origins[n], n);
  std::vector<std::vector<std::size_t>> sources(origins.size());
  for (std::size_t source = 0; source < m_boxes.size(); ++source) {
    const IndexBox box = m_boxes[source].bricks();
    const Vec3d extent = Vec3d(box.hi - box.lo) + Vec3d(1);
    if (extent.x * extent.y * extent.z > kManyBricks) {
      for (std::size_t n = 0; n < origins.size(); ++n) {
        const Vec3i at(origins[n].x >> 3, origins[n].y >> 3, origins[n].z >> 3);
        if (box.contains(at)) sources[n].push_back(source);
      }
      continue;
    }
    for_bricks_of(m_boxes[source], [&](const Vec3i& origin) {
      const auto found = number.find(origin);
      if (found != number.end()) sources[found->second].push_back(source);
    });
  }
  std::vector<CutBrick> bricks(origins.begin(), origins.end());
  for (const CutPiece& side : m_sides) {
    for_bricks_of(box_of(side, 1e-3), [&](const Vec3i& origin) {
      const auto found = number.find(origin);
      if (found != number.end()) bricks[found->second].add(side);
    });
  }
  tbb::parallel_for(std::size_t(0), bricks.size(), [&](std::size_t n) {
    for (const std::size_t source : sources[n]) add_pieces(source, bricks[n]);
    bricks[n].find_reaching();
  });
  return bricks;
}

BrickMask CutInversion::overlaps_of(const CutBrick& brick) const {
  BrickMask overlaps{};
  for (int n = 0; n < kBrickVoxels; ++n) {
    const Vec3d node(brick.origin() + brick_local(n));
    if (brick.is_overlapped(node, m_dims)) mask_set(overlaps, n);
  }
  return overlaps;
}

/// Where sides overlap, the shortest offset may be of either, so the neighbours are split, too.
std::vector<CutBrick> CutInversion::split_bricks(OffsetField& field, Progress* progress) {
  std::vector<CutBrick> all;
  std::unordered_map<Vec3i, BrickMask, VoxelHash> known;  // overlaps of split bricks
  std::vector<Vec3i> next = first_bricks(field.certificate);
  while (!next.empty()) {
    report(progress, 1);
    std::vector<CutBrick> bricks = fill(next);
    std::vector<BrickMask> overlaps(bricks.size());
    tbb::parallel_for(std::size_t(0), bricks.size(),
                      [&](std::size_t n) { overlaps[n] = overlaps_of(bricks[n]); });
    for (std::size_t n = 0; n < bricks.size(); ++n) known.emplace(bricks[n].origin(), overlaps[n]);
    next.clear();
    for (std::size_t n = 0; n < bricks.size(); ++n) {
      const bool overlap = mask_count(overlaps[n]) > 0;
      for (int side = 0; overlap && side < 27; ++side) {
        const Vec3i step(side / 9 - 1, side / 3 % 3 - 1, side % 3 - 1);
        const Vec3i origin = bricks[n].origin() + step * kBrickDim;
        if (known.count(origin) == 0) next.push_back(origin);
      }
    }
    sort_unique(next);
    std::move(bricks.begin(), bricks.end(), std::back_inserter(all));
  }
  std::sort(all.begin(), all.end(), [](const CutBrick& a, const CutBrick& b) {
    return voxel_less(a.origin(), b.origin());
  });
  for (std::size_t b = 0; b < field.overlaps.brick_count(); ++b) {
    known.emplace(field.overlaps.origin(b), field.overlaps.mask(b));
  }
  std::vector<Vec3i> origins;
  std::vector<BrickMask> masks;
  for (const auto& [origin, mask] : known) {
    origins.push_back(origin);
    masks.push_back(mask);
  }
  field.overlaps = BrickTopology(std::move(origins), std::move(masks));
  field.certificate.overlapped_voxels = field.overlaps.active_count();
  return all;
}

VectorBricks CutInversion::joined(const VectorBricks& offsets,
                                  const std::vector<CutBrick>& bricks) const {
  std::vector<Vec3i> origins;
  std::vector<BrickMask> masks;
  Bricks split;
  for (const CutBrick& brick : bricks) split.insert(brick.origin());
  for (std::size_t b = 0; b < offsets.topology.brick_count(); ++b) {
    if (split.count(offsets.topology.origin(b)) != 0) continue;
    origins.push_back(offsets.topology.origin(b));
    masks.push_back(offsets.topology.mask(b));
  }
  std::vector<std::array<Vec3f, kBrickVoxels>> vectors(bricks.size());
  std::vector<BrickMask> valid(bricks.size(), BrickMask{});
  tbb::parallel_for(std::size_t(0), bricks.size(), [&](std::size_t n) {
    for (int local = 0; local < kBrickVoxels; ++local) {
      Vec3d offset(0);
      const Vec3d node(bricks[n].origin() + brick_local(local));
      if (bricks[n].find(node, m_dims, offset) >= 0) mask_set(valid[n], local);
      vectors[n][std::size_t(local)] = Vec3f(offset);
    }
  });
  std::unordered_map<Vec3i, std::size_t, VoxelHash> number;
  for (std::size_t n = 0; n < bricks.size(); ++n) {
    origins.push_back(bricks[n].origin());
    masks.push_back(valid[n]);
    number.emplace(bricks[n].origin(), n);
  }
  VectorBricks result{BrickTopology(std::move(origins), std::move(masks)), {}};
  result.vectors.resize(result.topology.brick_count());
  for (std::size_t b = 0; b < result.topology.brick_count(); ++b) {
    const Vec3i& origin = result.topology.origin(b);
    const auto found = number.find(origin);
    const Vec3f* from = found != number.end()
                            ? vectors[found->second].data()
                            : offsets.vectors.brick(std::size_t(offsets.topology.find(origin)));
    if (from != nullptr) std::copy_n(from, kBrickVoxels, result.vectors.touch(b));
  }
  return result;
}

void CutInversion::find_interpolated(const VectorBricks& offsets,
                                     std::vector<CutBrick>& bricks) const {
  tbb::parallel_for(std::size_t(0), bricks.size(),
                    [&](std::size_t n) { bricks[n].find_interpolated(offsets, m_dims); });
}

}  // namespace supple
