#include "raycast/scene/surface.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "volumes/base/error.h"

namespace supple {

namespace {

constexpr double kCreaseCosine = 0.6427876096865394;  // 50 degrees
constexpr double kLeastSine = 1e-9;                   // of a triangle that has an area
constexpr int kMostAround = 256;                      // corners at a place; more stay flat

struct SurfaceFace {
  Vec3d normal{0, 0, 0};  // unit; 0: no area
  std::array<double, 3> angles{};
};

SurfaceFace face_of(const TriangleMesh& mesh, const std::array<int, 3>& triangle) {
  std::array<Vec3d, 3> p, along;
  for (int c = 0; c < 3; ++c) p[c] = mesh.vertices_lps_mm[triangle[c]];
  double longest = 0;
  for (int c = 0; c < 3; ++c) {
    along[c] = p[(c + 1) % 3] - p[c];
    longest = std::max(longest, along[c].length());
  }
  SurfaceFace face;
  const Vec3d normal = along[0].cross(p[2] - p[0]);
  if (!(normal.length() > kLeastSine * longest * longest)) return face;
  face.normal = normal.normalized();
  for (int c = 0; c < 3; ++c) {
    const Vec3d out = along[c], back = -along[(c + 2) % 3];
    face.angles[c] = std::atan2(out.cross(back).length(), out.dot(back));
  }
  return face;
}

/// Gives each vertex a number that it shares with all others at its place.
std::vector<int> places_of(const std::vector<Vec3d>& vertices) {
  std::vector<int> order(vertices.size());
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&](int n) {
    return std::make_tuple(vertices[n].x, vertices[n].y, vertices[n].z);
  };
  std::sort(order.begin(), order.end(), [&](int a, int b) { return key(a) < key(b); });
  std::vector<int> places(vertices.size());
  int place = 0;
  for (std::size_t n = 0; n < order.size(); ++n) {
    if (n > 0 && key(order[n - 1]) != key(order[n])) ++place;
    places[order[n]] = place;
  }
  return places;
}

/// Corners 3 * triangle + corner, sorted by their places, with the first of each place.
struct CornersOfPlaces {
  std::vector<int> corners, first;
};

CornersOfPlaces corners_of_places(const TriangleMesh& mesh, const std::vector<int>& places) {
  CornersOfPlaces result;
  const int count = places.empty() ? 0 : *std::max_element(places.begin(), places.end()) + 1;
  result.first.assign(count + 1, 0);
  for (const auto& triangle : mesh.triangles) {
    for (const int vertex : triangle) ++result.first[places[vertex] + 1];
  }
  std::partial_sum(result.first.begin(), result.first.end(), result.first.begin());
  result.corners.resize(3 * mesh.triangles.size());
  std::vector<int> next = result.first;
  for (std::size_t n = 0; n < result.corners.size(); ++n) {
    result.corners[next[places[mesh.triangles[n / 3][n % 3]]]++] = int(n);
  }
  return result;
}

}  // namespace

void Surface::validate(const std::string& file) const {
  const auto check_unit = [&](const char* field, double value) {
    if (value >= 0 && value <= 1) return;
    throw InputError({file, field, number_text(value), "a value between 0 and 1"});
  };
  for (const double channel : rgb) check_unit("colour", channel);
  check_unit("opacity", opacity);
  for (const Vec3d& v : mesh.vertices_lps_mm) {
    if (std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z)) continue;
    throw InputError({file, "mesh", "a vertex that is not finite", "finite coordinates"});
  }
  const int vertex_count = int(mesh.vertices_lps_mm.size());
  bool has_area = false;
  for (const auto& triangle : mesh.triangles) {
    for (const int vertex : triangle) {
      if (vertex >= 0 && vertex < vertex_count) continue;
      throw InputError({file, "mesh", "vertex " + std::to_string(vertex),
                        "0 to " + std::to_string(vertex_count - 1)});
    }
    has_area = has_area || face_of(mesh, triangle).normal != Vec3d(0);
  }
  if (has_area) return;
  throw InputError({file, "mesh", std::to_string(mesh.triangles.size()) + " triangles without area",
                    "at least one with an area"});
}

std::vector<SurfaceTriangle> surface_triangles(const TriangleMesh& mesh) {
  std::vector<SurfaceFace> faces;
  faces.reserve(mesh.triangles.size());
  for (const auto& triangle : mesh.triangles) faces.push_back(face_of(mesh, triangle));
  const std::vector<int> places = places_of(mesh.vertices_lps_mm);
  const CornersOfPlaces around = corners_of_places(mesh, places);

  const auto corner_normal = [&](int vertex, const Vec3d& own) {
    const int first = around.first[places[vertex]], end = around.first[places[vertex] + 1];
    if (end - first > kMostAround) return Vec3f(own);
    Vec3d sum(0);
    for (int n = first; n < end; ++n) {
      const int corner = around.corners[n];
      const SurfaceFace& face = faces[corner / 3];
      if (face.normal.dot(own) >= kCreaseCosine) sum += face.normal * face.angles[corner % 3];
    }
    return Vec3f(sum.normalized());
  };
  std::vector<SurfaceTriangle> triangles;
  for (std::size_t t = 0; t < faces.size(); ++t) {
    const Vec3d& normal = faces[t].normal;
    if (normal == Vec3d(0)) continue;
    const std::array<int, 3>& v = mesh.triangles[t];
    triangles.push_back(
        {v,
         {corner_normal(v[0], normal), corner_normal(v[1], normal), corner_normal(v[2], normal)},
         Vec3f(normal)});
  }
  return triangles;
}

}  // namespace supple
