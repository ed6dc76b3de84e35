// Whole pictures against geometry and closed formulas, and against a ray marcher that knows no
// bricks: what golden images are vouched for by.
#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

#include <gtest/gtest.h>

#include "raycast/scene/clip.h"
#include "raycast/scene/stereo.h"
#include "tests/raycast/scenes.h"

namespace supple {
namespace {

constexpr int kScene = 32;
constexpr double kFront = -0.5 * (kScene - 1);  // y of the border that front_camera sees, mm

DensityGrid filled(const DensityFunction& density) {
  return grid_of(voxels_of(Vec3i(kScene), everywhere), density);
}

/// Step 0.4: samples lie at 0.2, 0.6, … voxels behind the border, so that their steps begin at it.
RenderSettings from_border(int pixels) {
  RenderSettings settings = small_picture(pixels, 0.4);
  settings.lighting.model = ShadingModel::none;
  return settings;
}

/// Transparent below density 500, opaque at once above it.
TransferFunction step_function() {
  TransferFunction f;
  f.opacity = {{499, 0}, {501, 1}};
  f.colour = {{0, {1, 1, 1}}};
  return f;
}

std::size_t middle_of(const FloatImage& picture) {
  return std::size_t(picture.height / 2) * picture.width + picture.width / 2;
}

TEST(PropertyAnalyticScene, ASurfaceDividesAFogWhereItStandsInASample) {
  Renderer renderer(cube_geometry(kScene), filled([](const Vec3d&) { return 100; }));
  for (double depth = 0.07; depth < 12; depth += 0.13) {
    Surface screen;
    const double y = kFront + depth;
    screen.mesh.vertices_lps_mm = {{-9, y, -9}, {9, y, -9}, {9, y, 9}, {-9, y, 9}};
    screen.mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    screen.rgb = {0, 0, 0};
    renderer.set_surfaces({screen});
    const FloatImage picture =
        renderer.render_float(front_camera(kScene), fog_function(0.1), from_border(9));
    EXPECT_NEAR(picture.rgba[4 * middle_of(picture)], 1 - std::pow(0.9, depth), 1e-5) << depth;
  }
}

TEST(PropertyAnalyticScene, WhatEndsARayIsWhollyOpaque) {
  const Renderer renderer(cube_geometry(kScene), filled([](const Vec3d&) { return 100; }));
  TransferFunction fog = fog_function(0.5);
  fog.colour = {{0, {0.5, 0.25, 0.75}}};
  for (const double early : {0.5, 0.99, 1.0}) {
    RenderSettings settings = from_border(9);
    settings.early_termination = early;
    const FloatImage picture = renderer.render_float(front_camera(kScene), fog, settings);
    const float* pixel = &picture.rgba[4 * middle_of(picture)];
    EXPECT_NEAR(pixel[0], 0.5, 1e-6);
    EXPECT_NEAR(pixel[1], 0.25, 1e-6);
    EXPECT_NEAR(pixel[2], 0.75, 1e-6);
    EXPECT_NEAR(pixel[3], 1, 1e-6);
  }
}

TEST(PropertyAnalyticScene, AFogHasItsSurfaceWhereHalfOfTheLightIsGone) {
  const Renderer renderer(cube_geometry(kScene), filled([](const Vec3d&) { return 100; }));
  for (const double opacity : {0.1, 0.2, 0.35, 0.6}) {
    RenderSettings settings = from_border(9);
    settings.auxiliary = true;
    const FloatImage picture =
        renderer.render_float(front_camera(kScene), fog_function(opacity), settings);
    const double depth = std::log(0.5) / std::log(1 - opacity);
    EXPECT_NEAR(picture.depth_mm[middle_of(picture)], 200 + kFront + depth, 1e-3) << opacity;
  }
}

TEST(PropertyAnalyticScene, TheDepthOfAWallIsNeitherEarlyNorLateOnAverage) {
  constexpr int kPlaces = 40;
  for (const double step : {0.5, 1.0, 2.0}) {
    double sum = 0, largest = 0;
    for (int n = 0; n < kPlaces; ++n) {
      const double wall = 10 + step * n / kPlaces;  // voxels
      const Renderer renderer(cube_geometry(kScene), filled([&](const Vec3d& p) {
                                return std::clamp(500 + 200 * (p.y - wall), 0.0, 1000.0);
                              }));
      RenderSettings settings = small_picture(9, step);
      settings.auxiliary = true;
      const FloatImage picture =
          renderer.render_float(front_camera(kScene), step_function(), settings);
      const double late = picture.depth_mm[middle_of(picture)] - (200 + kFront + wall);
      sum += late;
      largest = std::max(largest, std::abs(late));
    }
    EXPECT_NEAR(sum / kPlaces, 0, 0.04 * step) << step;
    EXPECT_LE(largest, 0.55 * step) << step;
  }
}

TEST(PropertyAnalyticScene, TheVolumesBorderIsLitAsAFaceWhateverIsCutThere) {
  // Gradients of any direction inside; the border is seen at a right angle and at a slant.
  std::mt19937 random(51);
  Renderer renderer(cube_geometry(kScene),
                    filled([&](const Vec3d&) { return double(random() % 2000); }));
  RenderSettings settings = small_picture(24, 0.25);
  settings.auxiliary = true;
  TransferFunction matte = fog_function(1);
  matte.ambient = 0.1, matte.diffuse = 0.8, matte.specular = 0;
  Light light;
  light.direction = {0.6, -0.8, 0};
  light.is_of_camera = false;
  settings.lighting.lights = {light};
  Camera slanted = front_camera(12);
  slanted.position_lps_mm = {60, -100, 40};
  slanted.target_lps_mm = {0, kFront, 0};
  // A shift moves the border along.
  OffsetField shifted{cube_geometry(kScene), {voxels_of(Vec3i(kScene), everywhere), {}}, {}};
  shifted.o.vectors = vectors_of(shifted.o.topology, Vec3f(0, -3, 0));
  for (const bool moved : {false, true}) {
    renderer.set_offsets(moved ? &shifted : nullptr);
    for (const Camera& camera : {front_camera(12), slanted}) {
      const FloatImage picture = renderer.render_float(camera, matte, settings);
      for (std::size_t n = 0; n < picture.pixel_count(); ++n) {
        ASSERT_NEAR(picture.normal_lps[3 * n + 1], -1, 1e-5) << n % 24 << " " << n / 24;
        ASSERT_NEAR(picture.rgba[4 * n], 0.1 + 0.8 * 0.8, 1e-4) << n % 24 << " " << n / 24;
      }
    }
  }
}

TEST(PropertyAnalyticScene, ABodyThatEndsJustInsideOfTheBorderKeepsItsOwnNormals) {
  // A slanting surface that comes within a voxel of the border, air before it.
  const Vec3d slope = Vec3d(0.3, -1, 0.1).normalized();
  const Renderer renderer(cube_geometry(kScene), filled([&](const Vec3d& p) {
                            const double inside = -slope.dot(p - Vec3d(15.5, 1.5, 15.5));
                            return std::clamp(500 + 200 * inside, 0.0, 1000.0);
                          }));
  RenderSettings settings = small_picture(16, 0.25);
  settings.auxiliary = true;
  const FloatImage picture = renderer.render_float(front_camera(3), step_function(), settings);
  for (std::size_t n = 0; n < picture.pixel_count(); ++n) {
    const float* found = &picture.normal_lps[3 * n];
    ASSERT_GT(Vec3d(found[0], found[1], found[2]).dot(slope), 0.999) << n % 16 << " " << n / 16;
  }
}

/// Rows of a matrix.
struct Matrix {
  Vec3d rows[3];
  Vec3d times(const Vec3d& v) const { return {rows[0].dot(v), rows[1].dot(v), rows[2].dot(v)}; }
  Vec3d transposed_times(const Vec3d& v) const {
    return rows[0] * v.x + rows[1] * v.y + rows[2] * v.z;
  }
};

TEST(PropertyAnalyticScene, AnAffinelyDeformedBallIsAnEllipsoidWithItsNormals) {
  constexpr double kRadius = 9;
  const Geometry geometry = cube_geometry(kScene);
  const auto from_centre = [&](const Vec3d& index) { return geometry.world_from_index(index); };
  Renderer renderer(geometry, filled([&](const Vec3d& p) {
                      return std::clamp(500 + 200 * (kRadius - from_centre(p).length()), 0.0,
                                        1000.0);
                    }));
  // Back from the picture to the ball.
  const Matrix back{{{0.75, -0.2, 0}, {0.1, 1.25, 0.15}, {0, 0.1, 0.9}}};
  OffsetField offsets{geometry, {voxels_of(Vec3i(kScene), everywhere), {}}, {}};
  offsets.o.vectors.resize(offsets.o.topology.brick_count());
  for (std::size_t b = 0; b < offsets.o.topology.brick_count(); ++b) {
    for (int n = 0; n < kBrickVoxels; ++n) {
      const Vec3d x = from_centre(Vec3d(offsets.o.topology.origin(b) + brick_local(n)));
      offsets.o.vectors.touch(b)[n] = Vec3f(back.times(x) - x);
    }
  }
  renderer.set_offsets(&offsets);
  RenderSettings settings = small_picture(64, 0.1);
  settings.auxiliary = true;
  int hits = 0, misses = 0;
  for (const char* view : {"anterior", "left"}) {
    const Camera camera = default_camera(geometry, 1, view);
    const Vec3d forward = camera_frame(camera).forward;
    const FloatImage picture = renderer.render_float(camera, step_function(), settings);
    for (std::size_t n = 0; n < picture.pixel_count(); ++n) {
      const Ray ray = camera_ray(camera, 64, 64, double(n % 64) + 0.5, double(n / 64) + 0.5);
      const Vec3d p = back.times(ray.origin_lps_mm), d = back.times(ray.direction_lps);
      const double a = d.dot(d), b = p.dot(d), c = p.dot(p) - kRadius * kRadius;
      const double squared = b * b - a * c;
      if (squared < 0) {
        if (squared > -20 * a) continue;  // just beside it
        EXPECT_TRUE(std::isnan(picture.depth_mm[n])) << n;
        ++misses;
        continue;
      }
      const double t = (-b - std::sqrt(squared)) / a;
      const Vec3d normal = back.transposed_times(p + d * t).normalized();
      if (normal.dot(-ray.direction_lps) < 0.4) continue;  // the rim
      EXPECT_NEAR(picture.depth_mm[n], t * ray.direction_lps.dot(forward), 0.15) << n;
      const float* found = &picture.normal_lps[3 * n];
      EXPECT_GT(Vec3d(found[0], found[1], found[2]).dot(normal), 0.995) << n;
      ++hits;
    }
  }
  EXPECT_GT(hits, 500);
  EXPECT_GT(misses, 500);
}

/// Mean place of what a picture shows, in pixels, weighted by opacity.
struct Centroid {
  double x = 0, y = 0;
};
Centroid centroid(const FloatImage& picture) {
  Centroid sum;
  double weight = 0;
  for (std::size_t n = 0; n < picture.pixel_count(); ++n) {
    const double alpha = picture.rgba[4 * n + 3];
    sum.x += alpha * (double(n % std::size_t(picture.width)) + 0.5);
    sum.y += alpha * (double(n / std::size_t(picture.width)) + 0.5);
    weight += alpha;
  }
  return {sum.x / weight, sum.y / weight};
}

TEST(PropertyAnalyticScene, ABallIsSeenApartByBothEyesAsSimilarTrianglesSay) {
  const Geometry geometry = cube_geometry(kScene);
  constexpr int kWide = 200;
  constexpr double kEyes = 20;
  Camera camera;
  camera.position_lps_mm = {0, -120, 0};
  for (const double nearer : {-9.0, 0.0, 9.0}) {
    const Renderer renderer(geometry, filled([&](const Vec3d& p) {
                              const Vec3d from =
                                  geometry.world_from_index(p) - Vec3d(4, -nearer, 3);
                              return std::clamp(500 + 200 * (3 - from.length()), 0.0, 1000.0);
                            }));
    const StereoCameras eyes = stereo_cameras(camera, kEyes);
    const RenderSettings settings = small_picture(kWide, 0.25);
    const Centroid left = centroid(renderer.render_float(eyes.left, step_function(), settings));
    const Centroid right = centroid(renderer.render_float(eyes.right, step_function(), settings));
    const double half_angle = 0.5 * camera.vertical_fov_degrees * M_PI / 180;
    const double pixels_per_mm = 0.5 * kWide / (120 * std::tan(half_angle));
    const double expected = kEyes * nearer / (120 - nearer) * pixels_per_mm;
    EXPECT_NEAR(left.x - right.x, expected, 0.1) << nearer;
    EXPECT_NEAR(left.y, right.y, 0.1) << nearer;
  }
}

/// Densities in one array, marched from the definitions: every sample of every ray, trilinear among
/// eight known corners, composited front to back.
class PlainVolume {
 public:
  PlainVolume(const Geometry& geometry, const std::function<std::optional<double>(Vec3i)>& density)
      : m_geometry(geometry) {
    const Vec3i& dims = geometry.dims();
    for (int x = 0; x < dims.x; ++x) {
      for (int y = 0; y < dims.y; ++y) {
        for (int z = 0; z < dims.z; ++z) m_values.push_back(density({x, y, z}));
      }
    }
  }

