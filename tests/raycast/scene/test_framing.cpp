// Framing: points fill the picture, whatever the camera; turntables; magnification.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "raycast/scene/framing.h"

namespace supple {
namespace {

std::vector<Vec3d> cloud(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> across(-60, 80), height(10, 45);
  std::vector<Vec3d> points(40);
  for (Vec3d& point : points) point = {across(random), 0.4 * across(random), height(random)};
  return points;
}

std::vector<Camera> cameras_of_all_kinds() {
  std::vector<Camera> cameras;
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    for (const Vec3d& from : {Vec3d(0, -1, 0), {1, 0.3, 0.2}, {-0.4, 0.5, 0.9}, {0, 0, 1}}) {
      Camera camera;
      camera.projection = projection;
      camera.position_lps_mm = from * 300.0 + Vec3d(5, 6, 7);
      camera.target_lps_mm = {5, 6, 7};
      camera.up_lps = from.z == 1 ? Vec3d(0, -1, 0) : Vec3d(0.1, 0, 1);
      camera.vertical_fov_degrees = 40;
      cameras.push_back(camera);
    }
  }
  return cameras;
}

/// Box of points in a picture of 1 by 1.
struct SeenBox {
  double left = 1e9, right = -1e9, top = 1e9, bottom = -1e9;

  SeenBox(const Camera& camera, double aspect, const std::vector<Vec3d>& points) {
    const int height = 1000, width = int(height * aspect);
    for (const Vec3d& point : points) {
      double x = 0, y = 0;
      EXPECT_TRUE(project_to_pixel(camera, width, height, point, x, y));
      left = std::min(left, x / width);
      right = std::max(right, x / width);
      top = std::min(top, y / height);
      bottom = std::max(bottom, y / height);
    }
  }
};

TEST(PropertyFraming, PointsTouchTwoOppositeMarginsAndStayWithinTheOthers) {
  for (const Camera& camera : cameras_of_all_kinds()) {
    for (const double aspect : {0.5, 1.0, 2.0}) {
      const std::vector<Vec3d> points = cloud(7);
      const Camera framing = framed(camera, aspect, points);
      EXPECT_NO_THROW(framing.validate(""));
      const SeenBox seen(framing, aspect, points);
      for (const double margin : {seen.left, 1 - seen.right, seen.top, 1 - seen.bottom}) {
        EXPECT_GE(margin, 0.05 - 1e-9);
      }
      const bool fills_width = seen.left < 0.05 + 1e-9 && seen.right > 0.95 - 1e-9;
      const bool fills_height = seen.top < 0.05 + 1e-9 && seen.bottom > 0.95 - 1e-9;
      EXPECT_TRUE(fills_width || fills_height)
          << seen.left << " " << seen.right << " " << seen.top << " " << seen.bottom;
    }
  }
}

/// The side that binds is reached exactly, and what is free beside it is shared evenly.
TEST(PropertyFraming, EverySideKeepsItsOwnMargin) {
  const FramingMargins margins{0.04, 0.3, 0.1, 0.2};
  for (const Camera& camera : cameras_of_all_kinds()) {
    for (const double aspect : {0.5, 1.0, 2.0}) {
      const std::vector<Vec3d> points = cloud(7);
      const SeenBox seen(framed(camera, aspect, points, CameraMotion::still, margins), aspect,
                         points);
      const double left = seen.left - margins.left, right = 1 - seen.right - margins.right;
      const double top = seen.top - margins.top, bottom = 1 - seen.bottom - margins.bottom;
      for (const double spare : {left, right, top, bottom}) EXPECT_GE(spare, -1e-9);
      EXPECT_LT(std::min(left + right, top + bottom), 1e-9) << left << " " << top;
      if (camera.projection == Projection::perspective) continue;
      EXPECT_NEAR(left, right, 1e-9);
      EXPECT_NEAR(top, bottom, 1e-9);
    }
  }
}

TEST(PropertyFraming, DirectionAndAngleStay) {
  for (const Camera& camera : cameras_of_all_kinds()) {
    const Camera framing = framed(camera, 1, cloud(3));
    const CameraFrame a = camera_frame(camera), b = camera_frame(framing);
    EXPECT_LT((a.forward - b.forward).length() + (a.up - b.up).length(), 1e-9);
    EXPECT_EQ(framing.vertical_fov_degrees, camera.vertical_fov_degrees);
  }
}

TEST(PropertyFraming, ABoxFramedIsTheDefaultCamera) {
  const Geometry geometry({40, 30, 20}, {7, -3, 100}, {Vec3d(0.9, 0, 0), {0, 1.1, 0}, {0, 0, 2.5}});
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    for (const std::string& view : view_names()) {
      const Camera expected = default_camera(geometry, 1.5, view, projection);
      const Camera framing = framed(expected, 1.5, box_corners_lps_mm(geometry));
      const SeenBox a(expected, 1.5, box_corners_lps_mm(geometry));
      const SeenBox b(framing, 1.5, box_corners_lps_mm(geometry));
      EXPECT_NEAR(a.left, b.left, 1e-9) << view;
      EXPECT_NEAR(a.top, b.top, 1e-9) << view;
    }
  }
}

TEST(PropertyFraming, ATurntableKeepsEveryPointInEveryPicture) {
  for (Camera camera : cameras_of_all_kinds()) {
    if (camera.up_lps.z > 0) camera.up_lps = {0, 0, 1};
    const std::vector<Vec3d> points = cloud(11);
    const Camera framing = framed(camera, 1, points, CameraMotion::turntable);
    double fullest = 1;
    for (int n = 0; n < 48; ++n) {
      const SeenBox seen(turned_about_target(framing, n / 48.0), 1, points);
      const double margin = std::min({seen.left, 1 - seen.right, seen.top, 1 - seen.bottom});
      EXPECT_GT(margin, 0.05 - 1e-9);
      fullest = std::min(fullest, margin);
    }
    EXPECT_LT(fullest, 0.1);
  }
}

TEST(UnitFraming, NothingToFrameLeavesTheCamera) {
  const Camera camera = cameras_of_all_kinds().front();
  EXPECT_EQ(framed(camera, 1, {}).position_lps_mm, camera.position_lps_mm);
  EXPECT_NO_THROW(framed(camera, 1, {Vec3d(1, 2, 3)}).validate(""));
}

TEST(PropertyFraming, ZoomMagnifiesAboutTheMiddleOfThePicture) {
  for (const Camera& camera : cameras_of_all_kinds()) {
    const Camera framing = framed(camera, 1, cloud(5)), near = zoomed(framing, 2.5);
    for (const Vec3d& point : cloud(5)) {
      double x = 0, y = 0, near_x = 0, near_y = 0;
      project_to_pixel(framing, 200, 200, point, x, y);
      project_to_pixel(near, 200, 200, point, near_x, near_y);
      EXPECT_NEAR(near_x - 100, 2.5 * (x - 100), 1e-9);
      EXPECT_NEAR(near_y - 100, 2.5 * (y - 100), 1e-9);
    }
  }
}

}  // namespace
}  // namespace supple
