// Where the microscope shows things: the globe's texture, instances, shadows and both eyes.
#include <random>

#include <gtest/gtest.h>

#include "raycast/scene/stereo.h"
#include "tests/raycast/microscope/microscope_scenes.h"
#include "volumes/base/error.h"
#include "volumes/base/parallel.h"

namespace supple {
namespace {

/// Columns brighten red, rows green.
GlobeLook ramp_globe(int size) {
  GlobeLook globe;
  globe.centre_mm = {0.5, -0.25, 0.75};
  globe.fundus.width = globe.fundus.height = size;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      globe.fundus.texels.push_back(
          {std::uint8_t(255 * x / (size - 1)), std::uint8_t(255 * y / (size - 1)), 60});
    }
  }
  return globe;
}

TEST(PropertyMicroscope, APixelOfTheGlobeHasTheTexelOfItsPlace) {
  const GlobeLook globe = ramp_globe(256);
  Microscope microscope;
  microscope.set_globe(globe);
  MicroscopeSettings settings = small_picture();
  settings.ambient = 1;
  const Camera camera = eye_camera(3.8);
  const Image picture = picture_by(microscope, camera, settings);
  int count = 0;
  for (int y = 3; y < settings.height; y += 9) {
    for (int x = 2; x < settings.width; x += 7) {
      const Ray ray = camera_ray(camera, settings.width, settings.height, x + 0.5, y + 0.5);
      const double t = far_side(ray, globe.centre_mm, globe.radius_mm);
      if (std::isnan(t)) continue;
      const Vec3d d =
          (ray.origin_lps_mm + ray.direction_lps * t - globe.centre_mm) / globe.radius_mm;
      const double part = std::acos(-d.z) / kPi / std::hypot(d.x, d.y) / 2;
      const double u = 0.5 + part * d.x, v = 0.5 - part * d.y;
      const auto expected = [](double share) {
        const double texel = share * 256 * 255.0 / 255 - 0.5;  // of a ramp over 256
        return byte_from_light(linear_from_srgb(float(texel / 255)));
      };
      const auto at = 4 * (std::size_t(y) * settings.width + x);
      EXPECT_NEAR(picture.rgba[at], expected(u), 2) << x << " " << y;
      EXPECT_NEAR(picture.rgba[at + 1], expected(v), 2) << x << " " << y;
      ++count;
    }
  }
  EXPECT_GT(count, 200);
}

TEST(PropertyMicroscope, AShadowIsWhereABallStandsBetweenPlaceAndLamp) {
  Microscope microscope;
  const GlobeLook globe = grey_globe();
  microscope.set_globe(globe);
  const LampLight lamp = aside_lamp();
  microscope.set_lamp(lamp);
  const Vec3d centre(0.4, -0.3, -7.5);
  const double radius = 0.8;
  RigidPlacement placement;
  placement.origin_mm = centre;
  microscope.place(microscope.add_rigid(ball_mesh(radius), {}), placement);
  MicroscopeSettings settings = small_picture();
  settings.ambient = 0;
  settings.smooth_edges = false;
  const Camera camera = eye_camera();
  const Image picture = picture_by(microscope, camera, settings);
  const Vec3d light = lamp.place_mm + lamp.direction * 0.03;
  int dark = 0, lit = 0;
  for (int y = 0; y < settings.height; ++y) {
    for (int x = 0; x < settings.width; ++x) {
      const Ray ray = camera_ray(camera, settings.width, settings.height, x + 0.5, y + 0.5);
      const Vec3d apart = ray.origin_lps_mm - centre;
      const double passes = (apart - ray.direction_lps * apart.dot(ray.direction_lps)).length();
      if (passes < radius + 0.02) continue;  // the ball itself
      const Vec3d place =
          ray.origin_lps_mm + ray.direction_lps * far_side(ray, globe.centre_mm, globe.radius_mm);
      const Vec3d way = (light - place).normalized();
      const double cosine = -way.dot(lamp.direction);
      if (!(cosine > std::cos(50 * kRadiansPerDegree))) continue;  // no light, or no globe
      const Vec3d from_place = centre - place;
      const double miss = (from_place - way * from_place.dot(way)).length();
      if (std::abs(miss - radius) < 0.02) continue;
      const bool is_dark = miss < radius;
      EXPECT_EQ(light_at(picture, x, y) < 1e-6, is_dark) << x << " " << y;
      ++(is_dark ? dark : lit);
    }
  }
  EXPECT_GT(dark, 300);
  EXPECT_GT(lit, 10000);
}

