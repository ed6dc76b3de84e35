// How the faces of a cut follow its torn cells: openings of links, their points and planes, and
// what places know of them.
#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "volumes/base/parallel.h"
#include "volumes/field/cuts/cut_faces.h"
#include "volumes/grid/cell.h"

namespace supple {

namespace {

// Within this distance of a surface, in voxels, links that it does not cross are cut where shells
// of air meet, and their middles tell nothing about its place.
constexpr double kBesideSurface = 2.5;

struct LinkLess {
  bool operator()(const CutBody::Link& a, const CutBody::Link& b) const {
    return std::tie(a.low.x, a.low.y, a.low.z, a.axis) <
           std::tie(b.low.x, b.low.y, b.low.z, b.axis);
  }
};

Vec3i brick_origin(const Vec3i& voxel) {
  return {voxel.x & ~7, voxel.y & ~7, voxel.z & ~7};
}

using Openings = std::map<CutBody::Link, Vec3d, LinkLess>;

/// Adds how far apart the middles of a cell's cut links are, for the links that are in a brick.
void add_openings(const TornCell& cell, const Vec3i& origin, Openings& openings) {
  for (int axis = 0; axis < 3; ++axis) {
    const int bit = 4 >> axis;
    for (std::size_t low = 0; low < 8; ++low) {
      const std::size_t high = low | std::size_t(bit);
      if (high == low || cell.sides.of[low] == cell.sides.of[high]) continue;
      const Vec3i at = cell.cell + cell_corner(int(low));
      if (brick_origin(at) != origin) continue;
      const auto& a = cell.u[cell.sides.of[low]];
      const auto& b = cell.u[cell.sides.of[high]];
      const Vec3d apart = (Vec3d(b[low]) + Vec3d(b[high]) - Vec3d(a[low]) - Vec3d(a[high])) * 0.5;
      openings.emplace(CutBody::Link{at, axis}, apart);
    }
  }
}

}  // namespace

/// Openings at links that begin in a brick; of several cells around a link the first one counts.
std::vector<CutFaces::Opening> CutFaces::openings_in(const TornCells& torn, const CutBody& body,
                                                     std::size_t b) const {
  const Vec3i& origin = m_bricks.origin(b);
  std::vector<const TornCell*> cells;
  for (int n = 0; n < kCellCorners; ++n) {
    const std::int32_t below = m_bricks.find(origin - cell_corner(n) * kBrickDim);
    if (below < 0) continue;
    for (const TornCell& cell : torn.in(std::size_t(below))) {
      const Vec3i last = cell.cell + Vec3i(1) - origin;
      if (std::min({last.x, last.y, last.z}) >= 0) cells.push_back(&cell);
    }
  }
  std::sort(cells.begin(), cells.end(), [](const TornCell* one, const TornCell* other) {
    return voxel_less(one->cell, other->cell);
  });
  Openings found;
  for (const TornCell* cell : cells) add_openings(*cell, origin, found);
  std::vector<Opening> openings;
  for (const auto& [link, apart] : found) openings.push_back({link, body.place(link), apart});
  return openings;
}

/// Finds points, without planes. Beside a surface middles of links are no points.
std::unique_ptr<CutFaces::BrickPoints> CutFaces::points_of(std::size_t b) const {
  const std::vector<Opening>& openings = m_openings[b];
  if (openings.empty()) return nullptr;
  auto points = std::make_unique<BrickPoints>();
  for (const bool has_place : {true, false}) {
    for (std::size_t n = 0; n < openings.size(); ++n) {
      const Opening& opening = openings[n];
      if ((opening.place != 0) != has_place) continue;
      Point point;
      point.at = Vec3d(opening.link.low);
      point.at[opening.link.axis] += LinkCuts::fraction_of(opening.place);
      point.opening = std::int32_t(n);
      point.axis = opening.link.axis;
      point.is_crossing = has_place;
      if (!has_place && is_beside_surface(point.at)) continue;
      const Vec3i block = point_block_of(point.at);
      const int number = (block.x & 1) * 4 + (block.y & 1) * 2 + (block.z & 1);
      points->blocks[std::size_t(number)].push_back(point);
    }
  }
  return points;
}

/// True if a known surface crosses links beside a place.
bool CutFaces::is_beside_surface(const Vec3d& X) const {
  const Vec3i lo = floor_voxel(X - Vec3d(kBesideSurface + 1)),
              hi = floor_voxel(X + Vec3d(kBesideSurface));
  const Vec3i first = brick_origin(lo), last = brick_origin(hi);
  for (int x = first.x; x <= last.x; x += kBrickDim) {
    for (int y = first.y; y <= last.y; y += kBrickDim) {
      for (int z = first.z; z <= last.z; z += kBrickDim) {
        const std::int32_t b = m_bricks.find({x, y, z});
        if (b < 0) continue;
        for (const Opening& opening : m_openings[std::size_t(b)]) {
          if (opening.place == 0) continue;
          Vec3d at(opening.link.low);
          at[opening.link.axis] += LinkCuts::fraction_of(opening.place);
          if ((X - at).length() < kBesideSurface) return true;
        }
      }
    }
  }
  return false;
}

void CutFaces::fit_planes(std::size_t b) {
  if (!m_points[b]) return;
  for (std::vector<Point>& block : m_points[b]->blocks) {
    for (Point& point : block) fit_plane(point);
  }
}

void CutFaces::mark_open(std::size_t b) {
  if (!m_points[b]) return;
  for (std::vector<Point>& block : m_points[b]->blocks) {
    for (Point& point : block) {
      point.is_open = m_openings[b][std::size_t(point.opening)].apart.length() > m_closed;
    }
  }
}

BrickList CutFaces::follow(const TornCells& torn, const CutBody& body, const BrickList& changed) {
  const auto in_parallel = [](const BrickList& bricks, auto&& visit) {
    parallel_for(bricks.size(), [&](std::size_t n) { visit(n, std::size_t(bricks[n])); });
  };
  // Cut links between sides that are apart.
  const BrickList beside = with_upper_neighbours(m_bricks, changed);
  std::vector<std::uint8_t> has_other_links(beside.size()), has_others(beside.size());
  in_parallel(beside, [&](std::size_t n, std::size_t b) {
    std::vector<Opening> found = openings_in(torn, body, b);
    std::vector<Opening>& before = m_openings[b];
    has_other_links[n] = !std::equal(
        found.begin(), found.end(), before.begin(), before.end(),
        [](const Opening& one, const Opening& other) { return one.is_same_link(other); });
    has_others[n] = has_other_links[n] || !std::equal(found.begin(), found.end(), before.begin(),
                                                      [](const Opening& one, const Opening& other) {
                                                        return one.apart == other.apart;
                                                      });
    before = std::move(found);
  });
  BrickList linked, opened, torn_others;
  for (std::size_t n = 0; n < beside.size(); ++n) {
    if (has_other_links[n]) linked.push_back(beside[n]);
    if (has_others[n]) opened.push_back(beside[n]);
  }
  for (const std::int32_t b : changed) {
    BrickMask cells{};
    for (const TornCell& cell : torn.in(std::size_t(b))) mask_set(cells, brick_offset(cell.cell));
    if (cells == m_torn[std::size_t(b)]) continue;
    m_torn[std::size_t(b)] = cells;
    torn_others.push_back(b);
  }
  // Their points and planes.
  const BrickList pointed = with_neighbours(m_bricks, linked);
  const BrickList fitted = with_neighbours(m_bricks, pointed);
  const BrickList marked = unite(fitted, opened);
  std::vector<std::unique_ptr<BrickPoints>> before(marked.size());
  in_parallel(marked, [&](std::size_t n, std::size_t b) {
    if (m_points[b]) before[n] = std::make_unique<BrickPoints>(*m_points[b]);
  });
  std::vector<std::unique_ptr<BrickPoints>> fresh(pointed.size());
  in_parallel(pointed, [&](std::size_t n, std::size_t b) { fresh[n] = points_of(b); });
  for (std::size_t n = 0; n < pointed.size(); ++n) {
    m_points[std::size_t(pointed[n])] = std::move(fresh[n]);
  }
  in_parallel(fitted, [&](std::size_t, std::size_t b) { fit_planes(b); });
  in_parallel(marked, [&](std::size_t, std::size_t b) { mark_open(b); });
  BrickList others = bricks_where(pointed, [&](std::size_t b) { return m_points[b] != nullptr; });
  for (std::size_t n = 0; n < marked.size(); ++n) {
    const std::unique_ptr<BrickPoints>& now = m_points[std::size_t(marked[n])];
    const bool is_same =
        (now == nullptr) == (before[n] == nullptr) && (now == nullptr || *now == *before[n]);
    if (!is_same) others = unite(others, {marked[n]});
  }
  // Places around the changed bricks see their points anew.
  const BrickList seeing = with_neighbours(m_bricks, others);
  in_parallel(seeing, [&](std::size_t, std::size_t b) { m_seen[b] = seen_in(b); });
  return unite(seeing, with_neighbours(m_bricks, torn_others));
}

/// The open points around a brick, crossings first, each in the cells of the brick that the
/// cylinder of places that know it touches, by their middles.
std::unique_ptr<CutFaces::Seen> CutFaces::seen_in(std::size_t b) const {
  struct Numbered {
    const Point* point;
    CutBody::Link link;
  };
  std::vector<Numbered> around;
  for (const std::int32_t n : surroundings_of(m_bricks, b)) {
    if (n < 0 || !m_points[std::size_t(n)]) continue;
    for (const std::vector<Point>& block : m_points[std::size_t(n)]->blocks) {
      for (const Point& point : block) {
        if (!point.is_open) continue;
        around.push_back({&point, m_openings[std::size_t(n)][std::size_t(point.opening)].link});
      }
    }
  }
  std::sort(around.begin(), around.end(), [](const Numbered& one, const Numbered& other) {
    if (one.point->is_crossing != other.point->is_crossing) return one.point->is_crossing;
    return LinkLess()(one.link, other.link);
  });
  auto seen = std::make_unique<Seen>();
  seen->at.fill(-1);
  for (const Numbered& numbered : around) list_seen(*numbered.point, m_bricks.origin(b), *seen);
  return seen->lists.empty() ? nullptr : std::move(seen);
}

void CutFaces::list_seen(const Point& point, const Vec3i& origin, Seen& seen) {
  const double slack = std::sqrt(0.75), deepest = kDeepestFace + slack,
               beside = kBesideFace + slack;
  Vec3i lo = floor_voxel(point.at - Vec3d(kDeepestFace + kBesideFace));
  Vec3i hi = floor_voxel(point.at + Vec3d(kDeepestFace + kBesideFace));
  for (int a = 0; a < 3; ++a) {
    lo[a] = std::max(lo[a], origin[a]);
    hi[a] = std::min(hi[a], origin[a] + kBrickDim - 1);
  }
  for (int x = lo.x; x <= hi.x; ++x) {
    for (int y = lo.y; y <= hi.y; ++y) {
      for (int z = lo.z; z <= hi.z; ++z) {
        const Vec3d step = Vec3d(x, y, z) + Vec3d(0.5) - point.at;
        const double across = step.dot(point.across);
        if (std::abs(across) > deepest || step.length2() - across * across > beside * beside) {
          continue;
        }
        std::int32_t& list = seen.at[std::size_t(brick_offset({x, y, z}))];
        if (list < 0) {
          list = std::int32_t(seen.lists.size());
          seen.lists.emplace_back();
        }
        seen.lists[std::size_t(list)].push_back(&point);
      }
    }
  }
}

/// Fits the plane by least squares in mm; the normal points along the link.
void CutFaces::fit_plane(Point& point) const {
  std::vector<Vec3d> near;
  for_near(point.at, [&](const Point& other) {
    const Vec3d step = other.at - point.at;
    if (step.length() > kPlaneFitRadius) return;
    near.push_back(m_geometry.world_vector_from_index(step));
  });
  Vec3d along(0);
  along[point.axis] = 1;
  Vec3d normal = plane_normal(near, m_geometry.world_gradient_from_index(along));
  if (normal.dot(m_geometry.axes_mm()[std::size_t(point.axis)]) < 0) normal = -normal;
  for (int a = 0; a < 3; ++a) {
    point.normal_mm[a] = normal.dot(m_geometry.axes_mm()[std::size_t(a)]);
  }
  point.across = point.normal_mm.normalized();
}

}  // namespace supple
