#include "volumes/field/cuts/cut_offsets.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace supple {

namespace {

/// Along an axis with one slice only what comes from that slice counts, not from its copies.
bool is_in_slice(const Vec3d& X, const Vec3i& dims) {
  for (int a = 0; a < 3; ++a) {
    if (dims[a] == 1 && !(X[a] > -0.5 && X[a] <= 0.5)) return false;
  }
  return true;
}

}  // namespace

int CutBrick::find(const Vec3d& x, const Vec3i& dims, Vec3d& offset, bool* overlapping) const {
  const Vec3i cell(int(std::floor(x.x)), int(std::floor(x.y)), int(std::floor(x.z)));
  const std::size_t local = std::size_t(brick_offset(cell));
  int best = -1;
  double shortest = HUGE_VAL;
  Content best_content = Content::air;
  std::optional<Vec3d> first;  // place of tissue
  for (std::int32_t n = begin[local]; n < begin[local + 1]; ++n) {
    const int number = reaching[std::size_t(n)];
    if (guards[std::size_t(number)].excludes(x)) continue;
    const CutPiece& piece = pieces[std::size_t(number)];
    Vec3d X;
    if (!piece.source_of(x, X) || !is_in_slice(X, dims)) continue;
    const Content content = piece.content_at(X);
    if (overlapping != nullptr && content != Content::air) {
      if (!first) first = X;
      *overlapping = *overlapping || (X - *first).length() > kSamePlace;
    }
    // Exactly that of the lattice where nothing bends.
    const Vec3d o = piece.is_translated ? -Vec3d(piece.u[0]) : X - x;
    if (best >= 0 && content < best_content) continue;
    if (content == best_content && o.length2() >= shortest) continue;
    shortest = o.length2();
    best_content = content;
    offset = o;
    best = number;
  }
  return best;
}

CutOffsets::CutOffsets(std::vector<CutBrick> bricks, CutFaces faces, const Vec3i& dims)
    : m_cells(std::move(bricks)), m_faces(std::move(faces)), m_dims(dims) {
  std::vector<Vec3i> origins;
  int pieces = 0;
  for (const CutBrick& brick : m_cells) {
    origins.push_back(brick.origin);
    m_first_piece.push_back(pieces);
    pieces += int(brick.pieces.size());
  }
  set_bricks(std::move(origins));
}

const CutPiece& CutOffsets::piece_at(int piece) const {
  const auto above = std::upper_bound(m_first_piece.begin(), m_first_piece.end(), piece);
  const std::size_t b = std::size_t(above - m_first_piece.begin()) - 1;
  return m_cells[b].pieces[std::size_t(piece - m_first_piece[b])];
}

bool CutOffsets::sample(std::size_t b, const Vec3d& x, Sample& found) const {
  const int piece = m_cells[b].find(x, m_dims, found.offset);
  found.piece = m_first_piece[b] + piece;
  return piece >= 0;
}

bool CutOffsets::offset_of(int piece, const Vec3d& x, Vec3d& offset) const {
  Vec3d X;
  if (!piece_at(piece).source_beyond(x, X)) return false;
  offset = X - x;
  return true;
}

bool CutOffsets::is_overlapped(const Vec3d& x) const {
  const std::int32_t b = bricks().find(floor_voxel(x));
  Vec3d offset;
  bool overlapping = false;
  if (b >= 0) m_cells[std::size_t(b)].find(x, m_dims, offset, &overlapping);
  return overlapping;
}

double CutOffsets::depth_mm(int number, const Vec3d& x) const {
  Vec3d X, normal;
  double depth;
  const bool is_known = piece_at(number).source_beyond(x, X) && face(number, x, X, normal, depth);
  return is_known ? depth : HUGE_VAL;
}

Vec3d CutOffsets::face_normal(int number, const Vec3d& x) const {
  Vec3d X, normal;
  double depth;
  const bool is_known = piece_at(number).source_beyond(x, X) && face(number, x, X, normal, depth);
  return is_known ? normal : Vec3d(0);
}

Vec3d CutOffsets::pull_back(int number, const Vec3d& /*x*/, const Vec3d& y,
                            const Vec3d& gradient) const {
  return piece_at(number).pull_back(y, gradient);
}

bool CutOffsets::face(int number, const Vec3d& /*x*/, const Vec3d& y, Vec3d& normal,
                      double& depth_mm) const {
  const CutPiece& piece = piece_at(number);
  const CutFaces::Depth depth = m_faces.depth(y, piece.middle());
  if (depth.gradient == Vec3d(0)) return false;
  normal = piece.pull_back(y, depth.gradient);
  depth_mm = depth.mm;
  return true;
}

void CutOffsets::source_box(std::size_t b, Vec3d& lo, Vec3d& hi) const {
  lo = Vec3d(HUGE_VAL);
  hi = Vec3d(-HUGE_VAL);
  for (const CutPiece& piece : m_cells[b].pieces) {
    for (int a = 0; a < 3; ++a) {
      lo[a] = std::min(lo[a], double(piece.cell[a]));
      hi[a] = std::max(hi[a], double(piece.cell[a] + 1));
    }
  }
}

}  // namespace supple
