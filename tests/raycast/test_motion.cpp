// Motion on the screen against shifts and cameras whose motion is known, and cameras on paths.
#include <cmath>

#include <gtest/gtest.h>

#include "raycast/motion.h"
#include "raycast/scene/camera.h"
#include "raycast/scene/framing.h"
#include "tests/raycast/scenes.h"

namespace supple {
namespace {

constexpr int kBallSize = 40, kMotionPixels = 48;
constexpr double kBallSpacing = 1.5;

DensityGrid solid_ball(const Geometry& geometry) {
  return grid_of(voxels_of(geometry.dims(), everywhere), [&](const Vec3d& index) {
    return std::clamp(500 + 200 * (20 - geometry.world_from_index(index).length()), 0.0, 1000.0);
  });
}

TransferFunction opaque_wall() {
  TransferFunction f;
  f.opacity = {{499, 0}, {501, 1}};
  f.colour = {{0, {0.9, 0.7, 0.5}}};
  return f;
}

RenderSettings with_surfaces() {
  RenderSettings settings = small_picture(kMotionPixels, 0.25);
  settings.auxiliary = true;
  settings.tells_surfaces = true;
  return settings;
}

/// u everywhere the same, in voxels.
Displacement shifted(const Geometry& geometry, const BrickTopology& bricks, const Vec3f& u) {
  Displacement displacement{geometry, {bricks, {}}};
  displacement.u.vectors = vectors_of(bricks, u);
  return displacement;
}

struct BallPicture {
  Geometry geometry = cube_geometry(kBallSize, kBallSpacing);
  DensityGrid density = solid_ball(geometry);
  Camera camera = default_camera(geometry, 1, "left");
  FloatImage picture;

