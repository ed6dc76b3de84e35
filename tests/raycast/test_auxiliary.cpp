// Depth, normal and offset of what a picture shows, against a ball whose surface is known.
#include <cmath>
#include <optional>

#include <gtest/gtest.h>

#include "tests/raycast/scenes.h"

namespace supple {
namespace {

constexpr int kAuxSize = 40, kPixels = 48;
constexpr double kSpacing = 1.5, kRadiusMm = 20;

/// Density 500 at the ball's surface, 200 per mm; the ball is centred on the world's origin.
DensityGrid ball(const Geometry& geometry) {
  return grid_of(voxels_of(geometry.dims(), everywhere), [&](const Vec3d& index) {
    const double inside = kRadiusMm - geometry.world_from_index(index).length();
    return std::clamp(500 + 200 * inside, 0.0, 1000.0);
  });
}

/// Transparent below density 500, opaque at once above it.
TransferFunction wall() {
  TransferFunction f;
  f.opacity = {{499, 0}, {501, 1}};
  f.colour = {{0, {0.9, 0.7, 0.5}}};
  return f;
}

RenderSettings settings() {
  RenderSettings settings = small_picture(kPixels, 0.1);
  settings.auxiliary = true;
  return settings;
}

/// Distance in mm from its origin at which a pixel's ray enters the ball around `centre`.
std::optional<double> entry(const Ray& ray, const Vec3d& centre) {
  const Vec3d to_centre = centre - ray.origin_lps_mm;
  const double along = to_centre.dot(ray.direction_lps);
  const double squared = kRadiusMm * kRadiusMm - to_centre.dot(to_centre) + along * along;
  if (squared < 0) return std::nullopt;
  return along - std::sqrt(squared);
}

TEST(UnitAuxiliary, DepthAndNormalOfABallAreThoseOfItsSurface) {
  const Geometry geometry = cube_geometry(kAuxSize, kSpacing);
  const Renderer renderer(geometry, ball(geometry));
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    const Camera camera = default_camera(geometry, 1, "left", projection);
    const FloatImage picture = renderer.render_float(camera, wall(), settings());
    const Vec3d forward = camera_frame(camera).forward;
    int hits = 0;
    for (int y = 0; y < kPixels; ++y) {
      for (int x = 0; x < kPixels; ++x) {
        const std::size_t n = std::size_t(y) * kPixels + x;
        const Ray ray = camera_ray(camera, kPixels, kPixels, x + 0.5, y + 0.5);
        const auto t = entry(ray, Vec3d(0));
        if (!t) {
          EXPECT_TRUE(std::isnan(picture.depth_mm[n])) << x << " " << y;
          continue;
        }
        const Vec3d radial = (ray.origin_lps_mm + ray.direction_lps * *t).normalized();
        if (radial.dot(-ray.direction_lps) < 0.3) continue;  // the rim
        ++hits;
        // One sample of 0.15 mm, seen at an angle, and the trilinear surface.
        EXPECT_NEAR(picture.depth_mm[n], *t * ray.direction_lps.dot(forward), 0.3);
        const float* normal = &picture.normal_lps[3 * n];
        EXPECT_GT(Vec3d(normal[0], normal[1], normal[2]).dot(radial), 0.998);
      }
    }
    EXPECT_GT(hits, 300);
  }
}

TEST(UnitAuxiliary, TheOffsetOfAShiftedBallIsTheShiftInMillimetres) {
  const Geometry geometry = cube_geometry(kAuxSize, kSpacing);
  Renderer renderer(geometry, ball(geometry));
  OffsetField offsets{geometry, {voxels_of(geometry.dims(), everywhere), {}}, {}};
  offsets.o.vectors = vectors_of(offsets.o.topology, Vec3f(-2, 0, 1));
  renderer.set_offsets(&offsets);
  const Camera camera = default_camera(geometry, 1);
  const FloatImage moved = renderer.render_float(camera, wall(), settings());
  renderer.set_offsets(nullptr);
  const FloatImage still = renderer.render_float(camera, wall(), settings());
  int hits = 0;
  for (std::size_t n = 0; n < moved.pixel_count(); ++n) {
    EXPECT_TRUE(std::isnan(still.depth_mm[n]) || still.offset_mm[n] == 0);
    if (std::isnan(moved.depth_mm[n])) continue;
    EXPECT_NEAR(moved.offset_mm[n], kSpacing * std::sqrt(5.0), 1e-4);
    ++hits;
  }
  EXPECT_GT(hits, 300);
}

TEST(UnitAuxiliary, AMaximumIsWhereItsDensityIs) {
  const Geometry geometry = cube_geometry(kAuxSize, kSpacing);
  // A ramp to the front: the densest sample of every ray is its first.
  const Renderer renderer(geometry,
                          grid_of(voxels_of(geometry.dims(), everywhere),
                                  [&](const Vec3d& index) { return 10 * (kAuxSize - index.y); }));
  TransferFunction mip = fog_function(1);
  mip.blend = Blend::maximum;
  const Camera camera = default_camera(geometry, 1, "anterior", Projection::orthographic);
  const FloatImage picture = renderer.render_float(camera, mip, settings());
  const double to_front = geometry.world_from_index(Vec3d(0)).y - camera.position_lps_mm.y;
  const std::size_t middle = kPixels / 2 * kPixels + kPixels / 2;
  EXPECT_NEAR(picture.depth_mm[middle], to_front, 0.2);
}

TEST(UnitAuxiliary, WhatStaysHalfTransparentHasNoSurface) {
  const Geometry geometry = cube_geometry(kAuxSize, kSpacing);
  const Renderer renderer(geometry, ball(geometry));
  const FloatImage fog =
      renderer.render_float(default_camera(geometry, 1), fog_function(0.002), settings());
  EXPECT_GT(fog.rgba[4 * (kPixels / 2 * kPixels + kPixels / 2) + 3], 0.05);
  for (const float depth : fog.depth_mm) EXPECT_TRUE(std::isnan(depth));
}

TEST(PropertyAuxiliary, AskingForItChangesNoColour) {
  const Geometry geometry = cube_geometry(kAuxSize, kSpacing);
  const Renderer renderer(geometry, ball(geometry));
  RenderSettings plain = settings();
  plain.auxiliary = false;
  const Camera camera = default_camera(geometry, 1);
  for (const TransferFunction& look : {wall(), surface_function(), preset("CT-MIP")}) {
    const FloatImage without = renderer.render_float(camera, look, plain);
    EXPECT_EQ(renderer.render_float(camera, look, settings()).rgba, without.rgba);
    EXPECT_FALSE(without.has_auxiliary());
  }
}

}  // namespace
}  // namespace supple
