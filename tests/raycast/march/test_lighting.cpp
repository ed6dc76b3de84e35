// Lights, shadows and ambient occlusion against geometry and the laws of emission and absorption.
#include <algorithm>

#include <gtest/gtest.h>

#include "raycast/march/light_volume.h"
#include "raycast/pictures/compare.h"
#include "tests/raycast/scenes.h"
#include "volumes/base/parallel.h"
#include "volumes/field/procedural.h"

namespace supple {
namespace {

constexpr int kLitSize = 48;

/// White; opaque within a voxel from mid density on; lit by `ambient` and `diffuse` alone.
TransferFunction matte(double ambient, double diffuse) {
  TransferFunction f;
  f.opacity = {{450, 0}, {550, 0.95}};
  f.colour = {{0, {1, 1, 1}}};
  f.ambient = ambient, f.diffuse = diffuse, f.specular = 0;
  return f;
}

/// Voxel coordinates x, z seen at a pixel of a square picture of front_camera(kLitSize).
struct SeenAt {
  double x, z;
};
SeenAt seen_at(int column, int row, int pixels) {
  const double scale = double(kLitSize) / pixels;
  return {(column + 0.5) * scale - 0.5, kLitSize - 0.5 - (row + 0.5) * scale};
}

Light far_light(const Vec3d& towards_lps, double intensity = 1) {
  Light light;
  light.direction = towards_lps;
  light.is_of_camera = false;
  light.intensity = intensity;
  return light;
}

/// 1000 inside, 0 outside, linear over two voxels around distance 0 (negative inside).
double edge(double distance) {
  return 500 - 500 * std::clamp(distance, -1.0, 1.0);
}

float red(const FloatImage& picture, int column, int row) {
  return picture.rgba[4 * (std::size_t(row) * picture.width + column)];
}

DensityGrid whole(const DensityFunction& density) {
  return grid_of(voxels_of(Vec3i(kLitSize), everywhere), density);
}

TEST(UnitLight, TheDefaultLightGivenInFullIsTheDefaultPicture) {
  const Geometry geometry = cube_geometry(kLitSize);
  const Renderer renderer(geometry, whole(lobed_body(Vec3d(23.5), 14)));
  const Camera camera = default_camera(geometry, 1, "left");
  RenderSettings settings = small_picture(96);
  const Image expected = renderer.render(camera, surface_function(), settings);
  settings.lighting.lights = {Light()};
  EXPECT_EQ(renderer.render(camera, surface_function(), settings).rgba, expected.rgba);
  // Seen from the left, the camera's right, up and back are posterior, superior and left.
  settings.lighting.lights = {far_light({1, -0.25, 0.35})};
  EXPECT_LE(compare(renderer.render(camera, surface_function(), settings), expected, true).max_diff,
            1.0 / 255);
}

TEST(PropertyLight, LightsAddUp) {
  const Geometry geometry = cube_geometry(kLitSize);
  const Renderer renderer(geometry, whole(lobed_body(Vec3d(23.5), 14)));
  const Camera camera = default_camera(geometry, 1);
  TransferFunction f = surface_function();
  f.ambient = 0;
  Light first = far_light({1, -1, 0.5}, 0.3), second = far_light({-1, -0.2, 0.1}, 0.5);
  second.rgb = {1, 0.5, 0.25};
  const auto picture = [&](const std::vector<Light>& lights) {
    RenderSettings settings = small_picture(64);
    settings.lighting.lights = lights;
    settings.lighting.shadows = true;
    return renderer.render_float(camera, f, settings);
  };
  const FloatImage a = picture({first}), b = picture({second}), both = picture({first, second});
  double brightest = 0;
  for (std::size_t n = 0; n < both.rgba.size(); ++n) {
    if (n % 4 == 3) continue;
    ASSERT_NEAR(both.rgba[n], a.rgba[n] + b.rgba[n], 1e-5);
    brightest = std::max(brightest, double(both.rgba[n]));
  }
  EXPECT_GT(brightest, 0.4);
}

TEST(UnitLight, HighlightsFollowBlinnsAndPhongsFormulas) {
  // A ramp whose normal points to the viewer; the light 40 degrees off.
  const Renderer renderer(cube_geometry(kLitSize), whole([](const Vec3d& p) { return -20 * p.y; }));
  TransferFunction f = fog_function(1);
  f.ambient = f.diffuse = 0, f.specular = 1, f.specular_power = 8;
  const double angle = 40 * M_PI / 180;
  RenderSettings settings = small_picture(3);
  settings.lighting.lights = {far_light({std::sin(angle), -std::cos(angle), 0})};
  const auto grey = [&](ShadingModel model) {
    settings.lighting.model = model;
    return red(renderer.render_float(front_camera(10), f, settings), 1, 1);
  };
  EXPECT_NEAR(grey(ShadingModel::blinn), std::pow(std::cos(angle / 2), 8), 2e-3);
  EXPECT_NEAR(grey(ShadingModel::phong), std::pow(std::cos(angle), 8), 2e-3);
  EXPECT_NEAR(grey(ShadingModel::none), 1, 2e-3);
}

TEST(UnitLight, WhatIsNoLightIsRefused) {
  const auto is_refused = [](const Lighting& lighting) {
    RenderSettings settings;
    settings.lighting = lighting;
    EXPECT_THROW(settings.validate(), InputError);
  };
  is_refused({ShadingModel::blinn, {far_light({0, 0, 0})}, false, 0});
  is_refused({ShadingModel::blinn, {far_light({NAN, 0, 0})}, false, 0});
  is_refused({ShadingModel::blinn, {far_light({1, 0, 0}, -1)}, false, 0});
  is_refused({ShadingModel::blinn, std::vector<Light>(9), false, 0});
  is_refused({ShadingModel::blinn, {}, true, -1});
  is_refused({ShadingModel::blinn, {}, true, 0, 20.5});
  is_refused({ShadingModel::blinn, {}, true, 0, NAN});
}

TEST(UnitLight, AStopOfExposureDoublesTheLinearLightOfEveryPixel) {
  const Geometry geometry = cube_geometry(kLitSize);
  const Renderer renderer(geometry, whole(lobed_body(Vec3d(23.5), 14)));
  TransferFunction f = surface_function();
  f.unit_distance_mm = 20;  // translucent in places
  const auto picture = [&](double stops) {
    RenderSettings settings = small_picture(48);
    settings.lighting.exposure_stops = stops;
    return renderer.render_float(default_camera(geometry, 1), f, settings);
  };
  const auto light = [](const FloatImage& image, std::size_t pixel, std::size_t channel) {
    const float alpha = image.rgba[4 * pixel + 3];
    return linear_from_srgb(image.rgba[4 * pixel + channel] / alpha) * alpha;
  };
  const FloatImage plain = picture(0);
  std::size_t translucent = 0, clamped = 0;
  for (const double stops : {1.0, -2.0, 4.0}) {
    const FloatImage bright = picture(stops);
    const Image bytes = to_image(bright);
    for (std::size_t n = 0; n < plain.pixel_count(); ++n) {
      const float alpha = plain.rgba[4 * n + 3];
      ASSERT_EQ(bright.rgba[4 * n + 3], alpha);
      if (alpha <= 0) continue;
      translucent += alpha > 0.1f && alpha < 0.9f;
      for (std::size_t c = 0; c < 3; ++c) {
        const double expected = std::exp2(stops) * double(light(plain, n, c));
        ASSERT_NEAR(light(bright, n, c), expected, 1e-5 * (1 + expected));
        if (expected / double(alpha) <= 1.01) continue;
        ++clamped;
        ASSERT_EQ(int(bytes.rgba[4 * n + c]), 255);
      }
    }
  }
  EXPECT_GT(translucent, 50u);
  EXPECT_GT(clamped, 1000u);
}

/// A ball before a wall, lit from one side.
class BallBeforeWall {
 public:
  static constexpr double kRadius = 6, kWall = 36;
  static constexpr int kPixels = 96;

