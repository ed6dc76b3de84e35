// Circular sheets on spheres: rings of 6, 12, 18 and so on nodes about the middle, at equal
// distances from each other, so that the outermost one is the rim. Regular hexagons have the same
// triangles; here edges are between 0.95 and 1.45 times the distance of rings, the longest along
// six ways from the middle to the rim, and those of the rim 1.05 times. Lloyd steps within the rim
// would halve those next to its six places of two triangles: from 0.89 ... 1.27 of the mean they
// lead to 0.46 ... 1.15. Circles about the middle shrink by sin(a) / a at the polar angle a, that
// is by 3 % at 5 mm from the middle on a radius of 12 mm.
#include <cmath>
#include <utility>

#include "lib/membrane/membrane.h"
#include "volumes/base/error.h"
#include "volumes/base/units.h"

namespace supple {

namespace {

int nodes_within(int rings) {
  return 1 + 3 * rings * (rings + 1);
}

/// A node of a ring; places go round once in 6 times the ring's number.
int node_at(int ring, int place) {
  return ring == 0 ? 0 : nodes_within(ring - 1) + place % (6 * ring);
}

/// Adds triangles between a ring and the one within it, counter-clockwise seen against the middle.
void add_ring(TriangleMesh& mesh, int ring) {
  for (int sixth = 0; sixth < 6; ++sixth) {
    for (int n = 0; n < ring; ++n) {
      const int outer = sixth * ring + n, inner = sixth * (ring - 1) + n;
      const int here = node_at(ring - 1, inner), beyond = node_at(ring, outer + 1);
      mesh.triangles.push_back({here, beyond, node_at(ring, outer)});
      if (n + 1 == ring) continue;
      mesh.triangles.push_back({here, node_at(ring - 1, inner + 1), beyond});
    }
  }
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
  int rings = 1;
  while (nodes_within(rings) < nodes) ++rings;
  const Vec3d axis = middle.normalized();
  const auto [first, second] = across(axis);
  TriangleMesh mesh;
  mesh.vertices_lps_mm.push_back(centre_mm + axis * radius_mm);
  for (int ring = 1; ring <= rings; ++ring) {
    const double angle = sheet_radius_mm / radius_mm * ring / rings;
    for (int n = 0; n < 6 * ring; ++n) {
      const double about = kPi / 3 * n / ring;
      const Vec3d aside = first * std::cos(about) + second * std::sin(about);
      mesh.vertices_lps_mm.push_back(
          centre_mm + (axis * std::cos(angle) + aside * std::sin(angle)) * radius_mm);
    }
    add_ring(mesh, ring);
  }
  return mesh;
}

}  // namespace supple
