#include "volumes/field/cuts/cut_offsets.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "volumes/grid/cell.h"

namespace supple {

namespace {

/// The cells of a brick that have a corner at a node, relative to its lowest voxel.
BrickMask cells_at(const Vec3i& node) {
  BrickMask cells{};
  for (int n = 0; n < kCellCorners; ++n) {
    const Vec3i cell = node - cell_corner(n);
    if (std::min({cell.x, cell.y, cell.z}) < 0) continue;
    if (std::max({cell.x, cell.y, cell.z}) < kBrickDim) mask_set(cells, brick_offset(cell));
  }
  return cells;
}

}  // namespace

BrickMask UpperNodes::follow(const VectorBrickFinder& lattice, const Vec3i& origin) {
  std::array<VectorBrickView, kCellCorners> views;
  for (int n = 1; n < kCellCorners; ++n) {
    views[std::size_t(n)] = lattice(origin + cell_corner(n) * kBrickDim);
  }
  BrickMask changed{};
  std::size_t number = 0;
  for (int at = 0; at < 9 * 9 * 9; ++at) {
    const Vec3i node(at / 81, at / 9 % 9, at % 9);
    const int above = 4 * (node.x >> 3) + 2 * (node.y >> 3) + (node.z >> 3);
    if (above == 0) continue;
    const std::size_t n = number++;
    const VectorBrickView& view = views[std::size_t(above)];
    const bool is_valid = view.mask != nullptr && mask_test(*view.mask, brick_offset(node));
    const Vec3f vector = is_valid ? view.vectors[brick_offset(node)] : Vec3f(0);
    if (m_are_known && m_valid[n] == is_valid &&
        std::memcmp(&m_vectors[n], &vector, sizeof vector) == 0) {
      continue;
    }
    m_valid[n] = is_valid;
    m_vectors[n] = vector;
    const BrickMask cells = cells_at(node);
    for (std::size_t word = 0; word < cells.size(); ++word) changed[word] |= cells[word];
  }
  m_are_known = true;
  return changed;
}

// The surface of a cut may reach so far, in voxels, into cells that it leaves whole.
constexpr double kGrazed = 0.25;
// Numbers of pieces go to bricks in groups of so many.
constexpr int kPieces = 64;

CutOffsets::CutOffsets(const BrickTopology& cells, const Geometry& geometry)
    : m_faces(cells, geometry, kClosedCut), m_dims(geometry.dims()) {}

void CutOffsets::set_bricks(const std::vector<std::shared_ptr<const SplitBrick>>& bricks) {
  m_bricks = bricks;
  m_first_piece.clear();
  m_brick_of.clear();
  std::vector<Vec3i> origins;
  for (std::size_t b = 0; b < bricks.size(); ++b) {
    const std::size_t groups = (bricks[b]->cut.pieces().size() + kPieces - 1) / kPieces;
    m_first_piece.push_back(int(m_brick_of.size() * kPieces));
    m_brick_of.insert(m_brick_of.end(), groups, std::int32_t(b));
    origins.push_back(bricks[b]->cut.origin());
  }
  if (origins != this->bricks().index().origins()) {
    PointwiseOffsets::set_bricks(std::move(origins));
  }
}

void SplitBrick::solve(const SplitBrick* before, const Vec3i& dims) {
  const CutBrick::Kept kept = cut.find_reaching(before == nullptr ? nullptr : &before->cut);
  BrickMask others{};  // nodes
  int piece = -1;
  for (int n = 0; n < kBrickVoxels; ++n) {
    const Vec3d node(cut.origin() + brick_local(n));
    const bool is_kept = before != nullptr && !kept.is_other_part[cut.part_of(node)];
    Vec3d offset(0);
    if (!is_kept) {  // mostly cells along a row follow each other
      const bool has_next = piece >= 0 && piece + 1 < int(cut.pieces().size());
      piece = cut.find(node, dims, offset, has_next ? piece + 1 : -1);
    }
    const bool is_valid = is_kept ? mask_test(before->valid, n) : piece >= 0;
    offsets[std::size_t(n)] = is_kept ? before->offsets[std::size_t(n)] : Vec3f(offset);
    if (is_valid) mask_set(valid, n);
    if (is_kept ? mask_test(before->overlaps, n) : cut.is_overlapped(node, dims)) {
      mask_set(overlaps, n);
    }
    const bool is_same = before != nullptr && is_valid == mask_test(before->valid, n) &&
                         offsets[std::size_t(n)] == before->offsets[std::size_t(n)];
    if (!is_same) mask_set(others, n);
  }
  for (int cell = 0; cell < kBrickVoxels; ++cell) {
    bool is_other = false;
    for (int n = 0; n < kCellCorners && !is_other; ++n) {
      const Vec3i corner = brick_local(cell) + cell_corner(n);
      const bool is_inside = std::max({corner.x, corner.y, corner.z}) < kBrickDim;
      const Vec3d part = Vec3d(cut.origin() + brick_local(cell)) + Vec3d(cell_corner(n)) * 0.5;
      is_other = kept.is_other_part[cut.part_of(part)] ||
                 (is_inside && mask_test(others, brick_offset(corner)));
    }
    if (is_other) mask_set(unsettled, cell);
  }
  if (before != nullptr) {
    cut.set_interpolated(before->cut.interpolated());
    above = before->above;
  }
  beside.resize(cut.pieces().size());
  is_beside_known.assign(beside.size(), false);
  for (std::size_t n = 0; n < beside.size(); ++n) {
    if (kept.piece[n] < 0) continue;
    beside[n] = before->beside[std::size_t(kept.piece[n])];
    is_beside_known[n] = true;
  }
}

/// Finds the faces or torn cells beside a piece.
static SplitBrick::Beside beside_of(const CutPiece& piece, const CutFaces& faces) {
  const CutFaces::Points* const seen = faces.seen_from(piece.cell);
  if (seen == nullptr || !piece.is_whole) return {seen, 0};
  const Vec3d middle = piece.middle();
  const auto depth_at = [&](const Vec3d& X) {  // voxels
    const CutFaces::Depth depth = faces.depth_beyond(X, middle, seen);
    return depth.mm / depth.gradient.length();
  };
  if (!(depth_at(middle) < 1)) return {seen, 0};
  for (int n = 0; n < 8; ++n) {
    if (depth_at(Vec3d(piece.cell + cell_corner(n))) < -kGrazed) {
      return {nullptr, faces.torn_beside(piece.cell)};
    }
  }
  return {seen, 0};
}

void SplitBrick::look_beside(const CutFaces& faces, bool known) {
  for (std::size_t n = 0; n < beside.size(); ++n) {
    if (known && is_beside_known[n]) continue;
    beside[n] = beside_of(cut.pieces()[n], faces);
  }
  is_beside_known.assign(beside.size(), true);
}

CutOffsets::PieceOfBrick CutOffsets::piece_at(int piece) const {
  const std::size_t b = std::size_t(m_brick_of[std::size_t(piece / kPieces)]);
  const int number = piece - m_first_piece[b];
  const SplitBrick& brick = *m_bricks[b];
  return {brick.cut.pieces()[std::size_t(number)], brick.cut.map(number),
          brick.beside[std::size_t(number)]};
}

bool CutOffsets::sample(std::size_t b, const Vec3d& x, Sample& found) const {
  const CutBrick& brick = m_bricks[b]->cut;
  const int guess = found.piece - m_first_piece[b];
  const bool is_own = guess >= 0 && guess < int(brick.pieces().size());
  const int piece = brick.find(x, m_dims, found.offset, is_own ? guess : -1);
  if (piece < 0) return false;
  found.piece = m_first_piece[b] + piece;
  return true;
}

bool CutOffsets::offset_of(int piece, const Vec3d& x, Vec3d& offset) const {
  Vec3d X;
  if (!piece_at(piece).piece.source_beyond(x, X)) return false;
  offset = X - x;
  return true;
}

bool CutOffsets::place_at(const Vec3d& x, Vec3d& place, bool& is_ambiguous) const {
  const std::int32_t b = bricks().find(floor_voxel(x));
  return b >= 0 && m_bricks[std::size_t(b)]->cut.find_place(x, m_dims, place, is_ambiguous);
}

double CutOffsets::depth_mm(int number, const Vec3d& x) const {
  Vec3d X;
  const CutPiece& piece = piece_at(number).piece;
  return piece.source_beyond(x, X) ? m_faces.depth(X, piece.middle()).mm : HUGE_VAL;
}

Vec3d CutOffsets::face_normal(int number, const Vec3d& x) const {
  Vec3d X;
  const PieceOfBrick of = piece_at(number);
  if (!of.piece.source_beyond(x, X)) return Vec3d(0);
  return pulled_back(of, X, m_faces.depth(X, of.piece.middle()).gradient);
}

Vec3d CutOffsets::pulled_back(const PieceOfBrick& of, const Vec3d& y, const Vec3d& gradient) {
  if (of.piece.is_translated || !of.map.is_regular()) return of.piece.pull_back(y, gradient);
  return of.map.pull_back(y - Vec3d(of.piece.cell), gradient);
}

Vec3d CutOffsets::pull_back(int number, const Vec3d& /*x*/, const Vec3d& y,
                            const Vec3d& gradient) const {
  return pulled_back(piece_at(number), y, gradient);
}

bool CutOffsets::offset_beside(int number, const Vec3d& place, Vec3d& offset) const {
  const std::int32_t b = bricks().find(floor_voxel(place));
  Sample found;
  found.piece = number;
  if (b >= 0 && sample(std::size_t(b), place, found) &&
      piece_at(number).piece.is_joined_to(piece_at(found.piece).piece)) {
    offset = found.offset;
    return true;
  }
  return offset_of(number, place, offset);
}

bool CutOffsets::face(int number, const Vec3d& /*x*/, const Vec3d& y, Vec3d& normal,
                      double& depth_mm) const {
  if (!face_in_source(number, y, normal, depth_mm)) return false;
  normal = pulled_back(piece_at(number), y, normal);
  return true;
}

bool CutOffsets::face_in_source(int number, const Vec3d& y, Vec3d& normal, double& depth_mm) const {
  CutFaces::Depth depth{HUGE_VAL, Vec3d(0)};
  if (number < 0) {  // what is interpolated is whole
    const Vec3i cell = floor_voxel(y);
    depth = m_faces.depth(y, Vec3d(cell) + Vec3d(0.5), m_faces.seen_from(cell));
  } else {
    const PieceOfBrick of = piece_at(number);
    const CutPiece& piece = of.piece;
    const SplitBrick::Beside& beside = of.beside;
    if (beside.seen != nullptr) {
      depth = m_faces.depth(y, piece.middle(), beside.seen);
    } else if (beside.torn != 0) {
      depth = m_faces.depth_of_end(y, piece.cell, beside.torn);
    }
  }
  normal = depth.gradient;
  depth_mm = depth.mm;
  return normal != Vec3d(0);
}

void CutOffsets::source_box(std::size_t b, Vec3d& lo, Vec3d& hi) const {
  lo = Vec3d(HUGE_VAL);
  hi = Vec3d(-HUGE_VAL);
  for (const CutPiece& piece : m_bricks[b]->cut.pieces()) {
    for (int a = 0; a < 3; ++a) {
      lo[a] = std::min(lo[a], piece.cell[a] + piece.from(a));
      hi[a] = std::max(hi[a], piece.cell[a] + piece.to(a));
    }
  }
}

}  // namespace supple