  explicit BallBeforeWall(const Vec3d& centre) : m_centre(centre) {}
  DensityGrid grid() const {
    return whole([&](const Vec3d& p) {
      return std::max(edge((p - m_centre).length() - kRadius), edge(kWall - p.y));
    });
  }
  Vec3d towards_light() const { return {0.6, -0.8, 0}; }
  /// Voxels from the edge of the shadow on the wall, positive outside of it.
  double from_shadow(const SeenAt& at) const {
    const Vec3d p = Vec3d(at.x, kWall, at.z) - m_centre;
    return (p - towards_light() * p.dot(towards_light())).length() - kRadius;
  }
  bool shows_ball(const SeenAt& at) const {
    return std::hypot(at.x - m_centre.x, at.z - m_centre.z) < kRadius + 2;
  }

 private:
  Vec3d m_centre;
};

TEST(PropertyShadow, ABallShadesTheWallWhereGeometrySays) {
  const BallBeforeWall scene({26, 18, 22});
  const Renderer renderer(cube_geometry(kLitSize), scene.grid());
  RenderSettings settings = small_picture(BallBeforeWall::kPixels);
  settings.lighting.shadows = true;
  settings.lighting.lights = {far_light(scene.towards_light())};
  const FloatImage picture =
      renderer.render_float(front_camera(kLitSize), matte(0.2, 0.7), settings);
  int dark = 0, lit = 0;
  for (int row = 8; row < settings.height - 8; ++row) {
    for (int column = 8; column < settings.width - 8; ++column) {
      const SeenAt at = seen_at(column, row, settings.width);
      const double outside = scene.from_shadow(at);
      if (scene.shows_ball(at) || std::abs(outside) < 1.5) continue;
      ASSERT_NEAR(red(picture, column, row), outside < 0 ? 0.2 : 0.2 + 0.7 * 0.8, 0.02)
          << at.x << " " << at.z;
      ++(outside < 0 ? dark : lit);
    }
  }
  EXPECT_GT(dark, 200);
  EXPECT_GT(lit, 2000);
}

TEST(PropertyShadow, TheShadowIsThatOfTheDeformedVolume) {
  const Geometry geometry = cube_geometry(kLitSize);
  const BallBeforeWall rest({26, 18, 22}), moved({26, 18, 29});
  Renderer renderer(geometry, rest.grid());
  // Up by 7 voxels; the wall looks the same.
  OffsetField offsets{geometry, {voxels_of(Vec3i(kLitSize), everywhere), {}}, {}};
  offsets.o.vectors = vectors_of(offsets.o.topology, Vec3f(0, 0, -7));
  renderer.set_offsets(&offsets);
  RenderSettings settings = small_picture(96);
  settings.lighting.shadows = true;
  settings.lighting.occlusion_radius_mm = 6;
  settings.lighting.lights = {far_light(rest.towards_light())};
  const FloatImage shown = renderer.render_float(front_camera(kLitSize), matte(0.2, 0.7), settings);
  const FloatImage expected = Renderer(geometry, moved.grid())
                                  .render_float(front_camera(kLitSize), matte(0.2, 0.7), settings);
  for (int row = 8; row < 78; ++row) {  // what is lower comes from outside of the volume
    for (int column = 8; column < 88; ++column) {
      ASSERT_NEAR(red(shown, column, row), red(expected, column, row), 0.02)
          << column << " " << row;
    }
  }
}

TEST(PropertyShadow, AConvexBodyDoesNotShadeItsLitSide) {
  const Geometry geometry = cube_geometry(kLitSize);
  const Renderer renderer(
      geometry, whole([](const Vec3d& p) { return edge((p - Vec3d(23.5)).length() - 16); }));
  RenderSettings settings = small_picture(96);
  const FloatImage without =
      renderer.render_float(front_camera(kLitSize), matte(0.1, 0.9), settings);
  settings.lighting.shadows = true;
  settings.lighting.occlusion_radius_mm = 8;
  const FloatImage with = renderer.render_float(front_camera(kLitSize), matte(0.1, 0.9), settings);
  int compared = 0;
  for (std::size_t n = 0; n < with.rgba.size(); n += 4) {
    if (with.rgba[n + 3] < 0.98f || without.rgba[n] < 0.4f) continue;
    ASSERT_NEAR(with.rgba[n], without.rgba[n], 0.03);
    ++compared;
  }
  EXPECT_GT(compared, 2000);
}

TEST(PropertyShadow, AThinShellLetsNoLightIn) {
  // Half a hollow ball, three voxels thick, open to the viewer; the light comes through its side.
  const Renderer renderer(cube_geometry(kLitSize), whole([](const Vec3d& p) {
                            const double r = (p - Vec3d(23.5)).length();
                            return std::max(edge(std::abs(r - 17) - 1.5) - edge(p.y - 23.5), 0.0);
                          }));
  RenderSettings settings = small_picture(96);
  settings.lighting.lights = {far_light({0.95, 0.3, 0})};
  const auto brightest = [&](bool shadows) {
    settings.lighting.shadows = shadows;
    const FloatImage picture =
        renderer.render_float(front_camera(kLitSize), matte(0.1, 0.9), settings);
    float most = 0;
    for (int row = 0; row < 96; ++row) {
      for (int column = 0; column < 96; ++column) {
        const SeenAt at = seen_at(column, row, 96);
        if (std::hypot(at.x - 23.5, at.z - 23.5) < 12) {
          most = std::max(most, red(picture, column, row));
        }
      }
    }
    return most;
  };
  EXPECT_GT(brightest(false), 0.4f);
  EXPECT_LT(brightest(true), 0.13f);
}

/// Openness before a plane, `distance` from another one across it: the cosine-weighted mean, over
/// the hemisphere, of the free share of a path of `radius`.
double openness_beside_a_wall(double distance, double radius) {
  constexpr int kSteps = 200;
  double sum = 0;
  for (int n = 0; n < kSteps; ++n) {
    // Equal shares of the cosine-weighted hemisphere: a disc of directions.
    const double out = std::sqrt((n + 0.5) / kSteps);
    for (int m = 0; m < kSteps; ++m) {
      const double towards_wall = out * std::cos(2 * M_PI * (m + 0.5) / kSteps);
      sum += towards_wall > 0 ? std::min(distance / towards_wall / radius, 1.0) : 1.0;
    }
  }
  return sum / (kSteps * kSteps);
}

TEST(PropertyOcclusion, ACornerIsAsOpenAsBruteForceSays) {
  // A wall and, left of x = 12, a block that stands out of it.
  const Renderer renderer(cube_geometry(kLitSize), whole([](const Vec3d& p) {
                            return std::max(edge(36 - p.y), edge(p.x - 12));
                          }));
  RenderSettings settings = small_picture(96);
  const TransferFunction f = matte(0.3, 0.5);
  const FloatImage without = renderer.render_float(front_camera(kLitSize), f, settings);
  settings.lighting.occlusion_radius_mm = 16;
  const FloatImage with = renderer.render_float(front_camera(kLitSize), f, settings);
  for (int x = 14; x < 38; x += 2) {
    const double openness = red(with, 2 * x, 48) / red(without, 2 * x, 48);
    EXPECT_NEAR(openness, openness_beside_a_wall(x - 12, 16), 0.025) << x;
  }
  EXPECT_LT(openness_beside_a_wall(2, 16), 0.75);
}

TEST(PropertyShadow, NeitherThreadsNorSkippingChangeThePicture) {
  const Geometry geometry = cube_geometry(kLitSize);
  Renderer renderer(geometry, whole(lobed_body(Vec3d(23.5), 14)));
  const OffsetField bump = sample_offsets(bump_warp({24, 24, 24}, 18, 6), geometry,
                                          voxels_of(Vec3i(kLitSize), everywhere));
  renderer.set_offsets(&bump);
  RenderSettings settings = small_picture(64);
  settings.lighting.shadows = true;
  settings.lighting.occlusion_radius_mm = 5;
  TransferFunction f = surface_function();
  f.gradient_opacity = {{0, 0.2}, {80, 1}};
  const Camera camera = default_camera(geometry, 1);
  const auto render = [&] { return renderer.render(camera, f, settings); };
  const Image many = on_threads(5, render);
  settings.skip_empty_space = false;
  EXPECT_EQ(many.rgba, render().rgba);
  EXPECT_EQ(many.rgba, on_threads(1, render).rgba);
}

TEST(UnitLightVolume, ASurfaceGetsTheMeanOfTheLightBeforeItWeightedByTheCosine) {
  constexpr int kMany = 4000;
  LightVolume::Light all, half;
  for (int n = 0; n < kMany; ++n) {
    const double z = 1 - (2 * n + 1.0) / kMany, radius = std::sqrt(1 - z * z), turn = 2.4 * n;
    const Vec3f from(float(radius * std::cos(turn)), float(radius * std::sin(turn)), float(z));
    all.add_around(from, 1, 1.0f / kMany);
    half.add_around(from, z > 0 ? 1 : 0, 1.0f / kMany);
  }
  for (const Vec3f& normal : {Vec3f(0, 0, 1), Vec3f(1, 0, 0), Vec3f(0, -0.6f, 0.8f)}) {
    EXPECT_NEAR(all.openness({normal, 1}), 1, 1e-2);
    EXPECT_NEAR(half.openness({normal, 1}), (1 + normal.z) / 2, 1e-2) << normal;
    EXPECT_NEAR(half.openness({normal, 0}), 0.5, 1e-2);
  }
}

TEST(PropertyLightVolume, TranslucentTissueIsLitAsByPathsOfItsOwn) {
  const Geometry geometry = cube_geometry(kLitSize);
  const Renderer renderer(geometry, whole(lobed_body(Vec3d(23.5), 16)));
  TransferFunction f = surface_function();
  f.opacity = {{200, 0}, {400, 0.06}, {800, 0.04}, {950, 0.3}};
  RenderSettings settings = small_picture(64);
  settings.lighting.shadows = true;
  settings.lighting.occlusion_radius_mm = 8;
  settings.lighting.lights = {far_light({0.3, -1, 1}), far_light({-1, -0.4, 0.2}, 0.4)};
  const Camera camera = default_camera(geometry, 1);
  const FloatImage exact = renderer.render_float(camera, f, settings);
  double before = 1;
  for (const double spacing : {4.0, 2.0}) {
    settings.lighting.volume_mm = spacing;
    const FloatImage picture = renderer.render_float(camera, f, settings);
    double sum = 0, largest = 0;
    for (std::size_t n = 0; n < exact.rgba.size(); ++n) {
      const double off = std::abs(double(picture.rgba[n]) - exact.rgba[n]);
      sum += off, largest = std::max(largest, off);
    }
    const double mean = sum / double(exact.rgba.size());
    EXPECT_LT(mean, 0.001 * spacing) << spacing;
    EXPECT_LT(largest, 0.01 + 0.025 * spacing) << spacing;
    EXPECT_LT(mean, before) << spacing;
    before = mean;
  }
}

TEST(PropertyLightVolume, NeitherThreadsNorSkippingChangeThePicture) {
  const Geometry geometry = cube_geometry(kLitSize);
  const Renderer renderer(geometry, whole(lobed_body(Vec3d(23.5), 14)));
  RenderSettings settings = small_picture(64);
  settings.lighting.shadows = true;
  settings.lighting.occlusion_radius_mm = 5;
  settings.lighting.volume_mm = 3;
  const Camera camera = default_camera(geometry, 1);
  const auto render = [&] { return renderer.render(camera, fog_function(0.05), settings); };
  const Image many = on_threads(5, render);
  EXPECT_EQ(many.rgba, on_threads(1, render).rgba);
  settings.skip_empty_space = false;
  EXPECT_EQ(many.rgba, render().rgba);
}

}  // namespace
}  // namespace supple
