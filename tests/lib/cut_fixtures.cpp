#include "tests/lib/cut_fixtures.h"

#include <cmath>

namespace supple::test {

Vec3d pick_vector(std::mt19937& random, double lo, double hi) {
  const double x = pick(random, lo, hi), y = pick(random, lo, hi);
  return {x, y, pick(random, lo, hi)};
}

TriangleMesh to_world(const Geometry& geometry, TriangleMesh mesh) {
  for (Vec3d& vertex : mesh.vertices_lps_mm) vertex = geometry.world_from_index(vertex);
  return mesh;
}

TriangleMesh unit_sphere(int refinements) {
  const double g = (1 + std::sqrt(5.0)) / 2;
  TriangleMesh mesh{
      {{-1, g, 0},
       {1, g, 0},
       {-1, -g, 0},
       {1, -g, 0},
       {0, -1, g},
       {0, 1, g},
       {0, -1, -g},
       {0, 1, -g},
       {g, 0, -1},
       {g, 0, 1},
       {-g, 0, -1},
       {-g, 0, 1}},
      {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
       {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
       {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}}};
  for (int n = 0; n < refinements; ++n) {
    TriangleMesh finer;
    for (const auto& triangle : mesh.triangles) {
      const Vec3d a = mesh.vertices_lps_mm[triangle[0]], b = mesh.vertices_lps_mm[triangle[1]],
                  c = mesh.vertices_lps_mm[triangle[2]];
      const int first = int(finer.vertices_lps_mm.size());
      for (const Vec3d& v : {a, b, c, a + b, b + c, c + a}) {
        finer.vertices_lps_mm.push_back(v.normalized());
      }
      for (const auto& [x, y, z] : {std::array{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}}) {
        finer.triangles.push_back({first + x, first + y, first + z});
      }
    }
    mesh = finer;
  }
  for (Vec3d& vertex : mesh.vertices_lps_mm) vertex.normalize();
  return mesh;
}

TriangleMesh box_mesh(const Vec3d& lo, const Vec3d& hi) {
  TriangleMesh mesh;
  for (int n = 0; n < 8; ++n) {
    mesh.vertices_lps_mm.push_back({n & 1 ? hi.x : lo.x, n & 2 ? hi.y : lo.y, n & 4 ? hi.z : lo.z});
  }
  mesh.triangles = {{0, 1, 3}, {0, 3, 2}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 3, 7}, {2, 7, 6}, {0, 2, 6}, {0, 6, 4}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

}  // namespace supple::test
