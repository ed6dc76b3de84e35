#include "volumes/field/cuts/cut_offsets.h"

#include <algorithm>
#include <cmath>

namespace supple {

CutOffsets::CutOffsets(std::vector<CutBrick> bricks, CutFaces faces, const Vec3i& dims)
    : m_cells(std::move(bricks)), m_faces(std::move(faces)), m_dims(dims) {
  std::vector<Vec3i> origins;
  for (const CutBrick& brick : m_cells) {
    m_first_piece.push_back(int(m_brick_of.size()));
    m_brick_of.insert(m_brick_of.end(), brick.pieces().size(), std::int32_t(origins.size()));
    for (const CutPiece& piece : brick.pieces()) m_seen.push_back(m_faces.seen_from(piece.cell));
    origins.push_back(brick.origin());
  }
  set_bricks(std::move(origins));
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

bool CutOffsets::face(int number, const Vec3d& /*x*/, const Vec3d& y, Vec3d& normal,
                      double& depth_mm) const {
  const CutFaces::Points* seen = m_seen[std::size_t(number)];
  if (seen == nullptr) return false;
  const PieceOfBrick of = piece_at(number);
  const CutFaces::Depth depth = m_faces.depth(y, of.piece.middle(), seen);
  if (depth.gradient == Vec3d(0)) return false;
  normal = pulled_back(of, y, depth.gradient);
  depth_mm = depth.mm;
  return true;
}

/// What is interpolated is whole.
bool CutOffsets::face_in_source(const Vec3d& y, Vec3d& normal, double& depth_mm) const {
  const Vec3i cell = floor_voxel(y);
  const CutFaces::Points* seen = m_faces.seen_from(cell);
  if (seen == nullptr) return false;
  const CutFaces::Depth depth = m_faces.depth(y, Vec3d(cell) + Vec3d(0.5), seen);
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
