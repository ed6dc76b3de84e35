#include "volumes/field/cuts/cut_faces.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "volumes/grid/cell.h"

namespace supple {

namespace {

constexpr int kBlock = 4;
// How deep behind a face places know it, and how far beside a point its plane counts, in voxels.
constexpr double kDeepest = 4;
constexpr double kBeside = 1.5, kBesideWidth = 0.8;
// What a corner of a torn cell is away from the face at least, where the face is in the middle of
// links and where it is a surface, and at most, in voxels.
constexpr double kLeast = 0.1, kLeastExact = 1e-3, kMost = 1.5, kMostExact = 2;
// So near to a surface, in voxels, links that it does not cross are cut where shells of air meet,
// and their middles tell nothing about its place.
constexpr double kBesideSurface = 2.5;
// A face ends this far beyond the torn cells, in voxels.
constexpr double kBesideTorn = 0.25;
// Deeper than the nearest by more than this, a point is one of another face.
constexpr double kSameFace = 0.75;

Vec3i block_of(const Vec3d& X) {
  return floor_voxel(X / double(kBlock));
}

struct LinkLess {
  bool operator()(const CutBody::Link& a, const CutBody::Link& b) const {
    return std::tie(a.low.x, a.low.y, a.low.z, a.axis) <
           std::tie(b.low.x, b.low.y, b.low.z, b.axis);
  }
};

/// How far apart the middles of the cut links of a cell are.
void add_openings(const TornCell& cell, std::map<CutBody::Link, Vec3d, LinkLess>& openings) {
  for (int axis = 0; axis < 3; ++axis) {
    const int bit = 4 >> axis;
    for (std::size_t low = 0; low < 8; ++low) {
      const std::size_t high = low | std::size_t(bit);
      if (high == low || cell.sides.of[low] == cell.sides.of[high]) continue;
      const auto& a = cell.u[cell.sides.of[low]];
      const auto& b = cell.u[cell.sides.of[high]];
      const Vec3d apart = (Vec3d(b[low]) + Vec3d(b[high]) - Vec3d(a[low]) - Vec3d(a[high])) * 0.5;
      const Vec3i at = cell.cell + Vec3i(int(low) >> 2, int(low) >> 1 & 1, int(low) & 1);
      openings.emplace(CutBody::Link{at, axis}, apart);
    }
  }
}

}  // namespace

CutFaces::CutFaces(const std::vector<TornCell>& cells, const CutBody& body,
                   const Geometry& geometry, double closed) {
  for (int a = 0; a < 3; ++a) m_axis_mm[a] = geometry.axes_mm()[std::size_t(a)].length();
  std::map<CutBody::Link, Vec3d, LinkLess> openings;
  for (const TornCell& cell : cells) add_openings(cell, openings);
  std::vector<std::pair<int, Vec3d>> links;  // axis, opening
  const auto add = [&](const CutBody::Link& link, const Vec3d& apart, LinkCuts::Place place) {
    Point point;
    point.at = Vec3d(link.low);
    point.at[link.axis] += LinkCuts::fraction_of(place);
    point.is_crossing = place != 0;
    if (!point.is_crossing && is_beside_surface(point.at)) return;
    m_blocks[block_of(point.at)].push_back(int(m_points.size()));
    m_points.push_back(point);
    links.emplace_back(link.axis, apart);
  };
  for (const bool has_place : {true, false}) {
    for (const auto& [link, apart] : openings) {
      const LinkCuts::Place place = body.place(link);
      if ((place != 0) == has_place) add(link, apart, place);
    }
  }
  for (std::size_t n = 0; n < m_points.size(); ++n) {
    fit_plane(m_points[n], links[n].first, geometry);
    m_points[n].is_open = links[n].second.length() > closed;
    if (m_points[n].is_open) list_seen(int(n));
  }
  m_torn.resize(m_seen_at.size());
  for (const TornCell& cell : cells) {
    const std::int32_t brick = m_seen_bricks.find(cell.cell);
    if (brick >= 0) mask_set(m_torn[std::size_t(brick)], brick_offset(cell.cell));
  }
}

bool CutFaces::is_torn(const Vec3i& cell) const {
  const std::int32_t brick = m_seen_bricks.find(cell);
  return brick >= 0 && mask_test(m_torn[std::size_t(brick)], brick_offset(cell));
}

bool CutFaces::is_beside_torn(const Vec3d& X) const {
  for (int n = 0; n < 8; ++n) {
    const Vec3d step = Vec3d(cell_corner(n)) * 2.0 - Vec3d(1);
    if (is_torn(floor_voxel(X + step * kBesideTorn))) return true;
  }
  return false;
}

std::uint8_t CutFaces::torn_beside(const Vec3i& cell) const {
  std::uint8_t beside = 0;
  for (int face = 0; face < 6; ++face) {
    Vec3i next = cell;
    next[face / 2] += face % 2 ? 1 : -1;
    if (is_torn(next)) beside |= std::uint8_t(1 << face);
  }
  return beside;
}

CutFaces::Depth CutFaces::depth_of_end(const Vec3d& X, const Vec3i& cell,
                                       std::uint8_t beside) const {
  double nearest = HUGE_VAL, weights = 0;
  Vec3d gradient(0);
  for (int face = 0; face < 6; ++face) {
    if (!(beside >> face & 1)) continue;
    const int axis = face / 2;
    const double local = X[axis] - cell[axis], voxels = face % 2 ? 1 - local : local;
    const double weight = std::max(1 - voxels, 1e-3);
    nearest = std::min(nearest, voxels * m_axis_mm[axis]);
    gradient[axis] += weight * (face % 2 ? -1 : 1) * m_axis_mm[axis];
    weights += weight;
  }
  if (gradient == Vec3d(0)) return {HUGE_VAL, Vec3d(0)};
  return {nearest, gradient / weights};
}

/// In the cells that the cylinder of places that know the point touches, by their middles.
void CutFaces::list_seen(int number) {
  const Point& point = m_points[std::size_t(number)];
  const double slack = std::sqrt(0.75), deepest = kDeepest + slack, beside = kBeside + slack;
  const Vec3i lo = floor_voxel(point.at - Vec3d(kDeepest + kBeside));
  const Vec3i hi = floor_voxel(point.at + Vec3d(kDeepest + kBeside));
  for (int x = lo.x; x <= hi.x; ++x) {
    for (int y = lo.y; y <= hi.y; ++y) {
      for (int z = lo.z; z <= hi.z; ++z) {
        const Vec3d step = Vec3d(x, y, z) + Vec3d(0.5) - point.at;
        const double across = step.dot(point.across);
        if (std::abs(across) > deepest || step.length2() - across * across > beside * beside) {
          continue;
        }
        const std::size_t brick = m_seen_bricks.add({x & ~7, y & ~7, z & ~7});
        if (brick == m_seen_at.size()) m_seen_at.emplace_back().fill(-1);
        std::int32_t& seen = m_seen_at[brick][std::size_t(brick_offset({x, y, z}))];
        if (seen < 0) {
          seen = std::int32_t(m_seen.size());
          m_seen.emplace_back();
        }
        m_seen[std::size_t(seen)].push_back(number);
      }
    }
  }
}

template <class Visit>
void CutFaces::for_near(const Vec3d& X, Visit&& visit) const {
  const Vec3i middle = block_of(X);
  for (int n = 0; n < 27; ++n) {
    const auto found = m_blocks.find(middle + Vec3i(n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1));
    if (found == m_blocks.end()) continue;
    for (const int point : found->second) visit(m_points[std::size_t(point)]);
  }
}

/// Whether a surface that is known crosses links beside a place.
bool CutFaces::is_beside_surface(const Vec3d& X) const {
  bool found = false;
  for_near(X, [&](const Point& point) {
    found = found || (point.is_crossing && (X - point.at).length() < kBesideSurface);
  });
  return found;
}

/// Least squares in mm; the normal points along the link.
void CutFaces::fit_plane(Point& point, int axis, const Geometry& geometry) const {
  std::vector<Vec3d> near;
  for_near(point.at, [&](const Point& other) {
    const Vec3d step = other.at - point.at;
    if (step.length() > kPlaneFitRadius) return;
    near.push_back(geometry.world_vector_from_index(step));
  });
  Vec3d along(0);
  along[axis] = 1;
  Vec3d normal = plane_normal(near, geometry.world_gradient_from_index(along));
  if (normal.dot(geometry.axes_mm()[std::size_t(axis)]) < 0) normal = -normal;
  for (int a = 0; a < 3; ++a) {
    point.normal_mm[a] = normal.dot(geometry.axes_mm()[std::size_t(a)]);
  }
  point.across = point.normal_mm.normalized();
}

const CutFaces::Points* CutFaces::seen_from(const Vec3i& cell) const {
  const std::int32_t brick = m_seen_bricks.find(cell);
  if (brick < 0) return nullptr;
  const std::int32_t seen = m_seen_at[std::size_t(brick)][std::size_t(brick_offset(cell))];
  return seen < 0 ? nullptr : &m_seen[std::size_t(seen)];
}

CutFaces::Depth CutFaces::depth(const Vec3d& X, const Vec3d& inside, const Points* seen) const {
  const Depth found = depth_beyond(X, inside, seen);
  if (found.gradient == Vec3d(0)) return found;
  const Vec3d foot = X - found.gradient * (found.mm / found.gradient.length2());
  return is_beside_torn(foot) ? found : Depth{HUGE_VAL, Vec3d(0)};
}

CutFaces::Depth CutFaces::depth_beyond(const Vec3d& X, const Vec3d& inside,
                                       const Points* points) const {
  struct Seen {
    const Point* point;
    double depth;  // voxels
    double beside2;
    double sign;
  };
  Seen seen[64];
  int count = 0;
  double nearest = HUGE_VAL;
  if (points == nullptr) return {HUGE_VAL, Vec3d(0)};
  for (const int number : *points) {
    const Point& point = m_points[std::size_t(number)];
    const Vec3d step = X - point.at;
    const double across = step.dot(point.across), beside2 = step.length2() - across * across;
    if (std::abs(across) > kDeepest || beside2 > kBeside * kBeside || count == 64) continue;
    const double sign = (inside - point.at).dot(point.across) < 0 ? -1 : 1;
    seen[count++] = {&point, sign * across, beside2, sign};
    nearest = std::min(nearest, sign * across);
  }
  double sum = 0, weights = 0;
  Vec3d gradient(0);
  for (int n = 0; n < count; ++n) {
    if (seen[n].depth > nearest + kSameFace) continue;
    const double weight = std::exp(float(-seen[n].beside2 / (kBesideWidth * kBesideWidth)));
    const Vec3d normal = seen[n].point->normal_mm * seen[n].sign;
    sum += weight * (X - seen[n].point->at).dot(normal);
    gradient += normal * weight;
    weights += weight;
  }
  if (weights == 0) return {HUGE_VAL, Vec3d(0)};
  return {sum / weights, gradient / weights};
}

/// From the planes of the points beside X, turned along `orientation`.
CutFaces::Distance CutFaces::signed_distance(const Vec3d& X, const Vec3d& orientation) const {
  double sum = 0, weights = 0;
  bool is_exact = true;
  for_near(X, [&](const Point& point) {
    const Vec3d step = X - point.at;
    const double across = step.dot(point.across), beside2 = step.length2() - across * across;
    if (std::abs(across) > (point.is_crossing ? kMostExact : kMost) || beside2 > kBeside * kBeside)
      return;
    const double weight = std::exp(-beside2 / (kBesideWidth * kBesideWidth));
    sum += weight * (point.across.dot(orientation) < 0 ? -across : across);
    weights += weight;
    is_exact = is_exact && point.is_crossing;
  });
  if (weights == 0) return {};
  return {sum / weights, true, is_exact};
}

std::array<float, 8> CutFaces::depths_of_corners(const TornCell& cell, int side) const {
  std::array<float, 8> depths;
  Vec3d into(0);
  int own = 0;
  for (int n = 0; n < 8; ++n) {
    const bool is_own = cell.sides.of[std::size_t(n)] == side;
    depths[std::size_t(n)] = is_own ? 0.5f : -0.5f;
    own += is_own;
  }
  for (int n = 0; n < 8; ++n) {
    const bool is_own = cell.sides.of[std::size_t(n)] == side;
    into += Vec3d(n >> 2, n >> 1 & 1, n & 1) * (is_own ? 1.0 / own : -1.0 / (8 - own));
  }
  if (cell.sides.count != 2) return depths;  // no plane has three sides
  for (int n = 0; n < 8; ++n) {
    const Vec3d X = Vec3d(cell.cell) + Vec3d(n >> 2, n >> 1 & 1, n & 1);
    const Distance distance = signed_distance(X, into);
    if (!distance.is_known) continue;
    const double sign = cell.sides.of[std::size_t(n)] == side ? 1 : -1;
    const double least = distance.is_exact ? kLeastExact : kLeast;
    const double most = distance.is_exact ? kMostExact : kMost;
    depths[std::size_t(n)] = float(sign * std::clamp(sign * distance.voxels, least, most));
  }
  return depths;
}

}  // namespace supple
