#include "raycast/microscope/shape_normals.h"

#include <cmath>

#include "volumes/base/units.h"

namespace supple {

namespace {

/// Corners of the triangles around each vertex: those of vertex n from first[n] on.
struct VertexCorners {
  std::vector<int> first, corners;
};

VertexCorners corners_of(std::size_t vertex_count, const Triangles& triangles) {
  VertexCorners around;
  around.first.assign(vertex_count + 1, 0);
  for (const auto& triangle : triangles) {
    for (const int vertex : triangle) ++around.first[std::size_t(vertex) + 1];
  }
  for (std::size_t n = 0; n < vertex_count; ++n) around.first[n + 1] += around.first[n];
  around.corners.resize(3 * triangles.size());
  std::vector<int> next(around.first.begin(), around.first.end() - 1);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t c = 0; c < 3; ++c) {
      around.corners[std::size_t(next[std::size_t(triangles[t][c])]++)] = int(3 * t + c);
    }
  }
  return around;
}

Vec3f unit_or_upwards(const Vec3d& v) {
  const double length = v.length();
  return length > 0 ? Vec3f(v / length) : Vec3f(0, 0, 1);
}

}  // namespace

std::vector<Vec3f> corner_normals(const std::vector<Vec3d>& vertices_mm, const Triangles& triangles,
                                  double crease_degrees) {
  std::vector<Vec3d> areas(triangles.size());
  std::vector<double> lengths(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const Vec3d &a = vertices_mm[std::size_t(triangles[t][0])],
                &b = vertices_mm[std::size_t(triangles[t][1])],
                &c = vertices_mm[std::size_t(triangles[t][2])];
    areas[t] = (b - a).cross(c - a);
    lengths[t] = areas[t].length();
  }
  const VertexCorners around = corners_of(vertices_mm.size(), triangles);
  const double least_cosine = std::cos(crease_degrees * kPi / 180);
  std::vector<Vec3f> normals(3 * triangles.size());
  for (std::size_t corner = 0; corner < normals.size(); ++corner) {
    const std::size_t own = corner / 3;
    const auto vertex = std::size_t(triangles[own][corner % 3]);
    Vec3d sum(0, 0, 0);
    for (int n = around.first[vertex]; n < around.first[vertex + 1]; ++n) {
      const auto other = std::size_t(around.corners[std::size_t(n)]) / 3;
      if (areas[own].dot(areas[other]) >= least_cosine * lengths[own] * lengths[other])
        sum += areas[other];
    }
    normals[corner] = unit_or_upwards(sum);
  }
  return normals;
}

}  // namespace supple
