#include "tests/lib/spring_fixtures.h"

namespace supple::test {

SpringSystem oscillator(double mass_kg, double stiffness_n_m, double damping_n_s_m, double rest_mm,
                        double stretch_mm) {
  SpringSystem system;
  system.mass_kg = {mass_kg, mass_kg};
  system.pos_mm.assign(2, Vec3d(0.0));
  system.pos_mm[1].x = rest_mm + stretch_mm;
  system.velocity_mm_s.assign(2, Vec3d(0.0));
  system.springs = {{0, 1, rest_mm, stiffness_n_m, damping_n_s_m}};
  hold(system, 0);
  return system;
}

SpringSystem chain(int nodes, double mass_kg, double stiffness_n_m, double spacing_mm) {
  SpringSystem system;
  system.mass_kg.assign(nodes, mass_kg);
  system.velocity_mm_s.assign(nodes, Vec3d(0.0));
  for (int n = 0; n < nodes; ++n) {
    system.pos_mm.push_back({n * spacing_mm, 0, 0});
    if (n > 0) system.springs.push_back({n - 1, n, spacing_mm, stiffness_n_m, 0});
  }
  return system;
}

TriangleMesh sheet(int columns, int rows, double spacing_mm) {
  TriangleMesh mesh;
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      mesh.vertices_lps_mm.push_back({i * spacing_mm, j * spacing_mm, 0});
      if (i == 0 || j == 0) continue;
      const int d = j * columns + i, c = d - 1, b = d - columns, a = b - 1;
      mesh.triangles.push_back({a, b, d});
      mesh.triangles.push_back({a, d, c});
    }
  }
  return mesh;
}

SpringSystem random_system(std::mt19937& random, int nodes, int springs) {
  const auto pick = [&](double lo, double hi) {
    return std::uniform_real_distribution<double>(lo, hi)(random);
  };
  const auto vector = [&](double reach) {
    return Vec3d(pick(-reach, reach), pick(-reach, reach), pick(-reach, reach));
  };
  SpringSystem system;
  for (int n = 0; n < nodes; ++n) {
    system.mass_kg.push_back(pick(1e-4, 1e-2));
    system.pos_mm.push_back(vector(10));
    system.velocity_mm_s.push_back(vector(50));
  }
  while (int(system.springs.size()) < springs) {
    const int a = int(random() % unsigned(nodes)), b = int(random() % unsigned(nodes));
    if (a == b || (system.pos_mm[a] - system.pos_mm[b]).length() < 0.5) continue;
    system.springs.push_back({a, b, pick(0, 15), pick(1, 500), pick(0, 0.01)});
  }
  return system;
}

}  // namespace supple::test
