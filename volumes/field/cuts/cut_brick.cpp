#include "volumes/field/cuts/cut_brick.h"

#include <algorithm>
#include <cmath>

#include "volumes/grid/cell.h"

namespace supple {

namespace {

// Cells are interpolated where that is off by no more than this, in voxels.
constexpr double kBent = 0.02;
// More pieces than this are not told to be single.
constexpr int kMostPieces = 64;
// Places that were refined and are farther apart are different ones, in voxels.
constexpr double kSameExactly = 5e-5;
// Offsets whose lengths differ by less, in voxels, are equal: that of the first piece is taken.
constexpr double kSameLength = 1e-4;

/// True if X lies in the slice: along an axis with one slice only that counts, not its copies.
bool is_in_slice(const Vec3d& X, const Vec3i& dims) {
  for (int a = 0; a < 3; ++a) {
    if (dims[a] == 1 && !(X[a] > -0.5 && X[a] <= 0.5)) return false;
  }
  return true;
}

/// True if cells meet in a face that moved alike.
bool hold_together(const CutPiece& a, const CutPiece& b) {
  const Vec3i step = b.cell - a.cell;
  return step.dot(step) == 1 && a.is_joined_to(b);
}

/// True if a piece goes on over the cell of another one.
bool goes_over(const CutPiece& a, const CutPiece& b) {
  for (int axis = 0; axis < 3 && a.beyond != 0; ++axis) {
    if (a.from(axis) < 0 && b.cell[axis] < a.cell[axis]) return true;
    if (a.to(axis) > 1 && b.cell[axis] > a.cell[axis]) return true;
  }
  return false;
}

/// True if pieces that hold together may reach a place twice: if one goes on over the other, or if
/// their cells touch and have not moved alike there, as whole ones always have.
bool may_overlap(const CutPiece& a, const CutPiece& b) {
  const bool are_whole = a.is_whole && b.is_whole;
  return a.cell == b.cell || goes_over(a, b) || goes_over(b, a) ||
         (!are_whole && a.joint_with(b) == CutPiece::Joint::torn);
}

/// Offset of a place, exactly that of the lattice where nothing bends.
Vec3d offset_of(const CutPiece& piece, const Vec3d& X, const Vec3d& x) {
  return piece.is_translated ? -Vec3d(piece.u[0]) : X - x;
}

}  // namespace

/// `visit(part)` for all that the box of a piece touches.
template <class Visit>
void CutBrick::for_parts(const CutPiece& piece, Visit&& visit) const {
  const Vec3d at(piece.cell - m_origin);
  Vec3i lo, hi;
  for (int a = 0; a < 3; ++a) {
    lo[a] = int(std::floor(std::max((at[a] + piece.lo[a] - 1e-3) * kParts, 0.0)));
    hi[a] = int(std::floor(std::min((at[a] + piece.hi[a] + 1e-3) * kParts, kPartDim - 1.0)));
  }
  for (int x = lo.x; x <= hi.x; ++x) {
    for (int y = lo.y; y <= hi.y; ++y) {
      const std::size_t row = (std::size_t(x) * kPartDim + std::size_t(y)) * kPartDim;
      for (int z = lo.z; z <= hi.z; ++z) visit(row + std::size_t(z));
    }
  }
}

/// The former number of every piece, or -1. Both bricks have sides by their cells, then whole cells
/// by their bricks.
std::vector<std::int32_t> CutBrick::pieces_before(const CutBrick& before) const {
  const auto comes_first = [](const CutPiece& a, const CutPiece& b) {
    if (a.is_whole != b.is_whole) return b.is_whole;
    if (!a.is_whole) return voxel_less(a.cell, b.cell);
    const Vec3i brick_a(a.cell.x >> 3, a.cell.y >> 3, a.cell.z >> 3);
    const Vec3i brick_b(b.cell.x >> 3, b.cell.y >> 3, b.cell.z >> 3);
    return brick_a == brick_b ? voxel_less(a.cell, b.cell) : voxel_less(brick_a, brick_b);
  };
  std::vector<std::int32_t> numbers(m_pieces.size(), -1);
  std::size_t old = 0;
  for (std::size_t n = 0; n < m_pieces.size(); ++n) {
    while (old < before.m_pieces.size() && comes_first(before.m_pieces[old], m_pieces[n])) ++old;
    if (old == before.m_pieces.size()) break;
    if (before.m_pieces[old] == m_pieces[n]) numbers[n] = std::int32_t(old++);
  }
  return numbers;
}

CutBrick::Kept CutBrick::find_reaching(const CutBrick* before) {
  m_pieces.shrink_to_fit();
  Kept kept{std::vector<std::int32_t>(m_pieces.size(), -1), std::vector<bool>(kPartCount, true)};
  if (before != nullptr) {
    kept.piece = pieces_before(*before);
    kept.is_other_part.assign(kPartCount, false);
    const auto mark = [&](std::size_t part) { kept.is_other_part[part] = true; };
    std::vector<bool> is_gone(before->m_pieces.size(), true);
    for (std::size_t n = 0; n < m_pieces.size(); ++n) {
      if (kept.piece[n] < 0) for_parts(m_pieces[n], mark);
      if (kept.piece[n] >= 0) is_gone[std::size_t(kept.piece[n])] = false;
    }
    for (std::size_t n = 0; n < is_gone.size(); ++n) {
      if (is_gone[n]) for_parts(before->m_pieces[n], mark);
    }
  }
  m_maps.reserve(m_pieces.size());
  for (std::size_t n = 0; n < m_pieces.size(); ++n) {
    if (kept.piece[n] >= 0) {
      m_maps.push_back(before->m_maps[std::size_t(kept.piece[n])]);
    } else {
      m_maps.emplace_back(m_pieces[n]);
    }
  }
  m_begin.assign(kPartCount + 1, 0);
  for (const CutPiece& piece : m_pieces) {
    for_parts(piece, [&](std::size_t part) { ++m_begin[part + 1]; });
  }
  for (std::size_t n = 0; n < kPartCount; ++n) m_begin[n + 1] += m_begin[n];
  m_reaching.resize(std::size_t(m_begin[kPartCount]));
  std::vector<std::int32_t> next(m_begin.begin(), m_begin.end() - 1);
  for (std::size_t p = 0; p < m_pieces.size(); ++p) {
    for_parts(m_pieces[p],
              [&](std::size_t part) { m_reaching[std::size_t(next[part]++)] = std::int32_t(p); });
  }
  m_single.resize(kPartCount);
  // Mostly a part is reached by the same pieces as the one before.
  const std::int32_t* last = m_reaching.data();
  for (std::size_t n = 0; n < kPartCount; ++n) {
    const std::int32_t* begin = m_reaching.data() + m_begin[n];
    const std::int32_t* end = m_reaching.data() + m_begin[n + 1];
    if (!kept.is_other_part[n]) {
      m_single[n] = before->m_single[n];
    } else {
      m_single[n] =
          n > 0 && std::equal(last, begin, begin, end) ? m_single[n - 1] : is_single(begin, end);
    }
    last = begin;
  }
  return kept;
}

/// Different cells that hold together by faces and do not fold reach no place twice, unless some of
/// them touch elsewhere and do not hold together there, as around the end of a cut.
bool CutBrick::is_single(const std::int32_t* begin, const std::int32_t* end) const {
  if (begin == end || end - begin > kMostPieces) return false;
  const CutPiece* pieces[kMostPieces];
  int count = 0;
  for (const std::int32_t* number = begin; number != end; ++number) {
    const CutPiece& piece = m_pieces[std::size_t(*number)];
    const bool overlaps = std::any_of(
        pieces, pieces + count, [&](const CutPiece* other) { return may_overlap(*other, piece); });
    if (piece.is_folded || piece.folds_beyond || overlaps) return false;
    pieces[count++] = &piece;
  }
  int reached = 1;  // those before are joined to the first
  for (int n = 0; n < reached; ++n) {
    for (int other = reached; other < count; ++other) {
      if (hold_together(*pieces[n], *pieces[other])) std::swap(pieces[other], pieces[reached++]);
    }
  }
  return reached == count;
}

/// The offsets of a brick and of those above it, as VectorBricks tells them.
class BrickLattice {
 public:
  BrickLattice(const VectorBrickFinder& finder, const Vec3i& origin) : m_origin(origin) {
    for (int n = 0; n < kCellCorners; ++n) {
      m_views[std::size_t(n)] = finder(origin + cell_corner(n) * kBrickDim);
    }
  }