constexpr double kTipMm = 0.05;

/// The least distance in pixels between a place and what the shadow of a rigid body darkens.
double shadow_distance(const RigidPlacement& placement, const Camera& camera,
                       const MicroscopeSettings& settings, bool is_left) {
  const auto drawn = [&](bool casts, bool is_there) {
    Microscope microscope;
    microscope.set_globe(grey_globe());
    microscope.set_lamp(aside_lamp());
    SurfaceLook look;
    look.casts_shadow = casts;
    if (is_there) {
      microscope.place(microscope.add_rigid(needle_mesh(8, kTipMm, 0.3), look), placement);
    }
    const EyePair pair = pair_by(microscope, camera, 9, settings);
    return is_left ? pair.left : pair.right;
  };
  const Image with = drawn(true, true), without = drawn(false, true), bare = drawn(false, false);
  const StereoCameras eyes = stereo_cameras(camera, 9);
  double px = 0, py = 0, least = 1e9;
  project_to_pixel(is_left ? eyes.left : eyes.right, settings.width, settings.height,
                   placement.origin_mm, px, py);
  for (int y = 0; y < settings.height; ++y) {
    for (int x = 0; x < settings.width; ++x) {
      const bool is_retina = std::abs(light_at(without, x, y) - light_at(bare, x, y)) < 0.01;
      if (!is_retina || light_at(with, x, y) > 0.7 * light_at(without, x, y)) continue;
      least = std::min(least, std::hypot(x + 0.5 - px, y + 0.5 - py));
    }
  }
  return least;
}

TEST(PropertyMicroscope, ShadowAndTipMeetWithinAPixelAtContactAndPartWithDistanceInBothEyes) {
  MicroscopeSettings settings = small_picture(800, 600);
  settings.smooth_edges = false;
  const Camera camera = eye_camera();
  const double pixel_mm = 2 * 211 * half_height_at_unit_distance(camera) / settings.height;
  RigidPlacement placement;
  placement.z = Vec3d(0.6, 0.5, 1).normalized();
  placement.x = placement.z.cross(Vec3d(0, 1, 0)).normalized();
  placement.y = placement.z.cross(placement.x);
  const Vec3d touched = Vec3d(0.08, -0.06, -1).normalized() * 11.0;
  for (const bool is_left : {true, false}) {
    placement.origin_mm = touched;
    EXPECT_LT(shadow_distance(placement, camera, settings, is_left), 1 + kTipMm / pixel_mm);
    placement.origin_mm = touched * (10.0 / 11);
    EXPECT_GT(shadow_distance(placement, camera, settings, is_left), 10);
  }
}

Vec3d centre_of_dark(const Image& picture) {
  Vec3d sum(0, 0, 0);
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      if (light_at(picture, x, y) < 0.1) sum += Vec3d(x + 0.5, y + 0.5, 1);
    }
  }
  return sum / sum.z;
}

TEST(PropertyMicroscope, ABallLiesWhereBothCamerasSeeIt) {
  Microscope microscope;
  microscope.set_globe(grey_globe());
  SurfaceLook black;
  black.rgb = {0, 0, 0};
  RigidPlacement placement;
  const int ball = microscope.add_rigid(ball_mesh(0.5), black);
  MicroscopeSettings settings = small_picture(400, 300);
  settings.ambient = 1;
  const Camera camera = eye_camera();
  const StereoCameras eyes = stereo_cameras(camera, 9);
  for (const Vec3d& place : {Vec3d(0, 0, -9), Vec3d(2, -1.5, -4), Vec3d(-3, 2, -8)}) {
    placement.origin_mm = place;
    microscope.place(ball, placement);
    const EyePair pair = pair_by(microscope, camera, 9, settings);
    const auto expect_at = [&](const Image& picture, const Camera& eye) {
      double px = 0, py = 0;
      ASSERT_TRUE(project_to_pixel(eye, 400, 300, place, px, py));
      const Vec3d found = centre_of_dark(picture);
      EXPECT_NEAR(found.x, px, 0.25);
      EXPECT_NEAR(found.y, py, 0.25);
    };
    expect_at(pair.left, eyes.left);
    expect_at(pair.right, eyes.right);
  }
}

