#include "raycast/march/surface_scene.h"

#include <algorithm>
#include <cmath>

namespace supple {

namespace {

/// A share of the scene's radius: crossings nearer to each other than this may be one, of an edge;
/// light paths begin twice as far from a surface. Single precision leaves 1e-7.
constexpr double kTouching = 1e-5;

}  // namespace

SurfaceScene::SurfaceScene(const std::vector<Surface>& surfaces) {
  std::vector<std::array<int, 3>> corners;
  for (const Surface& surface : surfaces) {
    const int first = int(m_vertices.size());
    const auto& vertices = surface.mesh.vertices_lps_mm;
    m_vertices.insert(m_vertices.end(), vertices.begin(), vertices.end());
    for (SurfaceTriangle& triangle : surface_triangles(surface.mesh)) {
      for (int& vertex : triangle.vertices) vertex += first;
      corners.push_back(triangle.vertices);
      m_triangles.push_back({triangle, int(m_looks.size())});
    }
    m_looks.push_back(Float4{float(surface.rgb[0]), float(surface.rgb[1]), float(surface.rgb[2]),
                             float(surface.opacity)});
  }
  m_tree = std::make_unique<TriangleTree>(m_vertices, corners);
}

void SurfaceScene::crossings(const Ray& ray, Interval within, std::vector<TriangleHit>& out) const {
  m_tree->hits(ray, within, out);
  const double touching = kTouching * m_tree->radius_mm();
  const Vec3f direction(ray.direction_lps);
  const auto enters = [&](const Triangle& triangle) {
    return triangle.shape.face_normal.dot(direction) < 0;
  };
  const auto repeats = [&](const TriangleHit& a, const TriangleHit& b) {
    const Triangle &first = m_triangles[a.triangle], &second = m_triangles[b.triangle];
    return b.t - a.t <= touching && first.look == second.look && enters(first) == enters(second);
  };
  out.erase(std::unique(out.begin(), out.end(), repeats), out.end());
}

SurfacePoint SurfaceScene::point(const Ray& ray, const TriangleHit& hit) const {
  const Triangle& triangle = m_triangles[hit.triangle];
  const SurfaceTriangle& shape = triangle.shape;
  const std::array<float, 3> weights = {1 - hit.u - hit.v, hit.u, hit.v};
  const bool is_back = shape.face_normal.dot(Vec3f(ray.direction_lps)) > 0;
  const Vec3d pos = ray.origin_lps_mm + ray.direction_lps * hit.t;

  // The place goes onto the rounded surface of the normals, or facets of a round body would shade
  // each other (J. Hanika, Hacking the shadow terminator, Ray Tracing Gems II, 2021).
  Vec3d normal(0), rounded(0);
  for (int c = 0; c < 3; ++c) {
    const Vec3d corner_normal(is_back ? -shape.normals[c] : shape.normals[c]);
    const double below = std::min(0.0, (pos - m_vertices[shape.vertices[c]]).dot(corner_normal));
    rounded += (pos - corner_normal * below) * double(weights[c]);
    normal += corner_normal * double(weights[c]);
  }
  SurfacePoint point;
  point.colour = m_looks[triangle.look];
  point.colour[3] = 1;
  point.normal = Vec3f(normal.normalized());
  point.pos_lps_mm = pos;
  const Vec3d face_normal(is_back ? -shape.face_normal : shape.face_normal);
  point.light_start = rounded + face_normal * (2 * kTouching * m_tree->radius_mm());
  return point;
}

std::size_t SurfaceScene::bytes() const {
  return m_vertices.size() * sizeof(Vec3d) + m_triangles.size() * sizeof(Triangle) +
         m_tree->bytes();
}

}  // namespace supple
