#include "lib/contact/mesh_surface.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <vector>

#include <boost/geometry.hpp>
#include <boost/geometry/index/rtree.hpp>

#include "lib/mesh/mesh_body.h"
#include "volumes/base/error.h"

namespace supple {

namespace {

namespace bg = boost::geometry;
using Point = bg::model::point<double, 3, bg::cs::cartesian>;
using SurfaceBox = bg::model::box<Point>;
using Entry = std::pair<SurfaceBox, int>;  // of a triangle

Point point_of(const Vec3d& v) {
  return {v.x, v.y, v.z};
}

/// A triangle with the normals of its features: face; edges opposite of the corners; corners.
struct Facet {
  std::array<Vec3d, 3> corner;
  Vec3d face;
  std::array<Vec3d, 3> edge, vertex;
};

/// Nearest point of a triangle, and the normal of the feature on which it lies (C. Ericson,
/// Real-time collision detection, section 5.1.5).
struct Nearest {
  Vec3d point;
  const Vec3d* normal;
};
Nearest nearest_on(const Facet& f, const Vec3d& p) {
  const Vec3d &a = f.corner[0], &b = f.corner[1], &c = f.corner[2];
  const Vec3d ab = b - a, ac = c - a;
  const double d1 = ab.dot(p - a), d2 = ac.dot(p - a);
  if (d1 <= 0 && d2 <= 0) return {a, &f.vertex[0]};
  const double d3 = ab.dot(p - b), d4 = ac.dot(p - b);
  if (d3 >= 0 && d4 <= d3) return {b, &f.vertex[1]};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return {a + ab * (d1 / (d1 - d3)), &f.edge[2]};
  const double d5 = ab.dot(p - c), d6 = ac.dot(p - c);
  if (d6 >= 0 && d5 <= d6) return {c, &f.vertex[2]};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return {a + ac * (d2 / (d2 - d6)), &f.edge[1]};
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) {
    return {b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6))), &f.edge[0]};
  }
  const double sum = va + vb + vc;
  return {a + ab * (vb / sum) + ac * (vc / sum), &f.face};
}

double angle_between(const Vec3d& a, const Vec3d& b) {
  return std::atan2(a.cross(b).length(), a.dot(b));
}

std::vector<Facet> facets_of(const TriangleMesh& mesh) {
  const std::vector<Vec3d>& points = mesh.vertices_lps_mm;
  std::vector<Vec3d> of_vertex(points.size(), Vec3d(0.0));
  std::map<LinkNodes, Vec3d> of_edge;
  const auto edge_of = [](const TriangleNodes& t, int opposite) {
    const int a = t[(opposite + 1) % 3], b = t[(opposite + 2) % 3];
    return a < b ? LinkNodes{a, b} : LinkNodes{b, a};
  };
  std::vector<Facet> facets;
  std::vector<TriangleNodes> kept;
  for (const TriangleNodes& t : mesh.triangles) {
    Facet f;
    for (int n = 0; n < 3; ++n) f.corner[n] = points[t[n]];
    const Vec3d normal = (f.corner[1] - f.corner[0]).cross(f.corner[2] - f.corner[0]);
    const double length = normal.length();
    if (length == 0) continue;
    f.face = normal / length;
    for (int n = 0; n < 3; ++n) {
      const Vec3d& here = f.corner[n];
      const double angle =
          angle_between(f.corner[(n + 1) % 3] - here, f.corner[(n + 2) % 3] - here);
      of_vertex[t[n]] += f.face * angle;
      of_edge.emplace(edge_of(t, n), Vec3d(0.0)).first->second += f.face;
    }
    facets.push_back(f);
    kept.push_back(t);
  }
  for (std::size_t n = 0; n < facets.size(); ++n) {
    for (int c = 0; c < 3; ++c) {
      facets[n].vertex[c] = of_vertex[kept[n][c]];
      facets[n].edge[c] = of_edge.at(edge_of(kept[n], c));
    }
  }
  return facets;
}

}  // namespace

struct MeshSurface::Tree {
  std::vector<Facet> facets;
  bg::index::rtree<Entry, bg::index::rstar<16>> boxes;
};

MeshSurface::MeshSurface(const TriangleMesh& mesh) {
  std::vector<Facet> facets = facets_of(merge_equal_vertices(mesh).mesh);
  if (facets.empty()) {
    throw InputError({"", "collider", "a mesh without any triangle that has an area", "a surface"});
  }
  std::vector<Entry> entries;
  entries.reserve(facets.size());
  for (std::size_t n = 0; n < facets.size(); ++n) {
    Vec3d lo = facets[n].corner[0], hi = lo;
    for (const Vec3d& c : facets[n].corner) {
      for (int axis = 0; axis < 3; ++axis) {
        lo[axis] = std::min(lo[axis], c[axis]);
        hi[axis] = std::max(hi[axis], c[axis]);
      }
    }
    entries.push_back({SurfaceBox(point_of(lo), point_of(hi)), int(n)});
  }
  m_tree = std::make_unique<const Tree>(Tree{std::move(facets), {entries.begin(), entries.end()}});
}

MeshSurface::~MeshSurface() = default;

SurfaceDistance MeshSurface::distance_to(const Vec3d& pos_mm) const {
  // Try the boxes that are nearest, more of them until the last is farther than the best triangle.
  const Point query = point_of(pos_mm);
  const std::size_t count = m_tree->facets.size();
  double best2 = HUGE_VAL;
  Nearest best{};
  const Facet* of = nullptr;
  std::vector<Entry> nearest;
  for (std::size_t wanted = std::min<std::size_t>(8, count);;
       wanted = std::min(4 * wanted, count)) {
    nearest.clear();
    m_tree->boxes.query(bg::index::nearest(query, unsigned(wanted)), std::back_inserter(nearest));
    double farthest2 = 0;
    for (const Entry& entry : nearest) {
      const double box2 = bg::comparable_distance(query, entry.first);
      farthest2 = std::max(farthest2, box2);
      if (box2 > best2) continue;
      const Facet& facet = m_tree->facets[entry.second];
      const Nearest found = nearest_on(facet, pos_mm);
      const double distance2 = (pos_mm - found.point).length2();
      if (distance2 < best2) {
        best2 = distance2;
        best = found;
        of = &facet;
      }
    }
    if (wanted == count || farthest2 > best2) break;
  }
  const Vec3d from = pos_mm - best.point;
  const double distance = std::sqrt(best2);
  if (distance < 1e-12) return {0, of->face};
  const double side = best.normal->dot(from) < 0 ? -1 : 1;
  return {side * distance, from * (side / distance)};
}

bool MeshSurface::is_farther(const Vec3d& pos_mm, double distance_mm) const {
  return bg::comparable_distance(point_of(pos_mm), m_tree->boxes.bounds()) >
         distance_mm * distance_mm;
}

}  // namespace supple
