// Circular sheets on spheres: the triangles of a regular lattice that lie within a circle, in the
// plane of polar angles about the middle (azimuthal equidistant). Distances from the middle are
// kept; those along circles about it shrink by sin(a) / a at the polar angle a, that is by 3 % at
// 5 mm from the middle on a radius of 12 mm.
#include <cmath>
#include <map>
#include <utility>

#include "lib/membrane/membrane.h"
#include "volumes/base/error.h"

namespace supple {

namespace {

/// Steps along two directions at 60 degrees.
using LatticeSteps = std::pair<int, int>;

Vec3d in_plane(const LatticeSteps& at) {
  return {at.first + 0.5 * at.second, std::sqrt(0.75) * at.second, 0};
}

/// Points of the lattice within a circle about one of them, numbered in order.
std::map<LatticeSteps, int> points_within(double radius_steps) {
  std::map<LatticeSteps, int> points;
  const int most = int(radius_steps * 1.2) + 1;
  for (int a = -most; a <= most; ++a) {
    for (int b = -most; b <= most; ++b) {
      if (in_plane({a, b}).length() <= radius_steps) points.emplace(LatticeSteps{a, b}, 0);
    }
  }
  return points;
}

/// Triangles of the points, counter-clockwise in the plane.
std::vector<std::array<LatticeSteps, 3>> triangles_of(const std::map<LatticeSteps, int>& points) {
  std::vector<std::array<LatticeSteps, 3>> triangles;
  for (const auto& point : points) {
    const auto [a, b] = point.first;
    const LatticeSteps here{a, b}, right{a + 1, b}, up{a, b + 1}, down{a + 1, b - 1};
    if (points.count(right) == 0) continue;
    if (points.count(up) > 0) triangles.push_back({here, right, up});
    if (points.count(down) > 0) triangles.push_back({here, down, right});
  }
  return triangles;
}

/// Unit vectors perpendicular to a direction and to each other.
std::pair<Vec3d, Vec3d> across(const Vec3d& direction) {
  const Vec3d world = std::abs(direction.x) < 0.6 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0);
  const Vec3d first = world.cross(direction).normalized();
  return {first, direction.cross(first)};
}

}  // namespace

TriangleMesh membrane_on_sphere(const Vec3d& centre_mm, double radius_mm, const Vec3d& middle,
                                double sheet_radius_mm, int nodes) {
  require(radius_mm > 0, "radius_mm", radius_mm, "a positive number of mm");
  require(sheet_radius_mm > 0 && sheet_radius_mm < 3 * radius_mm, "sheet_radius_mm",
          sheet_radius_mm, "above 0 and below 3 radii of the sphere");
  require(nodes >= 7 && nodes <= 1000000, "nodes", nodes, "7 to 1000000");
  require(middle.length() > 0, "middle", middle.length(), "a direction");
  double radius_steps = 1.01;
  while (int(points_within(radius_steps).size()) < nodes) radius_steps *= 1.01;
  std::map<LatticeSteps, int> points = points_within(radius_steps);
  const Vec3d axis = middle.normalized();
  const auto [first, second] = across(axis);
  TriangleMesh mesh;
  for (auto& [steps, node] : points) {
    const Vec3d flat = in_plane(steps) / radius_steps;
    const double part = flat.length(), angle = part * sheet_radius_mm / radius_mm;
    const Vec3d aside = part > 0 ? (first * flat.x + second * flat.y) / part : Vec3d(0.0);
    node = int(mesh.vertices_lps_mm.size());
    mesh.vertices_lps_mm.push_back(centre_mm +
                                   (axis * std::cos(angle) + aside * std::sin(angle)) * radius_mm);
  }
  // Seen from outside they are counter-clockwise; the sheet faces the centre.
  for (const auto& [a, b, c] : triangles_of(points)) {
    mesh.triangles.push_back({points.at(a), points.at(c), points.at(b)});
  }
  return mesh;
}

}  // namespace supple
