#include "volumes/field/paths/path_offsets.h"

#include <algorithm>
#include <tuple>

#include "volumes/base/error.h"
#include "volumes/base/parallel.h"
#include "volumes/field/inversion/invert.h"

namespace supple {

namespace {

constexpr int kMaxPieces = 4096;
constexpr double kFarthest = 1e6;  // voxels
// Beyond the box of a brick's moved points, in voxels: what they leave out of a curved brick, and
// the node that a cell needs.
constexpr double kSlack = 2;
constexpr int kWideRings = 2;
// Samples this near to a face may be shaded as the face (split_offsets.h), in voxels.
constexpr double kFaceDepth = 3;
constexpr int kNodes = kBrickDim + 1;  // of the cells of a brick, per axis

/// Corners, middles of edges and faces, and centre of the cells that touch a brick.
std::vector<Vec3d> points_of(const Vec3i& origin) {
  std::vector<Vec3d> points;
  for (int n = 0; n < 27; ++n) {
    const Vec3d step(n / 9, n / 3 % 3, n % 3);
    points.push_back(Vec3d(origin) - Vec3d(1) + step * (0.5 * (kBrickDim + 1)));
  }
  return points;
}

struct Sphere {
  Vec3d centre;
  double radius = 0;
};

Sphere sphere_around(const std::vector<Vec3d>& points) {
  Sphere sphere;
  sphere.centre = points[points.size() / 2];
  for (const Vec3d& p : points) {
    sphere.radius = std::max(sphere.radius, (p - sphere.centre).length());
  }
  return sphere;
}

}  // namespace

/// A piece that may be seen in a brick of the output lattice.
struct PathOffsets::Candidate {
  Vec3i brick;
  int piece;
  bool is_split;  // for reasons of the body before it was sent along the path