  BallPicture() {
    picture = Renderer(geometry, density).render_float(camera, opaque_wall(), with_surfaces());
  }
  Vec3d place(std::size_t n) const {
    const Ray ray = camera_ray(camera, kMotionPixels, kMotionPixels,
                               double(n % kMotionPixels) + 0.5, double(n / kMotionPixels) + 0.5);
    const double along = ray.direction_lps.dot(camera_frame(camera).forward);
    return ray.origin_lps_mm + ray.direction_lps * (double(picture.depth_mm[n]) / along);
  }
  /// Against the pixels to which a known motion takes what is seen.
  template <class Move>
  void expect_motion(const std::vector<float>& motion, const Camera& then, const Move& move) const {
    int seen = 0;
    for (std::size_t n = 0; n < picture.pixel_count(); ++n) {
      if (std::isnan(picture.depth_mm[n])) {
        EXPECT_EQ(motion[2 * n], 0) << n;
        continue;
      }
      ++seen;
      double x = 0, y = 0;
      ASSERT_TRUE(project_to_pixel(then, kMotionPixels, kMotionPixels, move(place(n)), x, y));
      EXPECT_NEAR(motion[2 * n], x - (double(n % kMotionPixels) + 0.5), 1e-3) << n;
      EXPECT_NEAR(motion[2 * n + 1], double(n / kMotionPixels) + 0.5 - y, 1e-3) << n;
    }
    EXPECT_GT(seen, 300);
  }
};

TEST(UnitMotion, AShiftMovesEveryPixelByItsProjection) {
  const BallPicture ball;
  const auto places = rest_places(ball.picture, ball.camera, ball.geometry, nullptr);
  const Displacement moved = shifted(ball.geometry, ball.density.bricks(), {1, -2, 0.5f});
  const auto motion = screen_motion(ball.picture, places, ball.geometry, {ball.camera, nullptr},
                                    {ball.camera, &moved});
  ball.expect_motion(motion, ball.camera, [&](const Vec3d& x) {
    return x + ball.geometry.world_vector_from_index({1, -2, 0.5});
  });
  // Seen from the left, the patient's anterior is on the picture's left and superior is up.
  const std::size_t middle = std::size_t(kMotionPixels) * kMotionPixels / 2 + kMotionPixels / 2;
  EXPECT_LT(motion[2 * middle], 0);
  EXPECT_GT(motion[2 * middle + 1], 0);
}

TEST(UnitMotion, ACameraThatTurnsMovesWhatRests) {
  const BallPicture ball;
  const Displacement still = shifted(ball.geometry, ball.density.bricks(), {3, 1, -2});
  const auto places = rest_places(ball.picture, ball.camera, ball.geometry, nullptr);
  const Camera then = turned_about_target(ball.camera, 3.0 / 360);
  const auto motion =
      screen_motion(ball.picture, places, ball.geometry, {ball.camera, &still}, {then, &still});
  ball.expect_motion(motion, then, [](const Vec3d& x) { return x; });
}

TEST(UnitMotion, WhatRestsUnderAStillCameraHasExactlyNone) {
  const BallPicture ball;
  const Displacement still = shifted(ball.geometry, ball.density.bricks(), {0.3f, 0.1f, -0.2f});
  const auto places = rest_places(ball.picture, ball.camera, ball.geometry, nullptr);
  for (const float pixels : screen_motion(ball.picture, places, ball.geometry,
                                          {ball.camera, &still}, {ball.camera, &still})) {
    EXPECT_EQ(pixels, 0);
  }
}

TEST(UnitMotion, ASurfaceThatDoesNotDeformMovesWithTheCameraAlone) {
  const BallPicture ball;
  Surface wall;
  wall.mesh.vertices_lps_mm = {{26, -90, -90}, {26, 90, -90}, {26, 90, 90}, {26, -90, 90}};
  wall.mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  Renderer renderer(ball.geometry, ball.density);
  renderer.set_surfaces({wall});
  const FloatImage picture = renderer.render_float(ball.camera, opaque_wall(), with_surfaces());
  const Displacement moved = shifted(ball.geometry, ball.density.bricks(), {1, -2, 0.5f});
  const auto places = rest_places(picture, ball.camera, ball.geometry, nullptr);
  const auto motion = screen_motion(picture, places, ball.geometry, {ball.camera, nullptr},
                                    {ball.camera, &moved}, [](int) { return false; });
  const std::size_t middle = std::size_t(kMotionPixels) * kMotionPixels / 2 + kMotionPixels / 2;
  EXPECT_EQ(picture.surface[middle], 0);
  for (const float pixels : motion) EXPECT_EQ(pixels, 0);
}

TEST(UnitCameraPath, ItIsAtItsKeysAndBetweenThemOnAnArc) {
  const Geometry geometry = cube_geometry(kBallSize, kBallSpacing);
  const Camera left = default_camera(geometry, 1, "left");
  const Camera front = default_camera(geometry, 1, "anterior");
  CameraPath path;
  path.add_place(0, front, Easing::linear);
  path.add_place(2, left, Easing::linear);
  Camera rolled = left;
  rolled.up_lps = {0, 0.4, 1};
  path.add_place(3, rolled, Easing::linear);
  for (const auto& [time, expected] :
       {std::pair(0.0, front), std::pair(2.0, left), std::pair(3.0, rolled)}) {
    const Camera at = path.at(Camera(), time);
    EXPECT_LT((at.position_lps_mm - expected.position_lps_mm).length(), 1e-9);
    EXPECT_LT((camera_frame(at).up - camera_frame(expected).up).length(), 1e-12);
  }
  const Camera half = path.at(Camera(), 1);
  const Vec3d eye = half.position_lps_mm - half.target_lps_mm;
  EXPECT_NEAR(eye.length(), (front.position_lps_mm - front.target_lps_mm).length(), 1e-9);
  EXPECT_LT((eye.normalized() - Vec3d(1, -1, 0).normalized()).length(), 1e-12);
}

TEST(UnitCameraPath, TurnAndZoomComeOnTopOfThePlace) {
  const Camera start = default_camera(cube_geometry(kBallSize, kBallSpacing), 1);
  CameraPath path;
  path.add_turn(0, 0, Easing::linear);
  path.add_turn(4, 360, Easing::linear);
  path.add_zoom(0, 1, Easing::linear);
  path.add_zoom(4, 4, Easing::linear);
  const Camera at = path.at(start, 2), expected = zoomed(turned_about_target(start, 0.5), 2);
  EXPECT_LT((at.position_lps_mm - expected.position_lps_mm).length(), 1e-9);
  EXPECT_NEAR(at.vertical_fov_degrees, expected.vertical_fov_degrees, 1e-12);
  EXPECT_EQ(path.at(start, -1).position_lps_mm, start.position_lps_mm);
}

}  // namespace
}  // namespace supple
