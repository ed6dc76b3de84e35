#include "tools/examples/drag_surface.h"

#include <cstdio>

#include "lib/chainmail/mesh_ecm.h"
#include "volumes/io/mesh/mesh_file.h"

namespace supple::examples {

namespace {

int nearest_vertex(const std::vector<Vec3d>& points, const Vec3d& to) {
  int nearest = 0;
  for (std::size_t n = 1; n < points.size(); ++n) {
    if ((points[n] - to).length2() < (points[std::size_t(nearest)] - to).length2()) {
      nearest = int(n);
    }
  }
  return nearest;
}

/// Area-weighted normals of the vertices.
std::vector<Vec3d> vertex_normals(const std::vector<Vec3d>& points,
                                  const std::vector<TriangleNodes>& triangles) {
  std::vector<Vec3d> normals(points.size(), Vec3d(0.0));
  for (const auto& [a, b, c] : triangles) {
    const Vec3d normal = (points[b] - points[a]).cross(points[c] - points[a]);
    for (const int n : {a, b, c}) normals[n] += normal;
  }
  return normals;
}

}  // namespace

void drag_surface(const SurfaceDrag& drag) {
  // Files that store corners anew per triangle are joined, so that the surface holds together.
  const MeshFile file(drag.input);
  const MergedMesh merged = merge_equal_vertices(read_mesh(drag.input));
  MeshBody body = make_mesh_body(merged.mesh);
  MeshEcm ecm(body, {drag.max_length, drag.min_length, drag.shear});

  const int grabbed = nearest_vertex(body.rest_mm, {drag.grab[0], drag.grab[1], drag.grab[2]});
  NodeSet far;
  for (std::size_t n = 0; n < body.node_count(); ++n) {
    const double distance = (body.rest_mm[n] - body.rest_mm[grabbed]).length();
    if (drag.fix_beyond > 0 && distance > drag.fix_beyond) far.push_back(int(n));
  }
  std::vector<NodeSet> anchors;
  if (!far.empty()) anchors.push_back(far);
  const MeshEcmReport report =
      ecm.drag({{{grabbed}, {drag.by[0], drag.by[1], drag.by[2]}}}, anchors);

  // A normal of the file keeps its side of the surface.
  const std::vector<Vec3d> before = vertex_normals(body.rest_mm, body.triangles);
  const std::vector<Vec3d> after = vertex_normals(body.pos_mm, body.triangles);
  std::vector<Vec3d> moved;
  for (const int node : merged.merged_from) moved.push_back(body.pos_mm[node]);
  file.write_moved(drag.output, moved, [&](std::size_t vertex, const Vec3d& normal) {
    const int node = merged.merged_from[vertex];
    return before[node].dot(normal) < 0 ? -after[node] : after[node];
  });
  std::printf(
      "%s: %zu nodes, %zu links; vertex %d performed %.6g of its move, %lld nodes moved, "
      "%lld links broken\n",
      drag.output.c_str(), body.node_count(), body.links.size(), grabbed, report.fraction(),
      (long long)report.moved, (long long)ecm.check_links().violated);
}

}  // namespace supple::examples