  std::array<double, 4> march(const Ray& ray, const TransferFunction& f, double step_mm) const {
    const IndexRay line{m_geometry.index_from_world(ray.origin_lps_mm),
                        m_geometry.index_vector_from_world(ray.direction_lps)};
    const Interval span = clip_to_box(line, Vec3d(-1), Vec3d(m_geometry.dims()), {0, kEndless});
    std::array<double, 4> sum{};
    for (double t = span.begin; t <= span.end; t += step_mm) {
      const std::optional<double> density = sample(line.at(t));
      if (!density) continue;
      const double alpha = 1 - std::pow(1 - f.opacity_at(*density), step_mm / f.unit_distance_mm);
      const std::array<double, 3> rgb = f.colour_at(*density);
      const double seen = (1 - sum[3]) * alpha;
      for (std::size_t c = 0; c < 3; ++c) sum[c] += seen * rgb[c];
      sum[3] += seen;
    }
    return sum;
  }

 private:
  std::optional<double> sample(const Vec3d& pos) const {
    const Vec3d floor(std::floor(pos.x), std::floor(pos.y), std::floor(pos.z));
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3i voxel = Vec3i(floor) + Vec3i(corner >> 2, corner >> 1 & 1, corner & 1);
      const Vec3i& dims = m_geometry.dims();
      double weight = 1;
      for (int a = 0; a < 3; ++a) {
        if (voxel[a] < 0 || voxel[a] >= dims[a]) return std::nullopt;
        weight *= 1 - std::abs(pos[a] - voxel[a]);
      }
      const auto& value = m_values[std::size_t((voxel.x * dims.y + voxel.y) * dims.z + voxel.z)];
      if (!value) return std::nullopt;
      sum += weight * *value;
    }
    return sum;
  }