  bool at(const Vec3i& voxel, Vec3f& vector) const {
    const Vec3i local = voxel - m_origin;
    const VectorBrickView& view =
        m_views[std::size_t(4 * (local.x >> 3) + 2 * (local.y >> 3) + (local.z >> 3))];
    const int offset = brick_offset(voxel);
    if (view.mask == nullptr || !mask_test(*view.mask, offset)) return false;
    vector = view.vectors[offset];
    return true;
  }

 private:
  Vec3i m_origin;
  std::array<VectorBrickView, kCellCorners> m_views;
};

/// Interpolates the vectors at the corners of a cell at a place in it.
static Vec3d interpolated_at(const Vec3d& t, const std::array<Vec3f, kCellCorners>& corners) {
  Vec3d sum(0);
  for (int n = 0; n < kCellCorners; ++n) {
    const Vec3i step = cell_corner(n);
    const double w = (step.x ? t.x : 1 - t.x) * (step.y ? t.y : 1 - t.y) * (step.z ? t.z : 1 - t.z);
    sum += Vec3d(corners[std::size_t(n)]) * w;
  }
  return sum;
}

/// True if nodes give what samples find, to kBent, in the middle of the cell and of its parts.
bool CutBrick::bends_little(int cell, const std::array<Vec3f, kCellCorners>& nodes,
                            const Vec3i& dims) const {
  const Vec3d low(m_origin + brick_local(cell));
  int piece = -1;
  for (int n = 0; n < 9; ++n) {
    const Vec3d t = n < 8 ? Vec3d(0.25) + Vec3d(cell_corner(n)) * 0.5 : Vec3d(0.5);
    Vec3d own;
    piece = find(low + t, dims, own, piece);
    if (piece < 0 || (own - interpolated_at(t, nodes)).length() > kBent) return false;
  }
  return true;
}

/// Finds the interpolated cells among the given ones.
void CutBrick::find_interpolated(const VectorBrickFinder& finder, const Vec3i& dims,
                                 const BrickMask& cells) {
  const BrickLattice offsets(finder, m_origin);
  std::vector<std::int32_t> reaching;
  for_each_active(cells, [&](int cell) {
    const Vec3i local = brick_local(cell);
    std::array<Vec3f, kCellCorners> nodes;
    bool is_interpolated = true;
    for (int n = 0; n < kCellCorners && is_interpolated; ++n) {
      is_interpolated = offsets.at(m_origin + local + cell_corner(n), nodes[std::size_t(n)]);
    }
    is_interpolated = is_interpolated && reach_cell(local, reaching);
    std::int32_t last = -1;  // mostly it has the next node, too
    for (int n = 0; n < kCellCorners && is_interpolated; ++n) {
      const Vec3d node(m_origin + local + cell_corner(n)), offset(nodes[std::size_t(n)]);
      if (last >= 0 && m_pieces[std::size_t(last)].has(node, offset)) continue;
      const auto found = std::find_if(reaching.begin(), reaching.end(), [&](std::int32_t piece) {
        return m_pieces[std::size_t(piece)].has(node, offset);
      });
      is_interpolated = found != reaching.end();
      if (is_interpolated) last = *found;
    }
    is_interpolated = is_interpolated && bends_little(cell, nodes, dims);
    const std::uint64_t bit = std::uint64_t(1) << (cell & 63);
    std::uint64_t& word = m_interpolated[std::size_t(cell >> 6)];
    word = is_interpolated ? word | bit : word & ~bit;
  });
}

/// Finds the pieces that reach the parts of a cell, ascending; true if they are whole and single.
bool CutBrick::reach_cell(const Vec3i& local, std::vector<std::int32_t>& reaching) const {
  const auto first = m_reaching.begin() + m_begin[part_of(Vec3d(m_origin + local))];
  const auto end = m_reaching.begin() + m_begin[part_of(Vec3d(m_origin + local)) + 1];
  reaching.assign(first, end);
  // Parts of which each is single, and that share a piece, hold together.
  bool is_joined = true;
  for (int n = 0; n < kCellCorners; ++n) {
    const std::size_t p = part_of(Vec3d(m_origin + local) + Vec3d(cell_corner(n)) * 0.5);
    const auto begin = m_reaching.begin() + m_begin[p];
    const auto count = std::ptrdiff_t(m_begin[p + 1] - m_begin[p]);
    is_joined = is_joined && m_single[p];
    if (n == 0 || std::equal(first, end, begin, begin + count)) continue;
    const auto known = std::ptrdiff_t(reaching.size());
    reaching.insert(reaching.end(), begin, begin + count);
    std::inplace_merge(reaching.begin(), reaching.begin() + known, reaching.end());
    const auto last = std::unique(reaching.begin(), reaching.end());
    is_joined = is_joined && last != reaching.end();  // some are in both
    reaching.erase(last, reaching.end());
  }
  const bool is_whole = std::all_of(reaching.begin(), reaching.end(), [&](std::int32_t piece) {
    return m_pieces[std::size_t(piece)].is_whole;
  });
  if (!is_whole || reaching.size() > std::size_t(kMostPieces)) return false;
  return is_joined || is_single(reaching.data(), reaching.data() + reaching.size());
}

std::size_t CutBrick::part_of(const Vec3d& x) const {
  int part = 0;
  for (int a = 0; a < 3; ++a) {
    const int at = int((x[a] - m_origin[a]) * kParts);
    part = part * kPartDim + std::clamp(at, 0, kPartDim - 1);
  }
  return std::size_t(part);
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
  const std::size_t part = part_of(x);
  for (std::int32_t n = m_begin[part]; n < m_begin[part + 1]; ++n) {
    const int number = m_reaching[std::size_t(n)];
    Vec3d X;
    if (source_of(number, x, X) && is_in_slice(X, dims)) visit(number, X);
  }
}

/// Finds the piece at x in a part whose places have one at most; nullopt near faces of cells.
std::optional<int> CutBrick::find_single(std::size_t part, const Vec3d& x, const Vec3i& dims,
                                         Vec3d& offset, int guess) const {
  // Candidate 0 is the guess.
  const std::int32_t begin = m_begin[part] - (guess >= 0 ? 1 : 0);
  for (std::int32_t n = begin; n < m_begin[part + 1]; ++n) {
    const int number = n < m_begin[part] ? guess : m_reaching[std::size_t(n)];
    Vec3d local;
    const PieceMap::Outcome outcome = m_maps[std::size_t(number)].solve(x, local);
    if (outcome == PieceMap::Outcome::outside) continue;
    if (outcome != PieceMap::Outcome::inside) return std::nullopt;
    const CutPiece& piece = m_pieces[std::size_t(number)];
    if (piece.is_translated) local = x - Vec3d(piece.u[0]) - Vec3d(piece.cell);
    const Vec3d X = Vec3d(piece.cell) + local;
    if (!piece.is_own(local) || !is_in_slice(X, dims)) return -1;
    offset = offset_of(piece, X, x);
    return number;
  }
  return -1;
}

int CutBrick::find(const Vec3d& x, const Vec3i& dims, Vec3d& offset, int guess) const {
  const std::size_t part = part_of(x);
  if (m_single[part]) {
    const std::optional<int> found = find_single(part, x, dims, offset, guess);
    if (found) return *found;
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

bool CutBrick::find_place(const Vec3d& x, const Vec3i& dims, Vec3d& place,
                          bool& is_ambiguous) const {
  struct Found {
    Vec3d place;
    Content content;
    bool is_within;  // its cell
  };
  std::vector<Found> found;
  for_found(x, dims, [&](int number, Vec3d X) {
    const CutPiece& piece = m_pieces[std::size_t(number)];
    const bool is_within = piece.refine(x, X);
    found.push_back({X, piece.content_at(X), is_within});
  });
  const bool is_any_within =
      std::any_of(found.begin(), found.end(), [](const Found& one) { return one.is_within; });
  const Found* best = nullptr;
  is_ambiguous = false;
  for (const Found& one : found) {
    if (is_any_within && !one.is_within) continue;
    if (best != nullptr && best->content != Content::air && one.content != Content::air) {
      is_ambiguous = is_ambiguous || (one.place - best->place).length() > kSameExactly;
    }
    const bool is_better = best == nullptr || one.content > best->content ||
                           (one.content == best->content &&
                            (one.place - x).length() < (best->place - x).length() - kSameLength);
    if (is_better) best = &one;
  }
  if (best != nullptr) place = best->place;
  return best != nullptr;
}

bool CutBrick::is_overlapped(const Vec3d& x, const Vec3i& dims) const {
  if (m_single[part_of(x)]) return false;
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
