#include "volumes/field/cuts/cut_brick.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace supple {

namespace {

// Of offsets as long, to this many voxels, that of the first piece counts, not the rounding.
constexpr double kSameLength = 1e-4;

/// Along an axis with one slice only what comes from that slice counts, not from its copies.
bool is_in_slice(const Vec3d& X, const Vec3i& dims) {
  for (int a = 0; a < 3; ++a) {
    if (dims[a] == 1 && !(X[a] > -0.5 && X[a] <= 0.5)) return false;
  }
  return true;
}

/// Exactly that of the lattice where nothing bends.
Vec3d offset_of(const CutPiece& piece, const Vec3d& X, const Vec3d& x) {
  return piece.is_translated ? -Vec3d(piece.u[0]) : X - x;
}

}  // namespace

void CutBrick::find_reaching() {
  for (const CutPiece& piece : m_pieces) m_maps.emplace_back(piece);
  std::vector<std::pair<std::int32_t, std::int32_t>> pairs;  // cell, piece
  for (std::size_t p = 0; p < m_pieces.size(); ++p) {
    const Vec3d at(m_pieces[p].cell - m_origin);
    Vec3i lo, hi;
    for (int a = 0; a < 3; ++a) {
      lo[a] = int(std::floor(std::max(at[a] + m_pieces[p].lo[a] - 1e-3, 0.0)));
      hi[a] = int(std::floor(std::min(at[a] + m_pieces[p].hi[a] + 1e-3, kBrickDim - 1.0)));
    }
    for (int x = lo.x; x <= hi.x; ++x) {
      for (int y = lo.y; y <= hi.y; ++y) {
        for (int z = lo.z; z <= hi.z; ++z) pairs.emplace_back(brick_offset({x, y, z}), int(p));
      }
    }
  }
  std::sort(pairs.begin(), pairs.end());
  m_begin.assign(kBrickVoxels + 1, 0);
  for (const auto& [cell, piece] : pairs) {
    ++m_begin[std::size_t(cell) + 1];
    m_reaching.push_back(piece);
  }
  for (std::size_t n = 0; n < kBrickVoxels; ++n) m_begin[n + 1] += m_begin[n];
  for (std::size_t n = 0; n < kBrickVoxels; ++n) {
    if (is_single(n)) mask_set(m_single, int(n));
  }
}

/// Whole cells that hold together by faces and do not fold reach no place twice.
bool CutBrick::is_single(std::size_t cell) const {
  const std::int32_t begin = m_begin[cell], end = m_begin[cell + 1];
  constexpr int kMostPieces = 64;
  if (begin == end || end - begin > kMostPieces) return false;
  Vec3i cells[kMostPieces];
  int count = 0;
  for (std::int32_t n = begin; n < end; ++n) {
    const CutPiece& piece = m_pieces[std::size_t(m_reaching[std::size_t(n)])];
    if (!piece.is_whole || piece.is_folded) return false;
    cells[count++] = piece.cell;
  }
  int reached = 1;  // those before are joined to the first
  for (int n = 0; n < reached; ++n) {
    for (int other = reached; other < count; ++other) {
      const Vec3i step = cells[other] - cells[n];
      if (step.dot(step) == 1) std::swap(cells[other], cells[reached++]);
    }
  }
  return reached == count;
}

bool CutBrick::source_of(int number, const Vec3d& x, Vec3d& X) const {
  const CutPiece& piece = m_pieces[std::size_t(number)];
  Vec3d local;
  const PieceMap::Outcome outcome = m_maps[std::size_t(number)].solve(x, local);
  if (outcome == PieceMap::Outcome::outside) return false;
  if (piece.is_translated || outcome == PieceMap::Outcome::undecided) return piece.source_of(x, X);
  X = Vec3d(piece.cell) + local;
  return piece.is_own(local);
}

/// `visit(number, X)` for every piece that has x.
template <class Visit>
void CutBrick::for_found(const Vec3d& x, const Vec3i& dims, Visit&& visit) const {
  const std::size_t cell = std::size_t(brick_offset(floor_voxel(x)));
  for (std::int32_t n = m_begin[cell]; n < m_begin[cell + 1]; ++n) {
    const int number = m_reaching[std::size_t(n)];
    Vec3d X;
    if (source_of(number, x, X) && is_in_slice(X, dims)) visit(number, X);
  }
}

int CutBrick::find(const Vec3d& x, const Vec3i& dims, Vec3d& offset, int guess) const {
  if (guess >= 0 && mask_test(m_single, brick_offset(floor_voxel(x)))) {
    const CutPiece& piece = m_pieces[std::size_t(guess)];
    Vec3d local;
    if (m_maps[std::size_t(guess)].solve(x, local) == PieceMap::Outcome::inside &&
        is_in_slice(Vec3d(piece.cell) + local, dims)) {
      offset = offset_of(piece, Vec3d(piece.cell) + local, x);
      return guess;
    }
  }
  int best = -1;
  double shortest = HUGE_VAL;  // length
  Content best_content = Content::air;
  for_found(x, dims, [&](int number, const Vec3d& X) {
    const CutPiece& piece = m_pieces[std::size_t(number)];
    const Content content = piece.content_at(X);
    const Vec3d o = offset_of(piece, X, x);
    if (best >= 0 && content < best_content) return;
    const double length = o.length();
    if (content == best_content && length > shortest - kSameLength) return;
    shortest = length;
    best_content = content;
    offset = o;
    best = number;
  });
  return best;
}

bool CutBrick::is_overlapped(const Vec3d& x, const Vec3i& dims) const {
  std::optional<Vec3d> first;  // place of tissue
  bool is_overlapped = false;
  for_found(x, dims, [&](int number, const Vec3d& X) {
    if (m_pieces[std::size_t(number)].content_at(X) == Content::air) return;
    if (!first) first = X;
    is_overlapped = is_overlapped || (X - *first).length() > kSamePlace;
  });
  return is_overlapped;
}

}  // namespace supple
