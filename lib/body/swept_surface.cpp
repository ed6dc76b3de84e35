#include "lib/body/swept_surface.h"

#include "volumes/base/error.h"

namespace supple {

namespace {

constexpr int kPiecesPerSegment = 16;

/// The points of a curve; of equal ones in a row only the first.
std::vector<Vec3d> different_points(const std::vector<Vec3d>& points) {
  std::vector<Vec3d> different;
  for (const Vec3d& point : points) {
    if (different.empty() || point != different.back()) different.push_back(point);
  }
  return different;
}

/// Samples the Catmull-Rom curve through the points, which goes on straight beyond its ends.
std::vector<Vec3d> smooth_curve(const std::vector<Vec3d>& p) {
  const std::size_t last = p.size() - 1;
  std::vector<Vec3d> curve;
  for (std::size_t n = 0; n < last; ++n) {
    const Vec3d before = n > 0 ? p[n - 1] : p[0] * 2.0 - p[1];
    const Vec3d after = n + 2 <= last ? p[n + 2] : p[last] * 2.0 - p[last - 1];
    const Vec3d slope0 = (p[n + 1] - before) * 0.5, slope1 = (after - p[n]) * 0.5;
    for (int k = 0; k < kPiecesPerSegment; ++k) {
      const double t = double(k) / kPiecesPerSegment, t2 = t * t, t3 = t2 * t;
      curve.push_back(p[n] * (2 * t3 - 3 * t2 + 1) + slope0 * (t3 - 2 * t2 + t) +
                      p[n + 1] * (3 * t2 - 2 * t3) + slope1 * (t3 - t2));
    }
  }
  curve.push_back(p[last]);
  return curve;
}

}  // namespace

TriangleMesh swept_surface(const SweptCurve& curve) {
  const std::vector<Vec3d> given = different_points(curve.points_lps_mm);
  if (given.size() < 2) {
    throw InputError({"", "points", "one place", "two different points or more"});
  }
  const Vec3d along = curve.direction.normalized();
  const std::vector<Vec3d> points = curve.is_smooth ? smooth_curve(given) : given;
  TriangleMesh mesh;
  double widest = 0;
  for (std::size_t n = 0; n < points.size(); ++n) {
    mesh.vertices_lps_mm.push_back(points[n] - along * curve.above_mm);
    mesh.vertices_lps_mm.push_back(points[n] + along * curve.depth_mm);
    if (n == 0) continue;
    widest = std::max(widest, along.cross(points[n] - points[n - 1]).length());
    const int a = 2 * int(n) - 2;
    mesh.triangles.push_back({a, a + 1, a + 2});
    mesh.triangles.push_back({a + 1, a + 3, a + 2});
  }
  if (widest < 1e-9) {
    throw InputError({"", "direction", "the direction of the curve itself", "one across it"});
  }
  return mesh;
}

}  // namespace supple
