#include "tests/lib/membrane/sheets.h"

#include <algorithm>
#include <map>
#include <set>

namespace supple::test {

namespace {

using Place = std::array<double, 3>;

Place place_of(const Vec3d& v) {
  return {v.x, v.y, v.z};
}

/// Triangles at every edge, edges named by the places of their ends at rest.
std::map<std::set<Place>, int> edges_by_place(const MeshBody& body) {
  std::map<std::set<Place>, int> edges;
  std::map<LinkNodes, int> by_node;
  for (const TriangleNodes& t : body.triangles) {
    for (int c = 0; c < 3; ++c) {
      const int a = t[c], b = t[(c + 1) % 3];
      ++by_node[{std::min(a, b), std::max(a, b)}];
    }
  }
  for (const auto& [edge, count] : by_node) {
    int& most = edges[{place_of(body.rest_mm[edge[0]]), place_of(body.rest_mm[edge[1]])}];
    most = std::max(most, count);
  }
  return edges;
}

/// Groups of a node's triangles that hang together by edges at the node.
int fans_at(const std::vector<TriangleNodes>& triangles, const std::vector<int>& at, int node) {
  std::vector<int> left = at;
  int fans = 0;
  while (!left.empty()) {
    ++fans;
    std::vector<int> open = {left.back()};
    left.pop_back();
    while (!open.empty()) {
      const TriangleNodes here = triangles[open.back()];
      open.pop_back();
      for (std::size_t n = 0; n < left.size();) {
        int shared = 0;
        for (const int a : here) {
          for (const int b : triangles[left[n]]) shared += a == b && a != node;
        }
        if (shared == 0) {
          ++n;
          continue;
        }
        open.push_back(left[n]);
        left.erase(left.begin() + long(n));
      }
    }
  }
  return fans;
}

}  // namespace

TriangleMesh flat_sheet(int length, int width, double cell_mm) {
  TriangleMesh mesh;
  const auto node = [&](int i, int j) { return i * (width + 1) + j; };
  for (int i = 0; i <= length; ++i) {
    for (int j = 0; j <= width; ++j) {
      mesh.vertices_lps_mm.push_back({i * cell_mm, j * cell_mm, 0});
      if (i == length || j == width) continue;
      const int a = node(i, j), b = node(i + 1, j), c = node(i + 1, j + 1), d = node(i, j + 1);
      if ((i + j) % 2 == 0) {
        mesh.triangles.push_back({a, b, c});
        mesh.triangles.push_back({a, c, d});
      } else {
        mesh.triangles.push_back({a, b, d});
        mesh.triangles.push_back({b, c, d});
      }
    }
  }
  return mesh;
}

Obstacle plane_ground() {
  return {"ground", PlaneShape{Vec3d(0.0), Vec3d(0, 0, 1)}};
}

Instrument ball_forceps(double radius_mm) {
  Instrument forceps;
  forceps.name = "forceps";
  forceps.kind = InstrumentKind::forceps;
  forceps.grip = GripZone{RoundCone{Vec3d(0.0), Vec3d(0, 0, 1e-3), radius_mm, radius_mm}, 5, 8};
  return forceps;
}

InstrumentPose pose_at(const Vec3d& tip_mm, double opening_degrees) {
  InstrumentPose pose;
  pose.tip_mm = tip_mm;
  pose.opening_degrees = opening_degrees;
  return pose;
}

std::vector<ToolMotion> motion(const Instrument& instrument, const InstrumentPose& from,
                               const InstrumentPose& to) {
  return {motion_of(0, instrument, from, to)};
}

std::int64_t count_of(const MembraneReport& report, MembraneEvent::Kind kind) {
  std::int64_t count = 0;
  for (const MembraneEvent& event : report.events) count += event.kind == kind ? event.count : 0;
  return count;
}

std::string fault_of(const MeshBody& body) {
  const int nodes = int(body.node_count());
  std::set<LinkNodes> sides, edges;
  std::vector<std::vector<int>> at{std::size_t(nodes)};
  for (std::size_t n = 0; n < body.triangles.size(); ++n) {
    const TriangleNodes& t = body.triangles[n];
    for (int c = 0; c < 3; ++c) {
      const int a = t[c], b = t[(c + 1) % 3];
      if (a < 0 || a >= nodes || a == b) return "corners of triangle " + std::to_string(n);
      if (!sides.insert({a, b}).second) return "side " + std::to_string(a) + " twice";
      edges.insert({std::min(a, b), std::max(a, b)});
      at[std::size_t(a)].push_back(int(n));
    }
    const Vec3d& first = body.rest_mm[t[0]];
    if (!((body.rest_mm[t[1]] - first).cross(body.rest_mm[t[2]] - first).length() > 1e-9)) {
      return "triangle " + std::to_string(n) + " without an area";
    }
  }
  for (int n = 0; n < nodes; ++n) {
    if (!is_finite(body.pos_mm[n])) return "place of node " + std::to_string(n);
    const int fans = fans_at(body.triangles, at[std::size_t(n)], n);
    if (fans != 1) return std::to_string(fans) + " fans at node " + std::to_string(n);
  }
  if (std::vector<LinkNodes>(edges.begin(), edges.end()) != body.links) return "links";
  return "";
}

std::vector<std::array<double, 9>> rest_triangles(const MeshBody& body) {
  std::vector<std::array<double, 9>> all;
  for (const TriangleNodes& t : body.triangles) {
    std::array<double, 9>& corners = all.emplace_back();
    for (int n = 0; n < 9; ++n) corners[std::size_t(n)] = body.rest_mm[t[n / 3]][n % 3];
  }
  std::sort(all.begin(), all.end());
  return all;
}

int facing_back(const MeshBody& body) {
  const std::vector<TriangleNodes>& triangles = body.triangles;
  std::vector<Vec3d> normals;
  for (const TriangleNodes& t : triangles) {
    const Vec3d& first = body.pos_mm[t[0]];
    normals.push_back((body.pos_mm[t[1]] - first).cross(body.pos_mm[t[2]] - first).normalized());
  }
  int count = 0;
  for (std::size_t n = 0; n < triangles.size(); ++n) {
    Vec3d around(0.0);
    for (std::size_t other = 0; other < triangles.size(); ++other) {
      int shared = 0;
      for (const int a : triangles[n]) {
        for (const int b : triangles[other]) shared += a == b;
      }
      if (shared == 2) around += normals[other];
    }
    count += normals[n].length() == 0 || normals[n].dot(around) < 0;
  }
  return count;
}

std::vector<Vec3d> torn_places(const MeshBody& before, const MeshBody& after) {
  const auto was = edges_by_place(before);
  std::vector<Vec3d> places;
  for (const auto& [edge, count] : edges_by_place(after)) {
    const auto found = was.find(edge);
    if (count == 2 || found == was.end() || found->second == 1) continue;
    for (const Place& end : edge) places.push_back({end[0], end[1], end[2]});
  }
  return places;
}

}  // namespace supple::test
