// Surfaces of drawn curves, against the curve.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "lib/body/swept_surface.h"
#include "tests/support/errors.h"

using namespace supple;
using namespace supple::test;

namespace {

/// An arc of 120 degrees around the z axis, radius 20, seven points.
SweptCurve arc() {
  SweptCurve curve;
  for (int n = -3; n <= 3; ++n) {
    const double angle = n * 20 * M_PI / 180;
    curve.points_lps_mm.push_back({20 * std::cos(angle), 20 * std::sin(angle), 5});
  }
  curve.direction = {0, 0, -3};
  curve.depth_mm = 7;
  curve.above_mm = 2;
  return curve;
}

}  // namespace

TEST(UnitSweptSurface, ASplineGoesThroughItsPointsAndStaysOnTheArcBetween) {
  const SweptCurve curve = arc();
  const TriangleMesh mesh = swept_surface(curve);
  for (const Vec3d& vertex : mesh.vertices_lps_mm) {
    EXPECT_NEAR(std::hypot(vertex.x, vertex.y), 20, 0.2);
    EXPECT_TRUE(vertex.z == 7 || vertex.z == -2) << vertex.z;
  }
  for (const Vec3d& point : curve.points_lps_mm) {
    const Vec3d top = point + Vec3d(0, 0, 2);
    EXPECT_TRUE(std::any_of(mesh.vertices_lps_mm.begin(), mesh.vertices_lps_mm.end(),
                            [&](const Vec3d& v) { return (v - top).length() < 1e-9; }))
        << point;
  }
}

TEST(UnitSweptSurface, ItsAreaIsTheLengthOfTheCurveTimesItsHeight) {
  for (const bool is_smooth : {true, false}) {
    SweptCurve curve = arc();
    curve.is_smooth = is_smooth;
    const TriangleMesh mesh = swept_surface(curve);
    double area = 0;
    for (const auto& [a, b, c] : mesh.triangles) {
      const auto& v = mesh.vertices_lps_mm;
      area += (v[std::size_t(b)] - v[std::size_t(a)])
                  .cross(v[std::size_t(c)] - v[std::size_t(a)])
                  .length() /
              2;
    }
    const double chords = 6 * 2 * 20 * std::sin(10 * M_PI / 180), length = 20 * 2 * M_PI / 3;
    EXPECT_NEAR(area, 9 * (is_smooth ? length : chords), is_smooth ? 1.5 : 1e-9);
  }
}

TEST(UnitSweptSurface, ACurveWithoutWidthIsRefused) {
  SweptCurve curve = arc();
  curve.points_lps_mm = {{1, 2, 3}, {1, 2, 3}};
  EXPECT_NE(input_error([&] { swept_surface(curve); }).find("two different points"),
            std::string::npos);
  curve.points_lps_mm = {{1, 2, 3}, {1, 2, 9}};
  EXPECT_NE(input_error([&] { swept_surface(curve); }).find("one across it"), std::string::npos);
}
