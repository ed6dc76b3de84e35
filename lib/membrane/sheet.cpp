#include "lib/membrane/sheet.h"

#include <algorithm>
#include <map>
#include <string>

#include "lib/mesh/mesh_edges.h"
#include "volumes/base/error.h"

namespace supple {

namespace {

/// Largest h^2 times stiffness per mass that one sweep solves.
constexpr double kSolvedPerSweep = 2;

[[noreturn]] void refuse(const std::string& found) {
  throw InputError(
      {"", "membrane", found, "a manifold with boundary whose triangles wind one way"});
}

double area_of(const std::vector<Vec3d>& points, const TriangleNodes& t) {
  return 0.5 * (points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]).length();
}

/// Sides of triangles in their direction; each one at most once in a mesh that winds one way.
std::map<LinkNodes, int> sides_of(const std::vector<TriangleNodes>& triangles) {
  std::map<LinkNodes, int> sides;
  for (std::size_t n = 0; n < triangles.size(); ++n) {
    for (int c = 0; c < 3; ++c) {
      const LinkNodes side = {triangles[n][c], triangles[n][(c + 1) % 3]};
      if (sides.emplace(side, int(n)).second) continue;
      refuse("edge " + std::to_string(side[0]) + " " + std::to_string(side[1]) +
             " twice in one direction");
    }
  }
  return sides;
}

/// Links in an order whose neighbours lie far apart: a processor solves them at once.
std::vector<LinkNodes> spread(const std::vector<LinkNodes>& links) {
  constexpr std::size_t kAtOnce = 8;
  const std::size_t part = (links.size() + kAtOnce - 1) / kAtOnce;
  std::vector<LinkNodes> ordered;
  for (std::size_t n = 0; n < part; ++n) {
    for (std::size_t at = n; at < links.size(); at += part) ordered.push_back(links[at]);
  }
  return ordered;
}

void add_springs(Sheet& sheet, const MembraneParams& params) {
  const MeshBody& body = sheet.body;
  const std::map<LinkNodes, int> sides = sides_of(body.triangles);
  for (const LinkNodes& link : spread(body.links)) {
    double area = 0;
    for (const LinkNodes& side : {link, LinkNodes{link[1], link[0]}}) {
      const auto found = sides.find(side);
      if (found != sides.end()) area += sheet.triangle_mm2[found->second];
    }
    const double rest = (body.rest_mm[link[1]] - body.rest_mm[link[0]]).length();
    for (const int node : link) sheet.springs_at[node].push_back(int(sheet.springs.size()));
    sheet.springs.push_back(
        {link[0], link[1], rest, params.stiffness_n_m * area / (rest * rest), area / rest});
  }
}

void require_manifold(const Sheet& sheet) {
  for (int n = 0; n < sheet.node_count(); ++n) {
    const std::size_t fans = fans_of(sheet, n).size();
    if (fans != 1) refuse("node " + std::to_string(n) + " with " + std::to_string(fans) + " fans");
  }
}

double spring_energy_uj(const SheetSpring& s, const std::vector<Vec3d>& pos) {
  const double longer = (pos[s.b] - pos[s.a]).length() - s.rest_mm;
  return 0.5 * s.stiffness_n_m * longer * longer;
}

}  // namespace

int corner_after(const TriangleNodes& t, int node) {
  return t[0] == node ? t[1] : t[1] == node ? t[2] : t[0];
}

int corner_before(const TriangleNodes& t, int node) {
  return t[0] == node ? t[2] : t[1] == node ? t[0] : t[1];
}

std::vector<NodeFan> fans_of(const Sheet& sheet, int node) {
  // A fan begins at the triangle whose first neighbour ends no other one, or anywhere if closed.
  const std::vector<TriangleNodes>& triangles = sheet.body.triangles;
  std::vector<int> left = sheet.triangles_at[node];
  const auto take = [&](auto&& fits) {
    const auto found = std::find_if(left.begin(), left.end(), fits);
    if (found == left.end()) return -1;
    const int taken = *found;
    left.erase(found);
    return taken;
  };
  const auto begins = [&](int t) {
    return std::none_of(left.begin(), left.end(), [&](int other) {
      return corner_before(triangles[other], node) == corner_after(triangles[t], node);
    });
  };
  std::vector<NodeFan> fans;
  while (!left.empty()) {
    NodeFan fan;
    int t = take(begins);
    if (t < 0) t = take([](int) { return true; });
    const int first = corner_after(triangles[t], node);
    fan.neighbours = {first};
    while (t >= 0) {
      fan.triangles.push_back(t);
      const int next = corner_before(triangles[t], node);
      if (next == first) break;
      fan.neighbours.push_back(next);
      t = take([&](int other) { return corner_after(triangles[other], node) == next; });
    }
    fan.is_closed = t >= 0;
    fans.push_back(std::move(fan));
  }
  return fans;
}