TEST(PropertyMicroscope, APlacedMeshLooksLikeOneWithMovedVertices) {
  RigidPlacement placement;
  placement.z = Vec3d(0.3, -0.5, 0.8).normalized();
  placement.x = placement.z.cross(Vec3d(0, 1, 0)).normalized();
  placement.y = placement.z.cross(placement.x);
  placement.origin_mm = {1, -0.5, -10};
  const auto drawn = [&](bool is_placed) {
    Microscope microscope;
    microscope.set_globe(grey_globe());
    microscope.set_lamp(aside_lamp());
    TriangleMesh mesh = needle_mesh(8, 0.1, 0.4);
    for (Vec3d& v : mesh.vertices_lps_mm) {
      if (is_placed) break;
      v = placement.origin_mm + placement.x * v.x + placement.y * v.y + placement.z * v.z;
    }
    const int number = microscope.add_rigid(mesh, {});
    if (is_placed) microscope.place(number, placement);
    return picture_by(microscope, eye_camera(), small_picture());
  };
  const Image placed = drawn(true), moved = drawn(false);
  int differing = 0;
  for (std::size_t n = 0; n < placed.rgba.size(); ++n) {
    differing += std::abs(int(placed.rgba[n]) - int(moved.rgba[n])) > 3;
  }
  EXPECT_LT(differing, 30);
}

double difference_of(const Image& a, const Image& b) {
  double sum = 0;
  for (std::size_t n = 0; n < a.rgba.size(); ++n) sum += std::abs(int(a.rgba[n]) - int(b.rgba[n]));
  return sum / double(a.rgba.size());
}

TEST(PropertyMicroscope, SmoothEdgesAreNearerToThePictureOfManyRays) {
  Microscope microscope;
  microscope.set_globe(grey_globe());
  microscope.set_lamp(aside_lamp());
  RigidPlacement placement;
  placement.origin_mm = {0.4, -0.3, -8};
  microscope.place(microscope.add_rigid(ball_mesh(1), {}), placement);
  MicroscopeSettings settings = small_picture();
  const Image smooth = picture_by(microscope, eye_camera(), settings);
  settings.smooth_edges = false;
  const Image rough = picture_by(microscope, eye_camera(), settings);
  const Image large = picture_by(microscope, eye_camera(), small_picture(8 * 160, 8 * 120));
  Image mean(160, 120);
  for (std::size_t n = 0; n < mean.rgba.size(); ++n) {
    const auto x = int(n / 4 % 160), y = int(n / 640), c = int(n % 4);
    double sum = 0;
    for (int k = 0; k < 64; ++k) sum += light_at(large, 8 * x + k % 8, 8 * y + k / 8, c);
    mean.rgba[n] = std::uint8_t(std::lround(byte_from_light(sum / 64)));
  }
  for (std::size_t n = 3; n < mean.rgba.size(); n += 4) mean.rgba[n] = 255;
  EXPECT_LT(difference_of(smooth, mean), 0.5 * difference_of(rough, mean));
}

TEST(ExtremesMicroscope, SmallPicturesAndEmptyShapesAreDrawn) {
  Microscope microscope;
  const int soft = microscope.add_soft({});
  EXPECT_EQ(picture_by(microscope, eye_camera(), small_picture(5, 3)).rgba.size(), 60u);
  microscope.set_globe(grey_globe());
  microscope.reshape(soft, {}, {});
  MicroscopeSettings settings = small_picture(1, 1);
  settings.ambient = 1;
  EXPECT_NEAR(light_at(picture_by(microscope, eye_camera(), settings), 0, 0), grey_albedo(), 0.02);
  microscope.reshape(soft, {{0, 0, -5}, {0, 0, -5}, {0, 0, -5}}, {{0, 1, 2}});
  EXPECT_NEAR(light_at(picture_by(microscope, eye_camera(), settings), 0, 0), grey_albedo(), 0.02);
}

TEST(FaultMicroscope, WhatCannotBeDrawnIsRefused) {
  Microscope microscope;
  Camera parallel = eye_camera();
  parallel.projection = Projection::orthographic;
  EXPECT_THROW(picture_by(microscope, parallel, small_picture()), InputError);
  EXPECT_THROW(picture_by(microscope, eye_camera(), small_picture(0, 10)), InputError);
  MicroscopeSettings settings = small_picture();
  settings.shadow_samples = -1;
  EXPECT_THROW(picture_by(microscope, eye_camera(), settings), InputError);
  const int soft = microscope.add_soft({});
  EXPECT_THROW(microscope.reshape(soft, {{0, 0, 0}}, {{0, 1, 2}}), InputError);
  EXPECT_THROW(microscope.reshape(soft, {{NAN, 0, 0}}, {}), InputError);
  GlobeLook globe = grey_globe();
  globe.fundus.width = 2;
  EXPECT_THROW(microscope.set_globe(globe), InputError);
}

}  // namespace
}  // namespace supple
