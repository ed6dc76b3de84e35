#include "volumes/field/cuts/cut_faces.h"

#include <algorithm>
#include <cmath>

#include "volumes/base/parallel.h"
#include "volumes/grid/cell.h"
#include "volumes/grid/voxel_sets.h"

namespace supple {

BrickList TornCells::follow(const VectorBricks& u, const CutBody& body, const BrickList& moved,
                            const BrickList& parted, double closed) {
  const BrickList planned = with_neighbours(body.cells(), parted);
  const BrickList seeing = unite(planned, with_neighbours(body.cells(), moved));
  const BrickList bricks = bricks_where(
      seeing, [&](std::size_t b) { return !m_cells[b].empty() || !body.parted_in(b).empty(); });
  std::vector<std::vector<TornCell>> found(bricks.size());
  parallel_for(bricks.size(), [&](std::size_t n) {
    const auto b = std::size_t(bricks[n]);
    const bool is_other = std::binary_search(planned.begin(), planned.end(), bricks[n]);
    if (is_other) m_nodes[b].reset();
    if (body.parted_in(b).empty()) return;
    if (!m_nodes[b]) m_nodes[b] = std::make_unique<VirtualNodes>(u.topology, body, b);
    found[n] = m_nodes[b]->torn(u.vectors, closed);
  });
  BrickList others;
  for (std::size_t n = 0; n < bricks.size(); ++n) {
    std::vector<TornCell>& cells = m_cells[std::size_t(bricks[n])];
    if (cells == found[n]) continue;
    m_count += std::int64_t(found[n].size()) - std::int64_t(cells.size());
    cells = std::move(found[n]);
    others.push_back(bricks[n]);
  }
  return others;
}

bool TornCells::holds(const Vec3i& cell) const {
  const std::int32_t b = m_bricks.find(cell);
  if (b < 0) return false;
  const std::vector<TornCell>& cells = m_cells[std::size_t(b)];
  const auto found = std::lower_bound(
      cells.begin(), cells.end(), cell,
      [](const TornCell& torn, const Vec3i& at) { return voxel_less(torn.cell, at); });
  return found != cells.end() && found->cell == cell;
}

namespace {

constexpr double kBesideWidth = 0.8;
// Least and greatest distance of a torn cell's corner from the face, in voxels: of a face in the
// middle of links, and (Exact) of one at a surface.
constexpr double kLeast = 0.1, kLeastExact = 1e-3, kMost = 1.5, kMostExact = 2;
// A face ends this far beyond the torn cells, in voxels.
constexpr double kBesideTorn = 0.25;
// A point deeper than the nearest by more than this, in voxels, is one of another face.
constexpr double kSameFace = 0.75;

}  // namespace

CutFaces::CutFaces(const BrickTopology& cells, const Geometry& geometry, double closed)
    : m_bricks(cells),
      m_geometry(geometry),
      m_closed(closed),
      m_openings(cells.brick_count()),
      m_points(cells.brick_count()),
      m_seen(cells.brick_count()),
      m_torn(cells.brick_count()) {
  for (int a = 0; a < 3; ++a) m_axis_mm[a] = geometry.axes_mm()[std::size_t(a)].length();
}

/// True if a cell is torn; cells in bricks without a place that knows a face do not count.
bool CutFaces::is_torn(const Vec3i& cell) const {
  const std::int32_t b = m_bricks.find(cell);
  return b >= 0 && m_seen[std::size_t(b)] && mask_test(m_torn[std::size_t(b)], brick_offset(cell));
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

const CutFaces::Points* CutFaces::seen_from(const Vec3i& cell) const {
  const std::int32_t b = m_bricks.find(cell);
  if (b < 0 || !m_seen[std::size_t(b)]) return nullptr;
  const Seen& seen = *m_seen[std::size_t(b)];
  const std::int32_t list = seen.at[std::size_t(brick_offset(cell))];
  return list < 0 ? nullptr : &seen.lists[std::size_t(list)];
}

CutFaces::Depth CutFaces::depth(const Vec3d& X, const Vec3d& inside, const Points* seen) const {
  const Depth found = depth_beyond(X, inside, seen);
  if (found.gradient == Vec3d(0)) return found;
  const Vec3d foot = X - found.gradient * (found.mm / found.gradient.length2());
  return is_beside_torn(foot) ? found : Depth{HUGE_VAL, Vec3d(0)};
}

CutFaces::Depth CutFaces::depth_beyond(const Vec3d& X, const Vec3d& inside,
                                       const Points* points) const {
  struct SeenPoint {
    const Point* point;
    double depth;  // voxels
    double beside2;
    double sign;
  };
  SeenPoint seen[64];
  int count = 0;
  double nearest = HUGE_VAL;
  if (points == nullptr) return {HUGE_VAL, Vec3d(0)};
  for (const Point* known : *points) {
    const Point& point = *known;
    const Vec3d step = X - point.at;
    const double across = step.dot(point.across), beside2 = step.length2() - across * across;
    if (std::abs(across) > kDeepestFace || beside2 > kBesideFace * kBesideFace || count == 64)
      continue;
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

/// Distance of X from the planes of the points beside it, turned along `orientation`.
CutFaces::Distance CutFaces::signed_distance(const Vec3d& X, const Vec3d& orientation) const {
  double sum = 0, weights = 0;
  bool is_exact = true;
  for_near(X, [&](const Point& point) {
    const Vec3d step = X - point.at;
    const double across = step.dot(point.across), beside2 = step.length2() - across * across;
    if (std::abs(across) > (point.is_crossing ? kMostExact : kMost) ||
        beside2 > kBesideFace * kBesideFace)
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
    into += Vec3d(cell_corner(n)) * (is_own ? 1.0 / own : -1.0 / (8 - own));
  }
  if (cell.sides.count != 2) return depths;  // no plane has three sides
  for (int n = 0; n < 8; ++n) {
    const Vec3d X = Vec3d(cell.cell) + Vec3d(cell_corner(n));
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
