#include "tests/lib/fem/tet/tet_fixtures.h"

#include <algorithm>
#include <random>

#include "tests/lib/test_bodies.h"

namespace supple::test {

namespace {

/// The six orders of axes along which a cube's tetrahedra go from its first to its last corner.
constexpr int kAxes[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};

Vec3d corner_of(const SolidMesh& mesh, std::int32_t node) {
  return mesh.nodes_lps_mm[std::size_t(node)];
}

/// Adds the faces of tetrahedra whose three corners `is_on` accepts, seen from outside.
void add_faces(SolidMesh& mesh, const std::string& name,
               const std::function<bool(std::int32_t)>& is_on) {
  constexpr int kFaces[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  FaceSet set{name, {}};
  for (const auto& tet : mesh.tets) {
    for (const auto& [a, b, c] : kFaces) {
      if (is_on(tet[a]) && is_on(tet[b]) && is_on(tet[c])) {
        set.triangles.push_back({tet[a], tet[b], tet[c]});
      }
    }
  }
  mesh.faces.push_back(std::move(set));
}

}  // namespace

TetParams exact_params() {
  TetParams params;
  params.equations = TetEquations::factor;
  params.tolerance = kRounding;
  params.limits = {180, 10};
  return params;
}

SolidMesh tet_block(const Vec3i& cubes, const Vec3d& size_mm, double perturbed) {
  SolidMesh mesh;
  std::mt19937 random(17);
  const Vec3i nodes = cubes + Vec3i(1);
  const auto index = [&](const Vec3i& at) {
    return std::int32_t((at.z * nodes.y + at.y) * nodes.x + at.x);
  };
  std::vector<Vec3i> lattice;
  for (int z = 0; z <= cubes.z; ++z) {
    for (int y = 0; y <= cubes.y; ++y) {
      for (int x = 0; x <= cubes.x; ++x) {
        const Vec3i at(x, y, z);
        Vec3d place(at);
        for (int a = 0; a < 3; ++a) {
          const bool is_inside = at[a] > 0 && at[a] < cubes[a];
          if (is_inside) place[a] += pick(random, -perturbed, perturbed);
          place[a] *= size_mm[a] / cubes[a];
        }
        mesh.nodes_lps_mm.push_back(place);
        lattice.push_back(at);
      }
    }
  }
  for (int z = 0; z < cubes.z; ++z) {
    for (int y = 0; y < cubes.y; ++y) {
      for (int x = 0; x < cubes.x; ++x) {
        for (int n = 0; n < 6; ++n) {
          std::array<std::int32_t, 4> tet{};
          Vec3i at(x, y, z);
          tet[0] = index(at);
          for (std::size_t c = 0; c < 3; ++c) {
            ++at[kAxes[n][c]];
            tet[c + 1] = index(at);
          }
          if (n >= 3) std::swap(tet[1], tet[2]);  // odd orders turn the other way
          mesh.tets.push_back(tet);
        }
      }
    }
  }
  const std::string names = "xyz";
  for (int a = 0; a < 3; ++a) {
    for (const bool high : {false, true}) {
      add_faces(mesh, std::string(1, names[std::size_t(a)]) + (high ? "+" : "-"),
                [&, a, high](std::int32_t node) {
                  return lattice[std::size_t(node)][a] == (high ? cubes[a] : 0);
                });
    }
  }
  FaceSet all{"surface", {}};
  for (const FaceSet& side : mesh.faces) {
    all.triangles.insert(all.triangles.end(), side.triangles.begin(), side.triangles.end());
  }
  mesh.faces.push_back(std::move(all));
  set_material(mesh, 6, 0.3);
  return mesh;
}

SolidMesh tet_ball(int n, double radius_mm) {
  SolidMesh mesh = tet_block(Vec3i(n), Vec3d(2), 0);
  const FaceSet surface = mesh.faces.back();
  mesh.faces = {surface};
  for (Vec3d& x : mesh.nodes_lps_mm) {
    x -= Vec3d(1);
    const double most = std::max({std::abs(x.x), std::abs(x.y), std::abs(x.z)});
    if (most > 0) x *= radius_mm * most / x.length();
  }
  for (auto& tet : mesh.tets) {
    const TetShape shape = tet_shape(corner_of(mesh, tet[0]), corner_of(mesh, tet[1]),
                                     corner_of(mesh, tet[2]), corner_of(mesh, tet[3]));
    if (shape.volume_mm3 < 0) std::swap(tet[0], tet[1]);
  }
  return mesh;
}

SolidMesh sheet_mesh(const SolidMesh& of, const std::vector<std::string>& names) {
  std::vector<std::int32_t> index(of.nodes_lps_mm.size(), -1);
  SolidMesh out;
  FaceSet set{"sheet", {}};
  for (const FaceSet& faces : of.faces) {
    if (std::find(names.begin(), names.end(), faces.name) == names.end()) continue;
    for (auto triangle : faces.triangles) {
      for (std::int32_t& node : triangle) {
        std::int32_t& at = index[std::size_t(node)];
        if (at < 0) {
          at = std::int32_t(out.nodes_lps_mm.size());
          out.nodes_lps_mm.push_back(of.nodes_lps_mm[std::size_t(node)]);
        }
        node = at;
      }
      set.triangles.push_back(triangle);
    }
  }
  out.faces.push_back(std::move(set));
  return out;
}

void set_material(SolidMesh& mesh, double young_kpa, double poisson) {
  mesh.materials = {{"tissue", young_kpa, poisson}};
  mesh.material_of.clear();
}

std::vector<NodeIndex> nodes_where(const TetModel& model,
                                   const std::function<bool(const Vec3d&)>& where) {
  std::vector<NodeIndex> nodes;
  for (std::size_t n = 0; n < model.place_count(); ++n) {
    if (where(model.volumes().positions()[n])) nodes.push_back(NodeIndex(n));
  }
  return nodes;
}

TetHeld held_where(const TetModel& model, const std::function<bool(const Vec3d&)>& where,
                   const std::function<Vec3d(const Vec3d&)>& displacement) {
  TetHeld held;
  held.nodes = nodes_where(model, where);
  for (const NodeIndex node : held.nodes) {
    const Vec3d& x = model.volumes().positions()[std::size_t(node)];
    held.displacement_mm.push_back(displacement ? displacement(x) : Vec3d(0));
  }
  return held;
}

Vec3d displacement_at(const TetSolution& solution, std::size_t node) {
  return {solution.u_mm[3 * node], solution.u_mm[3 * node + 1], solution.u_mm[3 * node + 2]};
}

double largest_difference(const TetModel& model, const TetSolution& solution,
                          const std::function<Vec3d(const Vec3d&)>& field) {
  double worst = 0, largest = 0;
  for (std::size_t n = 0; n < model.place_count(); ++n) {
    const Vec3d wanted = field(model.volumes().positions()[n]);
    worst = std::max(worst, (displacement_at(solution, n) - wanted).length());
    largest = std::max(largest, wanted.length());
  }
  return worst / largest;
}

}  // namespace supple::test
