#include "tools/lab/bench/elastic/springs_membrane.h"

#include <cmath>

#include "lib/springs/mesh_springs.h"
#include "lib/springs/minimise.h"
#include "volumes/base/units.h"

namespace supple::tools {

namespace {

constexpr double kBumpMm = 4, kPullMm = 5;

TriangleMesh grid_mesh() {
  TriangleMesh mesh;
  for (int j = 0; j < kMembraneRows; ++j) {
    for (int i = 0; i < kMembraneColumns; ++i) {
      mesh.vertices_lps_mm.push_back({double(i), double(j), 0});
      if (i == 0 || j == 0) continue;
      const int d = j * kMembraneColumns + i, c = d - 1, b = d - kMembraneColumns, a = b - 1;
      mesh.triangles.push_back({a, b, d});
      mesh.triangles.push_back({a, d, c});
    }
  }
  return mesh;
}

}  // namespace

SpringSystem flat_membrane(double stiffness_n_m) {
  MeshSpringParams params;
  params.structural_n_m = stiffness_n_m;
  params.bending_n_m = stiffness_n_m / 10;
  SpringSystem system = make_springs(make_mesh_body(grid_mesh()), params);
  for (int n = 0; n < int(system.node_count()); ++n) {
    const int i = n % kMembraneColumns, j = n / kMembraneColumns;
    const bool is_rim = i == 0 || j == 0 || i == kMembraneColumns - 1 || j == kMembraneRows - 1;
    if (is_rim) hold(system, n);
  }
  return system;
}

SpringSystem plucked_membrane(double stiffness_n_m) {
  SpringSystem system = flat_membrane(stiffness_n_m);
  for (Vec3d& p : system.pos_mm) {
    p.z = kBumpMm * std::sin(kPi * p.x / (kMembraneColumns - 1)) *
          std::sin(kPi * p.y / (kMembraneRows - 1));
  }
  for (HeldNode& held : system.held) system.pos_mm[held.node] = held.target_mm;
  return system;
}

Forceps::Forceps(SpringSystem& system) {
  for (int j = -1; j <= 1; ++j) {
    for (int i = -1; i <= 1; ++i) {
      const int node = (kMembraneRows / 2 + j) * kMembraneColumns + kMembraneColumns / 2 + i;
      hold(system, node);
      m_rest.push_back({node, system.pos_mm[node]});
    }
  }
}

void Forceps::move(SpringSystem& system, int frame) const {
  const double height_mm = kPullMm * std::sin(2 * kPi * kFrameS * (frame + 1));
  for (const HeldNode& rest : m_rest) {
    drive(system, rest.node, rest.target_mm + Vec3d(0, 0, height_mm));
  }
}

double Forceps::pull_n(const SpringSystem& system, const std::vector<Vec3d>& reactions_n) const {
  double sum = 0;
  for (std::size_t n = 0; n < system.held.size(); ++n) {
    for (const HeldNode& rest : m_rest) {
      if (rest.node == system.held[n].node) sum -= reactions_n[n].z;
    }
  }
  return sum;
}

PulledMembrane pulled_membrane(double stiffness_n_m) {
  PulledMembrane pulled{flat_membrane(stiffness_n_m), 0, 0};
  const Forceps forceps(pulled.system);
  forceps.move(pulled.system, Forceps::kHighestFrame);
  minimise(pulled.system, {1e-6 * stiffness_n_m, 500});
  pulled.energy_j = energy(pulled.system).spring_j;
  std::vector<Vec3d> force_mn, reactions_n;
  forces_mn(pulled.system, force_mn, Damping::without);
  for (const HeldNode& held : pulled.system.held) {
    reactions_n.push_back(force_mn[held.node] * 1e-3);
  }
  pulled.pull_n = forceps.pull_n(pulled.system, reactions_n);
  return pulled;
}

}  // namespace supple::tools
