#include "volumes/field/cuts/cut_offsets.h"

#include <algorithm>
#include <cmath>

#include "volumes/grid/cell.h"

namespace supple {

// The surface of a cut may reach so far, in voxels, into cells that it leaves whole.
constexpr double kGrazed = 0.25;

CutOffsets::CutOffsets(std::vector<CutBrick> bricks, CutFaces faces, const Vec3i& dims)
    : m_cells(std::move(bricks)), m_faces(std::move(faces)), m_dims(dims) {
  std::vector<Vec3i> origins;
  for (const CutBrick& brick : m_cells) {
    m_first_piece.push_back(int(m_brick_of.size()));
    m_brick_of.insert(m_brick_of.end(), brick.pieces().size(), std::int32_t(origins.size()));
    for (const CutPiece& piece : brick.pieces()) m_beside.push_back(beside(piece));
    origins.push_back(brick.origin());
  }
  set_bricks(std::move(origins));
}

CutOffsets::Beside CutOffsets::beside(const CutPiece& piece) const {
  const CutFaces::Points* const seen = m_faces.seen_from(piece.cell);
  if (seen == nullptr || !piece.is_whole) return {seen, 0};
  const Vec3d middle = piece.middle();
  const auto depth_at = [&](const Vec3d& X) {  // voxels
    const CutFaces::Depth depth = m_faces.depth_beyond(X, middle, seen);
    return depth.mm / depth.gradient.length();
  };
  if (!(depth_at(middle) < 1)) return {seen, 0};
  for (int n = 0; n < 8; ++n) {
    if (depth_at(Vec3d(piece.cell + cell_corner(n))) < -kGrazed) {
      return {nullptr, m_faces.torn_beside(piece.cell)};
    }
  }
  return {seen, 0};
}

CutOffsets::PieceOfBrick CutOffsets::piece_at(int piece) const {
  const std::size_t b = std::size_t(m_brick_of[std::size_t(piece)]);
  const int number = piece - m_first_piece[b];
  return {m_cells[b].pieces()[std::size_t(number)], m_cells[b].map(number)};
}

bool CutOffsets::sample(std::size_t b, const Vec3d& x, Sample& found) const {
  const CutBrick& brick = m_cells[b];
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

bool CutOffsets::is_overlapped(const Vec3d& x) const {
  const std::int32_t b = bricks().find(floor_voxel(x));
  return b >= 0 && m_cells[std::size_t(b)].is_overlapped(x, m_dims);
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
    const CutPiece& piece = piece_at(number).piece;
    const Beside& beside = m_beside[std::size_t(number)];
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
  for (const CutPiece& piece : m_cells[b].pieces()) {
    for (int a = 0; a < 3; ++a) {
      lo[a] = std::min(lo[a], double(piece.cell[a]));
      hi[a] = std::max(hi[a], double(piece.cell[a] + 1));
    }
  }
}

}  // namespace supple