  Geometry m_geometry;
  std::vector<std::optional<double>> m_values;
};

TEST(PropertyAnalyticScene, BrickTablesShowWhatAPlainVolumeShows) {
  const Geometry geometry({29, 35, 31}, {3, -8, 5},
                          {Vec3d(0.8, 0, 0.1), {0, -1.1, 0}, {0, 0.2, 1}});
  const DensityFunction body = lobed_body({14, 17, 15}, 11);
  const auto density = [&](const Vec3i& v) -> std::optional<double> {
    if ((Vec3d(v) - Vec3d(20, 24, 18)).length() < 6) return std::nullopt;  // a hole of void
    return std::round(body(Vec3d(v)));
  };
  const PlainVolume plain(geometry, density);
  const BrickTopology where =
      voxels_of(geometry.dims(), [&](const Vec3i& v) { return density(v).has_value(); });
  const Renderer renderer(
      geometry, grid_of(where, [&](const Vec3d& p) { return density(Vec3i(p)).value(); }));
  TransferFunction f;
  f.opacity = {{200, 0}, {500, 0.2}, {800, 0.05}, {1000, 0.3}};
  f.colour = {{200, {0.9, 0.2, 0.1}}, {700, {0.2, 0.8, 0.3}}, {1000, {1, 1, 1}}};
  RenderSettings settings = small_picture(40, 0.5);
  settings.lighting.model = ShadingModel::none;
  settings.stride = 1;
  settings.early_termination = 1;
  const Vec3d spacing = geometry.spacing_mm();
  const double step_mm = 0.5 * std::min({spacing.x, spacing.y, spacing.z});
  double densest = 0;
  for (const char* view : {"anterior", "superior"}) {
    const Camera camera = default_camera(geometry, 1, view);
    const FloatImage picture = renderer.render_float(camera, f, settings);
    for (std::size_t n = 0; n < picture.pixel_count(); ++n) {
      const Ray ray = camera_ray(camera, 40, 40, double(n % 40) + 0.5, double(n / 40) + 0.5);
      const std::array<double, 4> expected = plain.march(ray, f, step_mm);
      densest = std::max(densest, expected[3]);
      for (std::size_t c = 0; c < 4; ++c) {
        ASSERT_NEAR(picture.rgba[4 * n + c], expected[c], 2e-3) << n % 40 << " " << n / 40;
      }
    }
  }
  EXPECT_GT(densest, 0.8);
}

}  // namespace
}  // namespace supple