void weigh(Sheet& sheet, int node, const MembraneParams& params) {
  double area = 0;
  for (const int t : sheet.triangles_at[node]) area += sheet.triangle_mm2[t] / 3;
  sheet.area_mm2[node] = area;
  // Twice the sum of a node's stiffnesses bounds what its row of the stiffness matrix has.
  double stiffness = params.adhesion_j_m2 > 0 ? link_stiffness_n_m(params, area) : 0;
  for (const int n : sheet.springs_at[node]) stiffness += 2 * sheet.springs[n].stiffness_n_m;
  const double h = params.substep_s;
  sheet.mass_kg[node] = std::max(params.density_kg_m2 * area * 1e-6,
                                 h * h * stiffness / (kSolvedPerSweep * params.sweeps));
  sheet.mobility[node] = sheet.holder[node] >= 0 ? 0 : 1 / sheet.mass_kg[node];
}

Sheet make_sheet(const TriangleMesh& mesh, const MembraneParams& params) {
  Sheet sheet;
  sheet.body = make_mesh_body(mesh);
  const std::size_t count = sheet.body.node_count();
  sheet.body.velocity_mm_s.assign(count, Vec3d(0.0));
  sheet.start_mm = sheet.grip_mm = sheet.anchor_mm = sheet.body.pos_mm;
  sheet.area_mm2.assign(count, 0);
  sheet.mass_kg = sheet.mobility = sheet.area_mm2;
  sheet.link_multiplier = sheet.body.velocity_mm_s;
  sheet.holder.assign(count, -1);
  sheet.clings.assign(count, 0);
  sheet.is_torn = sheet.clings;
  sheet.triangles_at.resize(count);
  sheet.springs_at.resize(count);
  for (std::size_t n = 0; n < sheet.body.triangles.size(); ++n) {
    const TriangleNodes& t = sheet.body.triangles[n];
    for (const int node : t) sheet.triangles_at[node].push_back(int(n));
    sheet.triangle_mm2.push_back(area_of(sheet.body.rest_mm, t));
    if (!(sheet.triangle_mm2.back() > 0)) {
      refuse("triangle " + std::to_string(n) + " without an area");
    }
  }
  add_springs(sheet, params);
  require_manifold(sheet);
  for (int n = 0; n < int(count); ++n) weigh(sheet, n, params);
  renew_bending(sheet, params);
  return sheet;
}

void renew_bending(Sheet& sheet, const MembraneParams& params) {
  sheet.bending.clear();
  if (params.bending_n_m <= 0) return;
  const std::vector<Vec3d>& rest = sheet.body.rest_mm;
  for (const Hinge& hinge : find_hinges(sheet.body.triangles)) {
    const auto [a, b] = hinge.opposite;
    sheet.bending.push_back({a, b, (rest[b] - rest[a]).length(), params.bending_n_m, 0});
  }
}

void renew_links(Sheet& sheet) {
  sheet.body.links.clear();
  for (const SheetSpring& s : sheet.springs) sheet.body.links.push_back({s.a, s.b});
  sheet.body.links = unique_links(std::move(sheet.body.links));
}

int inverted_triangles(const Sheet& sheet) {
  const std::vector<Vec3d>& pos = sheet.body.pos_mm;
  const std::vector<TriangleNodes>& triangles = sheet.body.triangles;
  std::vector<Vec3d> normals, around(triangles.size(), Vec3d(0.0));
  for (const TriangleNodes& t : triangles) {
    normals.push_back((pos[t[1]] - pos[t[0]]).cross(pos[t[2]] - pos[t[0]]).normalized());
  }
  for (const SheetSpring& s : sheet.springs) {
    int beside[2], count = 0;
    for (const int t : sheet.triangles_at[s.a]) {
      const TriangleNodes& nodes = triangles[t];
      if ((nodes[0] == s.b || nodes[1] == s.b || nodes[2] == s.b) && count < 2) beside[count++] = t;
    }
    if (count < 2) continue;
    around[beside[0]] += normals[beside[1]];
    around[beside[1]] += normals[beside[0]];
  }
  int inverted = 0;
  for (std::size_t n = 0; n < triangles.size(); ++n) {
    inverted += normals[n].dot(around[n]) < 0 || normals[n].length2() == 0;
  }
  return inverted;
}

double link_stiffness_n_m(const MembraneParams& params, double area_mm2) {
  return 2 * params.adhesion_j_m2 * area_mm2 / (params.adhesion_mm * params.adhesion_mm);
}

MembraneEnergy energy_of(const Sheet& sheet, const MembraneParams& params) {
  // A mN mm is a microjoule, and so is a kg mm^2/s^2.
  constexpr double kJoule = 1e-6;
  MembraneEnergy energy;
  const MeshBody& body = sheet.body;
  for (const SheetSpring& s : sheet.springs) energy.springs_j += spring_energy_uj(s, body.pos_mm);
  for (const SheetSpring& s : sheet.bending) energy.springs_j += spring_energy_uj(s, body.pos_mm);
  for (int n = 0; n < sheet.node_count(); ++n) {
    energy.kinetic_j += 0.5 * sheet.mass_kg[n] * body.velocity_mm_s[n].length2();
    if (!sheet.clings[n]) continue;
    const double stretch2 = (body.pos_mm[n] - sheet.anchor_mm[n]).length2();
    energy.adhesion_j += 0.5 * link_stiffness_n_m(params, sheet.area_mm2[n]) * stretch2;
  }
  energy.springs_j *= kJoule;
  energy.kinetic_j *= kJoule;
  energy.adhesion_j *= kJoule;
  return energy;
}

}  // namespace supple
