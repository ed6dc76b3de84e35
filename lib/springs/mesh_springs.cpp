#include "lib/springs/mesh_springs.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "lib/mesh/mesh_edges.h"
#include "volumes/base/error.h"
#include "volumes/base/units.h"

namespace supple {

namespace {

/// Volume in mm^3 that each node stands for.
std::vector<double> node_volumes(const MeshBody& body, const MeshSpringParams& params) {
  const std::vector<Vec3d>& x = body.rest_mm;
  std::vector<double> volume(body.node_count(), 0);
  const auto share = [&](const auto& cell, double whole) {
    for (const int node : cell) volume[node] += whole / double(cell.size());
  };
  for (const TetrahedronNodes& t : body.tetrahedra) {
    const Vec3d a = x[t[1]] - x[t[0]], b = x[t[2]] - x[t[0]], c = x[t[3]] - x[t[0]];
    share(t, std::abs(a.dot(b.cross(c))) / 6);
  }
  std::vector<LinkNodes> of_cells = unique_edges(body.tetrahedra);
  if (body.tetrahedra.empty()) {
    for (const TriangleNodes& t : body.triangles) {
      const double area = (x[t[1]] - x[t[0]]).cross(x[t[2]] - x[t[0]]).length() / 2;
      share(t, area * params.thickness_mm);
    }
    of_cells = unique_edges(body.triangles);
  }
  for (const LinkNodes& link : body.links) {
    if (std::binary_search(of_cells.begin(), of_cells.end(), link)) continue;
    share(link, (x[link[1]] - x[link[0]]).length() * params.section_mm2);
  }
  return volume;
}

void check_nodes(const SpringSystem& system, const MeshBody& body) {
  if (system.node_count() == body.node_count()) return;
  throw InputError({"", "spring system", std::to_string(system.node_count()) + " nodes",
                    std::to_string(body.node_count()) + ", as the mesh body has"});
}

}  // namespace

void MeshSpringParams::validate() const {
  for (const double value : {structural_n_m, bending_n_m, damping_n_s_m, stiffness_damping_s,
                             mass_damping_per_s, density_kg_m3, thickness_mm, section_mm2}) {
    if (value >= 0 && std::isfinite(value)) continue;
    throw InputError({"", "springs of a mesh", number_text(value), "finite values of at least 0"});
  }
}

SpringSystem make_springs(const MeshBody& body, const MeshSpringParams& params) {
  params.validate();
  SpringSystem system;
  system.mass_damping_per_s = params.mass_damping_per_s;
  const std::vector<double> volume = node_volumes(body, params);
  for (std::size_t n = 0; n < volume.size(); ++n) {
    const double mass = volume[n] * params.density_kg_m3 * kM3PerMm3;
    if (!(mass > 0)) {
      throw InputError({"", "node " + std::to_string(n), "no mass",
                        "a connector that has a size and a density"});
    }
    system.mass_kg.push_back(mass);
  }
  const auto add_spring = [&](const LinkNodes& ends, double stiffness) {
    const double rest = (body.rest_mm[ends[1]] - body.rest_mm[ends[0]]).length();
    const double damping = params.damping_n_s_m + params.stiffness_damping_s * stiffness;
    system.springs.push_back({ends[0], ends[1], rest, stiffness, damping});
  };
  for (const LinkNodes& link : body.links) add_spring(link, params.structural_n_m);
  if (params.bending_n_m > 0) {
    for (const Hinge& hinge : find_hinges(body.triangles)) {
      add_spring(hinge.opposite, params.bending_n_m);
    }
  }
  system.pos_mm.resize(body.node_count());
  system.velocity_mm_s.resize(body.node_count());
  take_state(body, system);
  return system;
}

void give_state(const SpringSystem& system, MeshBody& body) {
  check_nodes(system, body);
  body.pos_mm = system.pos_mm;
  const bool moves = std::any_of(system.velocity_mm_s.begin(), system.velocity_mm_s.end(),
                                 [](const Vec3d& v) { return v != Vec3d(0.0); });
  if (moves) {
    body.velocity_mm_s = system.velocity_mm_s;
  } else {
    std::vector<Vec3d>().swap(body.velocity_mm_s);
  }
}

void take_state(const MeshBody& body, SpringSystem& system) {
  check_nodes(system, body);
  system.pos_mm = body.pos_mm;
  if (body.velocity_mm_s.empty()) {
    system.velocity_mm_s.assign(body.node_count(), Vec3d(0.0));
  } else {
    system.velocity_mm_s = body.velocity_mm_s;
  }
}

}  // namespace supple