  bool operator<(const Candidate& other) const {
    if (brick != other.brick) return voxel_less(brick, other.brick);
    return std::tie(piece, is_split) < std::tie(other.piece, other.is_split);
  }
  bool operator==(const Candidate& other) const {
    return brick == other.brick && piece == other.piece && is_split == other.is_split;
  }
};

PathOffsets::PathOffsets(SamplingPath path, const Geometry& geometry, BrickTopology body)
    : m_path(std::move(path)), m_geometry(geometry), m_body(std::move(body)) {
  m_wide = dilate(m_body, kWideRings);
  count_pieces();
}

PathOffsets::PathOffsets(SamplingPath path, const OffsetField& moved)
    : m_path(std::move(path)), m_geometry(moved.geometry), m_body(moved.o.topology) {
  m_moved = moved;
  m_moved->o = extrapolate_into_bricks(moved.o, 1);
  for (std::size_t b = 0; b < m_moved->o.topology.brick_count(); ++b) {
    for_each_active(m_moved->o.topology.mask(b), [&](int local) {
      const Vec3f& offset = m_moved->o.vectors.brick_or_zero(b)[local];
      for (int a = 0; a < 3; ++a) {
        m_moved_lo[a] = std::min(m_moved_lo[a], double(offset[a]));
        m_moved_hi[a] = std::max(m_moved_hi[a], double(offset[a]));
      }
    });
  }
  count_pieces();
}

void PathOffsets::count_pieces() {
  for (const auto& function : m_path) {
    if (function->pieces() > kMaxPieces / m_pieces) {
      throw InputError(
          {"", "offset", "more than " + std::to_string(kMaxPieces) + " pieces", "fewer of them"});
    }
    m_pieces *= function->pieces();
  }
}

PathOffsets::Origin PathOffsets::origin_of(int piece, const Vec3d& x) const {
  const Vec3d at = m_geometry.world_from_index(x);
  Origin origin{Vec3d(0), HUGE_VAL};
  Vec3d from = at;
  int stride = m_pieces;
  for (std::size_t n = m_path.size(); n-- > 0;) {
    const PathFunction& function = *m_path[n];
    stride /= function.pieces();
    const int part = piece / stride % function.pieces();
    from = function.backward(from, part);
    origin.depth_mm = std::min(origin.depth_mm, function.depth_mm(from, part));
  }
  origin.step = m_geometry.index_vector_from_world(from - at);
  return origin;
}

double PathOffsets::largest_spacing() const {
  const Vec3d spacing = m_geometry.spacing_mm();
  return std::max({spacing.x, spacing.y, spacing.z});
}

/// The offset of the body before the path; false where the body is not.
bool PathOffsets::offset_before(const Vec3d& pos, Vec3d& offset) const {
  offset = Vec3d(0);
  return m_moved ? m_moved->sample(pos, offset) : touches(m_body, pos);
}

/// Nodes are there where the body is and, for the cells at its border, around it.
bool PathOffsets::node_offset(const Vec3i& node, const Origin& origin, Border border,
                              Vec3f& offset) const {
  const Vec3d pos = Vec3d(node) + origin.step;
  Vec3d before(0);
  if (border == Border::exact) {
    if (!m_body.is_active(node)) return false;
    Vec3f exact(0);
    if (m_moved) m_moved->o.at(node, exact);
    offset = exact;
    return true;
  }
  if (m_moved ? !m_moved->sample(pos, before) : !touches(m_wide, pos)) return false;
  offset = Vec3f(origin.step + before);
  return true;
}

/// Sends the points through the remaining functions, in every piece that they may belong to.
void PathOffsets::reach_bricks(const std::vector<Vec3d>& points_mm, std::size_t function, int piece,
                               int stride, bool is_split, std::vector<Candidate>& found) const {
  if (function < m_path.size()) {
    const PathFunction& f = *m_path[function];
    const Sphere sphere = sphere_around(points_mm);
    const double slack_mm = kSlack * largest_spacing();
    std::vector<Vec3d> moved(points_mm.size());
    for (int part = 0; part < f.pieces(); ++part) {
      if (f.depth_mm(sphere.centre, part) < -sphere.radius - slack_mm) continue;
      std::transform(points_mm.begin(), points_mm.end(), moved.begin(),
                     [&](const Vec3d& p) { return f.forward(p, part); });
      reach_bricks(moved, function + 1, piece + part * stride, stride * f.pieces(), is_split,
                   found);
    }
    return;
  }
  Vec3d lo(HUGE_VAL), hi(-HUGE_VAL);
  for (const Vec3d& p : points_mm) {
    const Vec3d index = m_geometry.index_from_world(p);
    for (int a = 0; a < 3; ++a) {
      lo[a] = std::min(lo[a], index[a]);
      hi[a] = std::max(hi[a], index[a]);
    }
  }
  Vec3i first, last;
  for (int a = 0; a < 3; ++a) {
    if (!(lo[a] > -kFarthest && hi[a] < kFarthest)) {
      throw InputError(
          {"", "offset", "a path that leads further than 10^6 voxels", "a shorter one"});
    }
    first[a] = int(std::floor(lo[a] - kSlack)) >> 3;
    last[a] = int(std::floor(hi[a] + kSlack)) >> 3;
  }
  for (int x = first.x; x <= last.x; ++x) {
    for (int y = first.y; y <= last.y; ++y) {
      for (int z = first.z; z <= last.z; ++z) {
        found.push_back({Vec3i(x, y, z) * kBrickDim, piece, is_split});
      }
    }
  }
}

std::vector<PathOffsets::Candidate> PathOffsets::find_candidates(Progress* progress) const {
  constexpr std::size_t kTidyEvery = 1 << 20;
  std::vector<Candidate> found;
  std::size_t tidy_at = kTidyEvery;
  const auto tidy = [&found] {
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
  };
  for (std::size_t b = 0; b < m_body.brick_count(); ++b) {
    if ((b & 1023) == 0) report(progress, 0.5 * double(b) / double(m_body.brick_count()));
    const Vec3i& origin = m_body.origin(b);
    std::vector<Vec3d> points = points_of(origin);
    for (Vec3d& p : points) p = m_geometry.world_from_index(p);
    const bool is_split = m_moved && m_moved->split && m_moved->split->bricks().find(origin) >= 0;
    reach_bricks(points, 0, 0, 1, is_split, found);
    if (found.size() < tidy_at) continue;
    tidy();
    tidy_at = found.size() + kTidyEvery;
  }
  tidy();
  return found;
}

/// The nodes of one brick. A brick where nothing moves gets those of the body and no others.
void PathOffsets::sample_nodes(const Vec3i& brick, const std::vector<int>& pieces, Border border,
                               BrickMask& valid, Vec3f* out) const {
  for (int n = 0; n < kBrickVoxels; ++n) {
    const Vec3i node = brick + brick_local(n);
    float shortest = HUGE_VALF;
    for (const int piece : pieces) {
      const Origin origin = origin_of(piece, Vec3d(node));
      Vec3f offset;
      if (!(origin.depth_mm >= 0) || !node_offset(node, origin, border, offset)) continue;
      if (offset.length2() >= shortest) continue;
      shortest = offset.length2();
      out[n] = offset;
      mask_set(valid, n);
    }
  }
}

/// Surveys the nodes of a brick's cells: their origins, whether they move, whether they are split.
PathOffsets::Survey PathOffsets::survey(const Vec3i& brick, const std::vector<int>& pieces) const {
  Survey survey;
  int owner = -1;
  const double face_mm = kFaceDepth * largest_spacing();
  const bool may_be_split = m_pieces > 1 || (m_moved && m_moved->split != nullptr);
  for (int n = 0; n < kNodes * kNodes * kNodes && (may_be_split || !survey.moves); ++n) {
    const Vec3d node(brick + Vec3i(n / (kNodes * kNodes), n / kNodes % kNodes, n % kNodes));
    int owners = 0;
    for (const int piece : pieces) {
      const Origin origin = origin_of(piece, node);
      for (int a = 0; a < 3; ++a) {
        survey.lo[a] = std::min(survey.lo[a], node[a] + origin.step[a]);
        survey.hi[a] = std::max(survey.hi[a], node[a] + origin.step[a]);
      }
      if (!(origin.depth_mm >= 0)) continue;
      survey.moves = survey.moves || origin.step != Vec3d(0);
      survey.is_split =
          survey.is_split || (owner >= 0 && owner != piece) || origin.depth_mm < face_mm;
      owner = piece;
      ++owners;
    }
    survey.is_split = survey.is_split || owners != 1;
  }
  survey.is_split = survey.is_split && m_pieces > 1;
  return survey;
}

VectorBricks PathOffsets::run(Progress* progress) {
  const std::vector<Candidate> candidates = find_candidates(progress);
  std::vector<Vec3i> bricks;
  std::vector<std::vector<int>> pieces;
  std::vector<std::uint8_t> is_split;
  for (const Candidate& candidate : candidates) {
    if (bricks.empty() || bricks.back() != candidate.brick) {
      bricks.push_back(candidate.brick);
      pieces.emplace_back();
      is_split.push_back(0);
    }
    if (pieces.back().empty() || pieces.back().back() != candidate.piece) {
      pieces.back().push_back(candidate.piece);
    }
    is_split.back() |= std::uint8_t(candidate.is_split);
  }

  std::vector<BrickMask> masks(bricks.size(), BrickMask{});
  BrickVectors vectors(bricks.size());
  vectors.touch_all();
  std::vector<Survey> surveys(bricks.size());
  constexpr std::size_t kChunk = 1024;
  for (std::size_t start = 0; start < bricks.size(); start += kChunk) {
    report(progress, 0.5 + 0.5 * double(start) / double(bricks.size()));
    parallel_for(start, std::min(bricks.size(), start + kChunk), [&](std::size_t b) {
      surveys[b] = survey(bricks[b], pieces[b]);
      sample_nodes(bricks[b], pieces[b], surveys[b].moves ? Border::wide : Border::exact, masks[b],
                   vectors.touch(b));
    });
  }

  std::vector<Vec3i> split_bricks;
  for (std::size_t b = 0; b < bricks.size(); ++b) {
    if (is_split[b] == 0 && !surveys[b].is_split) continue;
    split_bricks.push_back(bricks[b]);
    m_cuts.push_back({std::move(pieces[b]), surveys[b].lo, surveys[b].hi});
  }
  set_bricks(std::move(split_bricks));

  // The topology drops bricks without the body.
  std::vector<std::size_t> kept;
  for (std::size_t b = 0; b < bricks.size(); ++b) {
    if (mask_count(masks[b]) > 0) kept.push_back(b);
  }
  vectors.keep_only(kept);
  return {BrickTopology(std::move(bricks), std::move(masks)), std::move(vectors)};
}

bool PathOffsets::sample(std::size_t b, const Vec3d& x, Sample& found) const {
  double shortest = HUGE_VAL;
  for (const int piece : m_cuts[b].pieces) {
    const Origin origin = origin_of(piece, x);
    Vec3d before;
    if (!(origin.depth_mm >= 0) || !offset_before(x + origin.step, before)) continue;
    const Vec3d offset = origin.step + before;
    if (offset.length2() >= shortest) continue;
    shortest = offset.length2();
    found = {offset, piece};
  }
  return shortest < HUGE_VAL;
}

bool PathOffsets::offset_of(int piece, const Vec3d& x, Vec3d& offset) const {
  const Origin origin = origin_of(piece, x);
  offset = origin.step;
  if (!m_moved) return true;
  Vec3d before;
  if (!m_moved->sample(x + origin.step, before)) return false;
  offset += before;
  return true;
}

double PathOffsets::depth_mm(int piece, const Vec3d& x) const {
  return origin_of(piece, x).depth_mm;
}

void PathOffsets::source_box(std::size_t b, Vec3d& lo, Vec3d& hi) const {
  lo = m_cuts[b].lo + m_moved_lo;
  hi = m_cuts[b].hi + m_moved_hi;
}

}  // namespace supple
