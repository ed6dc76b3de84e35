#include "lib/fem/tet/shell_surface.h"

#include <algorithm>
#include <limits>

namespace supple {

namespace {

NodeSets corners_of(const std::vector<std::array<NodeIndex, 3>>& triangles) {
  NodeSets sets;
  for (const auto& triangle : triangles) sets.add(triangle.data(), 3);
  return sets;
}

/// Weights of the corners at the nearest point of a triangle (Ericson, Real-time collision
/// detection, 2005, section 5.1.5).
std::array<double, 3> nearest_weights(const Vec3d& x, const Vec3d& a, const Vec3d& b,
                                      const Vec3d& c) {
  const Vec3d ab = b - a, ac = c - a, ax = x - a, bx = x - b, cx = x - c;
  const double d1 = ab.dot(ax), d2 = ac.dot(ax);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  const double d3 = ab.dot(bx), d4 = ac.dot(bx);
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return {1 - d1 / (d1 - d3), d1 / (d1 - d3), 0};
  const double d5 = ab.dot(cx), d6 = ac.dot(cx);
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return {1 - d2 / (d2 - d6), 0, d2 / (d2 - d6)};
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {0, 1 - w, w};
  }
  const double sum = va + vb + vc;
  return {va / sum, vb / sum, vc / sum};
}

}  // namespace

ShellSurface::ShellSurface(const std::vector<Vec3d>& positions,
                           const std::vector<std::array<NodeIndex, 3>>& triangles)
    : m_positions(positions),
      m_triangles(triangles),
      m_normals(positions.size(), Vec3d(0)),
      m_areas(positions.size(), 0),
      m_corners(corners_of(triangles)),
      m_around(positions.size(), m_corners) {
  for (const auto& [a, b, c] : m_triangles) {
    const Vec3d& from = m_positions[std::size_t(a)];
    const Vec3d area =
        (m_positions[std::size_t(b)] - from).cross(m_positions[std::size_t(c)] - from) / 2;
    for (const NodeIndex node : {a, b, c}) {
      m_normals[std::size_t(node)] += area;
      m_areas[std::size_t(node)] += area.length() / 3;
    }
  }
  for (Vec3d& normal : m_normals) {
    if (normal.length() > 0) normal.normalize();
  }
}

std::int32_t ShellSurface::triangle_at(NodeIndex node) const {
  const std::int32_t first = m_around.begin[std::size_t(node)];
  if (first == m_around.begin[std::size_t(node) + 1]) return -1;
  return m_around.places[std::size_t(first)].set;
}

ShellSurface::Place ShellSurface::nearest(const Vec3d& x, std::int32_t from) const {
  Place best;
  double least = std::numeric_limits<double>::infinity();
  const auto look_at = [&](std::int32_t triangle) {
    const auto& corners = m_triangles[std::size_t(triangle)];
    const auto at = [&](std::size_t c) { return m_positions[std::size_t(corners[c])]; };
    const std::array<double, 3> weights = nearest_weights(x, at(0), at(1), at(2));
    Place place;
    for (std::size_t c = 0; c < 3; ++c) {
      place.point += at(c) * weights[c];
      place.normal += m_normals[std::size_t(corners[c])] * weights[c];
    }
    const double distance = (x - place.point).length2();
    if (!(distance < least)) return;
    least = distance;
    place.normal.normalize();
    place.triangle = triangle;
    best = place;
  };
  look_at(from);
  for (std::int32_t at = -1; at != best.triangle;) {
    at = best.triangle;
    for (const NodeIndex corner : m_triangles[std::size_t(at)]) {
      for (std::int32_t n = m_around.begin[std::size_t(corner)];
           n < m_around.begin[std::size_t(corner) + 1]; ++n) {
        look_at(m_around.places[std::size_t(n)].set);
      }
    }
  }
  return best;
}

}  // namespace supple
