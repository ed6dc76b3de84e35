// The silhouette of a body: that of a ball and of a box, in perspective and parallel rays.
#include <cmath>

#include <gtest/gtest.h>

#include "raycast/drawings/rest_outline.h"
#include "volumes/grid/voxel_sets.h"

using namespace supple;

namespace {

/// Voxels of 1 mm about the origin of space.
Geometry centred(int n) {
  const double lo = -(n - 1) / 2.0;
  return Geometry({n, n, n}, {lo, lo, lo}, {Vec3d(1, 0, 0), {0, 1, 0}, {0, 0, 1}});
}

BrickTopology ball(int n, double radius) {
  std::vector<Vec3i> voxels;
  for (int k = 0; k < n; ++k) {
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        const Vec3d at = Vec3d(i, j, k) - Vec3d((n - 1) / 2.0);
        if (at.length() <= radius) voxels.push_back({i, j, k});
      }
    }
  }
  return topology_of(voxels);
}

Camera parallel(double height_mm) {
  Camera camera;
  camera.projection = Projection::orthographic;
  camera.position_lps_mm = {0, -200, 0};
  camera.height_mm = height_mm;
  return camera;
}

std::size_t covered(const std::vector<std::uint8_t>& mask) {
  return std::size_t(std::count(mask.begin(), mask.end(), 1));
}

}  // namespace

TEST(UnitRestOutline, ABallCoversADiscOfItsSize) {
  const RestOutline outline(ball(48, 20), centred(48));
  for (const bool is_perspective : {false, true}) {
    Camera camera = parallel(60);
    double radius = 20.6 * 120 / 60;  // a voxel's half diagonal, in part, beyond the centres
    if (is_perspective) {
      camera.projection = Projection::perspective;
      camera.vertical_fov_degrees = 20;
      // The cone that touches a ball.
      const double angle = std::asin(20.6 / 200);
      radius = std::tan(angle) / std::tan(10 * M_PI / 180) * 60;
    }
    const double area = double(covered(outline.mask(camera, 160, 120)));
    EXPECT_NEAR(std::sqrt(area / M_PI), radius, 0.02 * radius) << is_perspective;
  }
}

TEST(UnitRestOutline, TheLineIsTheRimAndNothingElseIsTouched) {
  const RestOutline outline(ball(48, 20), centred(48));
  FloatImage picture(120, 120);
  std::fill(picture.rgba.begin(), picture.rgba.end(), 0.5f);
  outline.draw(picture, parallel(60));
  const auto mask = outline.mask(parallel(60), 120, 120);
  int drawn = 0;
  for (int y = 1; y < 119; ++y) {
    for (int x = 1; x < 119; ++x) {
      const std::size_t n = std::size_t(y) * 120 + std::size_t(x);
      const bool is_rim =
          mask[n] == 1 && !(mask[n - 1] && mask[n + 1] && mask[n - 120] && mask[n + 120]);
      EXPECT_EQ(picture.rgba[4 * n + 3], is_rim ? 1 : 0.5f) << x << ' ' << y;
      EXPECT_EQ(picture.rgba[4 * n], is_rim ? 1 : 0.5f);
      EXPECT_EQ(picture.rgba[4 * n + 2], is_rim ? 0 : 0.5f);
      drawn += is_rim;
    }
  }
  EXPECT_GT(drawn, 200);
}

/// A plate one voxel thick is closed when it is seen from in front, near to the camera too.
TEST(UnitRestOutline, SurfacesHaveNoHoles) {
  std::vector<Vec3i> voxels;
  for (int k = 4; k < 28; ++k) {
    for (int i = 4; i < 28; ++i) voxels.push_back({i, 16, k});
  }
  const RestOutline outline(topology_of(voxels), centred(32));
  const double per_mm = 400 / 40.0;
  const auto mask = outline.mask(parallel(40), 400, 400);
  const int lo = int(200 - 11.4 * per_mm), hi = int(200 + 11.4 * per_mm);
  for (int y = lo; y <= hi; ++y) {
    for (int x = lo; x <= hi; ++x) ASSERT_EQ(mask[std::size_t(y) * 400 + std::size_t(x)], 1);
  }
  EXPECT_NEAR(double(covered(mask)), 240 * 240, 0.06 * 240 * 240);
}

TEST(UnitRestOutline, WhatIsBehindTheCameraIsNotDrawn) {
  const RestOutline outline(ball(48, 20), centred(48));
  Camera camera = parallel(60);
  camera.target_lps_mm = {0, -300, 0};
  EXPECT_EQ(covered(outline.mask(camera, 50, 50)), 0u);
}
