// Stereo pairs: what lies where for both eyes, and their colours through red and cyan.
#include <cmath>

#include <gtest/gtest.h>

#include "raycast/scene/stereo.h"
#include "volumes/base/error.h"

namespace supple {
namespace {

constexpr int kWidth = 300, kHeight = 200;

Camera oblique_camera() {
  Camera camera;
  camera.position_lps_mm = {120, -310, 80};
  camera.target_lps_mm = {4, -7, 11};
  camera.up_lps = {0.1, 0, 1};
  return camera;
}

struct Pixel {
  double x = 0, y = 0;
};
Pixel pixel_of(const Camera& camera, const Vec3d& place) {
  Pixel p;
  EXPECT_TRUE(project_to_pixel(camera, kWidth, kHeight, place, p.x, p.y));
  return p;
}

TEST(PropertyStereo, DisparityIsHorizontalAndNoneInThePlaneOfTheTarget) {
  const Camera camera = oblique_camera();
  const CameraFrame frame = camera_frame(camera);
  const StereoCameras eyes = stereo_cameras(camera, 60);
  for (const double nearer_mm : {-80.0, 0.0, 90.0}) {
    for (const auto& [right, up] : {std::pair(0.0, 0.0), {70.0, 40.0}, {-55.0, 62.0}}) {
      const Vec3d place =
          camera.target_lps_mm + frame.right * right + frame.up * up - frame.forward * nearer_mm;
      const Pixel left_eye = pixel_of(eyes.left, place), right_eye = pixel_of(eyes.right, place);
      EXPECT_NEAR(left_eye.y, right_eye.y, 1e-9);
      // Similar triangles give the distance; eyes cross for what lies in front of the window.
      const double distance = (camera.target_lps_mm - camera.position_lps_mm).length();
      const double pixels_per_mm = kHeight / 2 / (distance * std::tan(15 * M_PI / 180));
      EXPECT_NEAR(left_eye.x - right_eye.x, 60 * nearer_mm / (distance - nearer_mm) * pixels_per_mm,
                  1e-9);
      const Pixel middle = pixel_of(camera, place);
      EXPECT_NEAR(left_eye.x + right_eye.x, 2 * middle.x, 1e-9);
    }
  }
}

TEST(PropertyStereo, RaysOfAShiftedWindowInvertItsProjection) {
  const Camera eye = stereo_cameras(oblique_camera(), 45).left;
  const Ray ray = camera_ray(eye, kWidth, kHeight, 31.5, 171.25);
  const Pixel back = pixel_of(eye, ray.origin_lps_mm + ray.direction_lps * 200.0);
  EXPECT_NEAR(back.x, 31.5, 1e-9);
  EXPECT_NEAR(back.y, 171.25, 1e-9);
}

TEST(UnitStereo, TheEyesAreAsFarApartAsAskedFor) {
  const Camera camera = oblique_camera();
  const auto apart = [&](double asked) {
    const StereoCameras eyes = stereo_cameras(camera, asked);
    EXPECT_GT(
        (eyes.right.position_lps_mm - eyes.left.position_lps_mm).dot(camera_frame(camera).right),
        0);
    return (eyes.right.position_lps_mm - eyes.left.position_lps_mm).length();
  };
  EXPECT_NEAR(apart(65), 65, 1e-9);
  EXPECT_NEAR(apart(0), (camera.target_lps_mm - camera.position_lps_mm).length() / 30, 1e-9);
  EXPECT_THROW(stereo_cameras(camera, -1), InputError);
  EXPECT_THROW(stereo_cameras(camera, NAN), InputError);
  Camera parallel = camera;
  parallel.projection = Projection::orthographic;
  EXPECT_THROW(stereo_cameras(parallel, 65), InputError);
}

FloatImage grey_pixel(float value) {
  FloatImage picture(1, 1);
  picture.rgba = {value, value, value, 1};
  return picture;
}

TEST(UnitStereo, EqualGreysStayGreyAndEachEyeHasItsColour) {
  for (const float value : {0.0f, 0.3f, 0.75f, 1.0f}) {
    const FloatImage both = anaglyph(grey_pixel(value), grey_pixel(value));
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(both.rgba[c], value, 2e-3);
    EXPECT_EQ(both.rgba[3], 1);
    EXPECT_FALSE(both.has_alpha);
  }
  const FloatImage left = anaglyph(grey_pixel(1), grey_pixel(0)),
                   right = anaglyph(grey_pixel(0), grey_pixel(1));
  EXPECT_GT(left.rgba[0], 0.99);
  EXPECT_EQ(left.rgba[1], 0);
  EXPECT_EQ(left.rgba[2], 0);
  EXPECT_EQ(right.rgba[0], 0);
  EXPECT_GT(right.rgba[1], 0.99);
  EXPECT_GT(right.rgba[2], 0.99);
}

}  // namespace
}  // namespace supple
