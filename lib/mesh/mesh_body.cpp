#include "lib/mesh/mesh_body.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "lib/mesh/mesh_edges.h"
#include "volumes/base/error.h"

namespace supple {

namespace {

void check_points(const std::vector<Vec3d>& points) {
  for (std::size_t n = 0; n < points.size(); ++n) {
    const Vec3d& p = points[n];
    if (std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)) continue;
    throw InputError({"", "node " + std::to_string(n), "a coordinate that is not finite",
                      "three finite coordinates in mm"});
  }
}

/// Checks that corners exist and differ from each other.
template <std::size_t count>
void check_cells(const std::vector<std::array<int, count>>& cells, std::size_t nodes,
                 const std::string& kind) {
  for (std::size_t n = 0; n < cells.size(); ++n) {
    const std::string name = kind + " " + std::to_string(n);
    for (std::size_t a = 0; a < count; ++a) {
      const int node = cells[n][a];
      if (node < 0 || std::size_t(node) >= nodes) {
        throw InputError(
            {"", name, "node " + std::to_string(node), "an index below " + std::to_string(nodes)});
      }
      for (std::size_t b = a + 1; b < count; ++b) {
        if (node != cells[n][b]) continue;
        throw InputError({"", name, "node " + std::to_string(node) + " twice", "different nodes"});
      }
    }
  }
}

template <std::size_t count>
std::size_t bytes_of(const std::vector<std::array<int, count>>& cells) {
  return cells.capacity() * sizeof(std::array<int, count>);
}

/// A face with its corners sorted, which names it, and in outward order.
struct BodyFace {
  TriangleNodes name, outward;
};

std::vector<TriangleNodes> outer_faces(const std::vector<Vec3d>& points,
                                       const std::vector<TetrahedronNodes>& tetrahedra) {
  std::vector<BodyFace> faces;
  faces.reserve(tetrahedra.size() * 4);
  for (const TetrahedronNodes& t : tetrahedra) {
    for (int opposite = 0; opposite < 4; ++opposite) {
      TriangleNodes f;
      for (int n = 0, c = 0; n < 4; ++n) {
        if (n != opposite) f[c++] = t[n];
      }
      const Vec3d& a = points[f[0]];
      const Vec3d normal = (points[f[1]] - a).cross(points[f[2]] - a);
      if (normal.dot(points[t[opposite]] - a) > 0) std::swap(f[1], f[2]);
      TriangleNodes name = f;
      std::sort(name.begin(), name.end());
      faces.push_back({name, f});
    }
  }
  const auto by_name = [](const BodyFace& a, const BodyFace& b) { return a.name < b.name; };
  std::stable_sort(faces.begin(), faces.end(), by_name);
  std::vector<TriangleNodes> outer;
  for (std::size_t n = 0; n < faces.size();) {
    std::size_t end = n + 1;
    while (end < faces.size() && faces[end].name == faces[n].name) ++end;
    if (end == n + 1) outer.push_back(faces[n].outward);
    n = end;
  }
  return outer;
}

}  // namespace

std::size_t MeshBody::bytes() const {
  return (rest_mm.capacity() + pos_mm.capacity() + velocity_mm_s.capacity()) * sizeof(Vec3d) +
         bytes_of(links) + bytes_of(triangles) + bytes_of(tetrahedra);
}

MeshBody make_mesh_body(const TriangleMesh& mesh) {
  check_points(mesh.vertices_lps_mm);
  check_cells(mesh.triangles, mesh.vertices_lps_mm.size(), "triangle");
  MeshBody body;
  body.rest_mm = body.pos_mm = mesh.vertices_lps_mm;
  body.triangles = mesh.triangles;
  body.links = unique_edges(body.triangles);
  return body;
}

MeshBody make_mesh_body(const LineNetwork& network) {
  MeshBody body = make_mesh_body(network.mesh);
  check_cells(network.lines, body.node_count(), "line");
  body.links.insert(body.links.end(), network.lines.begin(), network.lines.end());
  body.links = unique_links(std::move(body.links));
  return body;
}

MeshBody make_network(std::vector<Vec3d> points_lps_mm, const std::vector<LinkNodes>& links) {
  check_points(points_lps_mm);
  check_cells(links, points_lps_mm.size(), "link");
  MeshBody body;
  body.links = unique_links(links);
  body.rest_mm = body.pos_mm = std::move(points_lps_mm);
  return body;
}

MeshBody make_tetrahedral_body(std::vector<Vec3d> points_lps_mm,
                               std::vector<TetrahedronNodes> tetrahedra) {
  check_points(points_lps_mm);
  check_cells(tetrahedra, points_lps_mm.size(), "tetrahedron");
  MeshBody body;
  body.links = unique_edges(tetrahedra);
  body.triangles = outer_faces(points_lps_mm, tetrahedra);
  body.tetrahedra = std::move(tetrahedra);
  body.rest_mm = body.pos_mm = std::move(points_lps_mm);
  return body;
}

MergedMesh merge_equal_vertices(const TriangleMesh& mesh) {
  const std::vector<Vec3d>& points = mesh.vertices_lps_mm;
  // Equal vertices lie together after sorting; the first of them in the source stands for all.
  std::vector<int> order(points.size());
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&](int n) {
    const Vec3d& p = points[n];
    return std::array<double, 3>{p.x, p.y, p.z};
  };
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return key(a) < key(b); });
  std::vector<int> first(points.size());
  for (std::size_t n = 0; n < order.size(); ++n) {
    const bool is_new = n == 0 || points[order[n]] != points[order[n - 1]];
    first[order[n]] = is_new ? order[n] : first[order[n - 1]];
  }
  // Vertices keep the source's order.
  MergedMesh merged;
  merged.merged_from.resize(points.size());
  for (std::size_t n = 0; n < points.size(); ++n) {
    if (first[n] == int(n)) {
      merged.merged_from[n] = int(merged.mesh.vertices_lps_mm.size());
      merged.mesh.vertices_lps_mm.push_back(points[n]);
    } else {
      merged.merged_from[n] = merged.merged_from[first[n]];
    }
  }
  for (const TriangleNodes& t : mesh.triangles) {
    const TriangleNodes m = {merged.merged_from[t[0]], merged.merged_from[t[1]],
                             merged.merged_from[t[2]]};
    if (m[0] != m[1] && m[1] != m[2] && m[2] != m[0]) merged.mesh.triangles.push_back(m);
  }
  return merged;
}

}  // namespace supple
