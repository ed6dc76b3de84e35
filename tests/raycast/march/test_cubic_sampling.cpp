// Cubic B-spline densities and gradients: polynomials, one sample at a time, bounds, and
// smoothness.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "raycast/march/render_context.h"
#include "raycast/render.h"
#include "tests/raycast/scenes.h"
#include "volumes/field/procedural.h"
#include "volumes/grid/b_spline.h"

namespace supple {
namespace {

/// A volume without offsets, sampled cubically.
struct CubicScene {
  Geometry geometry = cube_geometry(24);
  SourceBricks source;
  OffsetBricks output{source};
  RenderContext context{geometry,          source,          output, default_camera(geometry, 1),
                        fog_function(0.1), RenderSettings()};

  explicit CubicScene(const DensityGrid& grid, Interpolation interpolation = Interpolation::cubic)
      : source(grid, interpolation) {}

  SampleBatch sampled(const std::vector<Vec3d>& places) const {
    SamplePlaces wanted;
    for (std::size_t n = 0; n < SampleBatch::kLanes; ++n) {
      const Vec3d place = places[std::min(n, places.size() - 1)];
      wanted.x[n] = float(place.x), wanted.y[n] = float(place.y), wanted.z[n] = float(place.z);
    }
    SampleBatch batch;
    sample_places(context.tables, wanted, int(places.size()), batch);
    sample_gradients(context.tables, batch, batch.inside);
    return batch;
  }
};

std::vector<Vec3d> random_places(std::mt19937& random) {
  std::uniform_real_distribution<double> place(4, 18);
  std::vector<Vec3d> places(SampleBatch::kLanes);
  for (Vec3d& p : places) p = {place(random), place(random), place(random)};
  return places;
}

/// Its samples are the polynomial smoothed by the B-spline, which is known: x^2 becomes x^2 + 1/3
/// and x^3 becomes x^3 + x. All densities are integers, so that none is rounded.
TEST(PropertyCubicSampling, PolynomialsUpToTheThirdDegreeAreReadAsTheBSplineReadsThem) {
  const CubicScene scene(grid_of(voxels_of({24, 24, 24}, everywhere), [](const Vec3d& p) {
    return p.x * p.x * p.x - 3 * p.y * p.y + p.x * p.z - 2 * p.x * p.y + 7 * p.z;
  }));
  const auto smooth = [](const Vec3d& p) {
    return p.x * p.x * p.x + p.x - 3 * (p.y * p.y + 1.0 / 3) + p.x * p.z - 2 * p.x * p.y + 7 * p.z;
  };
  const auto gradient = [](const Vec3d& p) {
    return Vec3d(3 * p.x * p.x + 1 + p.z - 2 * p.y, -6 * p.y - 2 * p.x, p.x + 7);
  };
  std::mt19937 random(1);
  for (const std::string& name : sampling_instruction_sets()) {
    choose_sampling_instruction_set(name);
    SCOPED_TRACE(name);
    for (int round = 0; round < 40; ++round) {
      const std::vector<Vec3d> places = random_places(random);
      const SampleBatch batch = scene.sampled(places);
      ASSERT_EQ(batch.inside, 0xFFFFu);
      for (std::size_t n = 0; n < places.size(); ++n) {
        EXPECT_NEAR(scene.source.density(batch.encoded[n]), smooth(places[n]), 0.01);
        const Vec3d want = gradient(places[n]);
        EXPECT_NEAR(batch.gx[n] * scene.source.scale(), want.x, 0.02);
        EXPECT_NEAR(batch.gy[n] * scene.source.scale(), want.y, 0.02);
        EXPECT_NEAR(batch.gz[n] * scene.source.scale(), want.z, 0.02);
      }
    }
  }
  choose_sampling_instruction_set("");
}

/// The weight of a node at a distance, by its definition.
double b_spline(double distance) {
  const double d = std::abs(distance);
  if (d < 1) return 2.0 / 3 - d * d + d * d * d / 2;
  return d < 2 ? (2 - d) * (2 - d) * (2 - d) / 6 : 0;
}

TEST(PropertyCubicSampling, RoughVolumesWithHolesAreTheWeightedSumOfTheirNodes) {
  const BrickTopology where = voxels_of(
      {24, 24, 24}, [](const Vec3i& v) { return (v.x * 7 + v.y * 13 + v.z * 29) % 97 != 0; });
  const DensityGrid grid = grid_of(
      where, [](const Vec3d& p) { return std::floor(300 * std::sin(p.x * 1.7 + p.y * p.z)); });
  const CubicScene scene(grid);
  std::mt19937 random(2);
  int compared = 0, beside_holes = 0;
  for (int round = 0; round < 100; ++round) {
    const std::vector<Vec3d> places = random_places(random);
    const SampleBatch batch = scene.sampled(places);
    for (std::size_t n = 0; n < places.size(); ++n) {
      const Vec3i low = floor_voxel(places[n]);
      double sum = 0, linear = 0, missing = 0;
      bool is_inside = true;
      for (int c = 0; c < 64; ++c) {
        const Vec3i voxel = low + Vec3i(c % 4, c / 4 % 4, c / 16) - Vec3i(1);
        const Vec3d from = places[n] - Vec3d(voxel);
        const double weight = b_spline(from.x) * b_spline(from.y) * b_spline(from.z);
        const bool is_corner = std::max({std::abs(from.x), std::abs(from.y), std::abs(from.z)}) < 1;
        if (!where.is_active(voxel)) {
          missing += weight;
          is_inside = is_inside && !is_corner;
          continue;
        }
        sum += weight * grid.at(voxel);
        if (is_corner) {
          linear += (1 - std::abs(from.x)) * (1 - std::abs(from.y)) * (1 - std::abs(from.z)) *
                    grid.at(voxel);
        }
      }
      ASSERT_EQ(batch.inside >> n & 1, std::uint32_t(is_inside));
      if (!is_inside) continue;
      // The trilinear density stands for nodes that are void.
      EXPECT_NEAR(scene.source.density(batch.encoded[n]), sum + missing * linear, 0.05);
      ++compared;
      beside_holes += missing > 0;
    }
  }
  EXPECT_GT(compared, 1000);
  EXPECT_GT(beside_holes, 100);
}

/// Densities of a body are reached at its voxels, and gradients are those of the densities.
TEST(PropertyCubicSampling, TheInterpolatingSplineIsReadWithItsGradient) {
  const DensityGrid grid = grid_of(voxels_of({24, 24, 24}, everywhere), [](const Vec3d& p) {
    return std::floor(300 * std::sin(0.9 * p.x + 0.02 * p.y * p.z) + 100 * std::cos(1.3 * p.z));
  });
  const CubicScene scene(grid, Interpolation::interpolating);
  const SplineDensity spline(grid, {24, 24, 24}, true);
  std::mt19937 random(6);
  std::uniform_int_distribution<int> voxel(4, 18);
  const double step = 1e-3, code = 2 * scene.source.scale();
  for (int round = 0; round < 40; ++round) {
    std::vector<Vec3d> places = random_places(random);
    for (std::size_t n = 0; n < places.size(); n += 2) {
      places[n] = Vec3d(voxel(random), voxel(random), voxel(random));
    }
    const SampleBatch batch = scene.sampled(places);
    for (std::size_t n = 0; n < places.size(); ++n) {
      const Vec3d& p = places[n];
      const double density = scene.source.density(batch.encoded[n]);
      ASSERT_NEAR(density, spline.at(p), code);
      if (n % 2 == 0) {
        ASSERT_NEAR(density, double(grid.at(floor_voxel(p))), code);
      }
      const float* gradient[] = {batch.gx, batch.gy, batch.gz};
      for (int a = 0; a < 3; ++a) {
        Vec3d ahead = p, behind = p;
        ahead[a] += step, behind[a] -= step;
        const double slope = (spline.at(ahead) - spline.at(behind)) / (2 * step);
        ASSERT_NEAR(gradient[a][n] * scene.source.scale(), slope, 4 * code);
      }
    }
  }
}

/// A ball in thick slices whose density falls off as partial volume lets it.
DensityGrid thick_ball(const Geometry& geometry, double radius_mm) {
  return grid_of(voxels_of(geometry.dims(), everywhere), [=](const Vec3d& index) {
    const double from_surface = radius_mm - geometry.world_from_index(index).length();
    return std::round(std::clamp(1000 * (0.5 + from_surface / 2), 0.0, 1000.0));
  });
}

/// Mean error of a surface's normals at half the density, against the ball's own; degrees.
double mean_normal_error(const Renderer& renderer, const Geometry& geometry) {
  TransferFunction function = fog_function(1);
  function.opacity = {{499, 0}, {500, 1}, {1000, 1}};
  RenderSettings settings = small_picture(120);
  settings.auxiliary = true;
  const Camera camera = default_camera(geometry, 1, "anterior", Projection::orthographic);
  const FloatImage picture = renderer.render_float(camera, function, settings);
  double sum = 0;
  int count = 0;
  for (std::size_t n = 0; n < picture.pixel_count(); ++n) {
    if (std::isnan(picture.depth_mm[n])) continue;
    const std::size_t x = n % 120, y = n / 120;
    const Ray ray = camera_ray(camera, 120, 120, double(x) + 0.5, double(y) + 0.5);
    const Vec3d place = ray.origin_lps_mm + ray.direction_lps * double(picture.depth_mm[n]);
    const float* normal = &picture.normal_lps[3 * n];
    const double cosine = Vec3d(normal[0], normal[1], normal[2]).dot(place.normalized());
    sum += std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / 3.14159265358979;
    ++count;
  }
  EXPECT_GT(count, 2000);
  return sum / count;
}

TEST(PropertyCubicSampling, TerracesOfThickSlicesAreSofter) {
  const Geometry geometry({48, 48, 16}, {-23.5, -23.5, -22.5},
                          {Vec3d(1, 0, 0), {0, 1, 0}, {0, 0, 3}});
  const DensityGrid grid = thick_ball(geometry, 20);
  const double linear = mean_normal_error(Renderer(geometry, grid), geometry);
  const double cubic =
      mean_normal_error(Renderer(geometry, grid, 0, Interpolation::cubic), geometry);
  EXPECT_LT(cubic, 0.75 * linear) << cubic << " degrees, linear " << linear;
}

/// Bricks are skipped by their ranges: those of cubic samples count the voxels of the next brick.
TEST(PropertyCubicSampling, SamplesLieInTheRangesOfTheirBricks) {
  const CubicScene scene(grid_of(voxels_of({24, 24, 24}, everywhere), [](const Vec3d& p) {
    // Peaks in the second voxel of the middle bricks: cubic samples of the bricks before read them.
    return p.x == 9 || p.y == 9 || p.z == 9 ? 1000.0 : 0.0;
  }));
  std::mt19937 random(4);
  int positive = 0;
  for (int round = 0; round < 100; ++round) {
    const std::vector<Vec3d> places = random_places(random);
    const SampleBatch batch = scene.sampled(places);
    for (std::size_t n = 0; n < places.size(); ++n) {
      const std::int32_t b = scene.source.topology().find(floor_voxel(places[n]));
      ASSERT_GE(batch.encoded[n], scene.source.range(std::size_t(b)).lo - 1e-3);
      ASSERT_LE(batch.encoded[n], scene.source.range(std::size_t(b)).hi + 1e-3);
      positive += batch.encoded[n] > 1;
    }
  }
  EXPECT_GT(positive, 200);
}

}  // namespace
}  // namespace supple
