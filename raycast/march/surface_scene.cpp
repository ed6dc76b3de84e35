#include "raycast/march/surface_scene.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "raycast/march/embree_scene.h"

namespace supple {

namespace {

constexpr std::size_t kEmbreeBytesPerTriangle = 80;

/// Start and results of one traversal; Embree hands the context to the callback.
struct HitContext {
  RTCIntersectContext base;
  double start;
  std::vector<TriangleHit>* out;
};

/// Notes the hit and rejects it, so that the traversal goes on to the end.
void note_hit(const RTCFilterFunctionNArguments* args) {
  if (args->valid[0] == 0) return;
  auto* context = reinterpret_cast<HitContext*>(args->context);
  const auto* ray = reinterpret_cast<const RTCRay*>(args->ray);
  const auto* hit = reinterpret_cast<const RTCHit*>(args->hit);
  context->out->push_back({context->start + ray->tfar, int(hit->primID), hit->u, hit->v});
  args->valid[0] = 0;
}

}  // namespace

struct TriangleTree::Impl {
  EmbreeScene scene{RTC_GEOMETRY_TYPE_TRIANGLE};
  Vec3d centre{0, 0, 0};  // origin of Embree's single precision
  double radius_mm = 0;
  std::size_t triangle_count = 0;
};

TriangleTree::TriangleTree(const std::vector<Vec3d>& vertices,
                           const std::vector<std::array<int, 3>>& triangles)
    : m_impl(std::make_unique<Impl>()) {
  Vec3d lo(HUGE_VAL), hi(-HUGE_VAL);
  for (const auto& triangle : triangles) {
    for (const int vertex : triangle) {
      for (int a = 0; a < 3; ++a) {
        lo[a] = std::min(lo[a], vertices[vertex][a]);
        hi[a] = std::max(hi[a], vertices[vertex][a]);
      }
    }
  }
  m_impl->triangle_count = triangles.size();
  if (triangles.empty()) return;
  m_impl->centre = (lo + hi) / 2;
  m_impl->radius_mm = (hi - lo).length() / 2;

  RTCGeometry geometry = m_impl->scene.geometry();
  auto* points = static_cast<float*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), vertices.size()));
  auto* indices = static_cast<unsigned*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                              3 * sizeof(unsigned), triangles.size()));
  if (points == nullptr || indices == nullptr) throw std::bad_alloc();
  for (const Vec3d& vertex : vertices) {
    for (int a = 0; a < 3; ++a) *points++ = float(vertex[a] - m_impl->centre[a]);
  }
  for (const auto& triangle : triangles) indices = std::copy_n(triangle.begin(), 3, indices);
  rtcSetGeometryIntersectFilterFunction(geometry, note_hit);
  m_impl->scene.build(RTC_BUILD_QUALITY_MEDIUM);
}

TriangleTree::~TriangleTree() = default;

void TriangleTree::hits(const Ray& ray, Interval within, std::vector<TriangleHit>& out) const {
  out.clear();
  if (m_impl->triangle_count == 0) return;
  // The part of the ray in the sphere around all triangles: short rays keep Embree exact.
  const Vec3d origin = ray.origin_lps_mm - m_impl->centre;
  const double nearest = -origin.dot(ray.direction_lps), reach = m_impl->radius_mm * 1.001;
  const double squared = reach * reach - (origin + ray.direction_lps * nearest).length2();
  if (squared < 0) return;
  within.begin = std::max(within.begin, nearest - std::sqrt(squared));
  within.end = std::min(within.end, nearest + std::sqrt(squared));
  if (!(within.begin <= within.end)) return;

  HitContext context;
  rtcInitIntersectContext(&context.base);
  context.start = within.begin;
  context.out = &out;
  const Vec3f start(origin + ray.direction_lps * within.begin), direction(ray.direction_lps);
  m_impl->scene.traverse(&context.base, start.getValue(), direction.getValue(),
                         float(within.end - within.begin));
  std::sort(out.begin(), out.end(), [](const TriangleHit& a, const TriangleHit& b) {
    return std::tie(a.t, a.triangle) < std::tie(b.t, b.triangle);
  });
}

double TriangleTree::radius_mm() const {
  return m_impl->radius_mm;
}

std::size_t TriangleTree::bytes() const {
  return m_impl->triangle_count * (kEmbreeBytesPerTriangle + 6 * sizeof(float));
}

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
