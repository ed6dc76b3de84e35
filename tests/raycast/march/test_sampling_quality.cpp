// Sampling of rays: blue noise, jitter, classification before and after interpolation.
#include <set>

#include <gtest/gtest.h>

#include "raycast/march/march_pixels.h"
#include "raycast/march/render_context.h"
#include "raycast/pictures/compare.h"
#include "tests/raycast/scenes.h"

namespace supple {
namespace {

/// Mean square of the noise averaged over squares of `side` pixels, its mean left out.
double energy_of_means(const std::function<double(int, int)>& noise, int side) {
  double energy = 0;
  for (int y = 0; y < 64; y += side) {
    for (int x = 0; x < 64; x += side) {
      double sum = 0;
      for (int n = 0; n < side * side; ++n) sum += noise(x + n % side, y + n / side) - 0.5;
      energy += sum * sum;
    }
  }
  return energy;
}

TEST(UnitBlueNoise, ATileHoldsEveryThresholdOnceAndRepeats) {
  std::set<float> values;
  for (int n = 0; n < 64 * 64; ++n) values.insert(blue_noise(n % 64, n / 64));
  EXPECT_EQ(values.size(), 64u * 64u);
  EXPECT_GT(*values.begin(), 0);
  EXPECT_LT(*values.rbegin(), 1);
  EXPECT_EQ(blue_noise(5, 7), blue_noise(5 + 64, 7 + 128));
}

TEST(PropertyBlueNoise, ItHasLittleOfTheLowFrequenciesOfWhiteNoise) {
  std::vector<double> white(64 * 64);
  std::uint32_t state = 1;
  for (double& value : white)
    value = double((state = state * 1664525u + 1013904223u) >> 8) / (1 << 24);
  for (const int side : {4, 8}) {
    const double blue_energy = energy_of_means([](int x, int y) { return blue_noise(x, y); }, side);
    const double white_energy =
        energy_of_means([&](int x, int y) { return white[y * 64 + x]; }, side);
    EXPECT_LT(blue_energy, 0.2 * white_energy) << side;
  }
}

/// A thin bright sheet of densities inside a ramp.
TransferFunction sheet_function() {
  TransferFunction f;
  f.opacity = {{480, 0}, {500, 0.6}, {520, 0}};
  f.colour = {{480, {1, 0.4, 0.1}}, {520, {0.2, 0.5, 1}}};
  f.unit_distance_mm = 0.25;
  return f;
}

Image quality_picture(double step, Classification classification, bool jitter = false,
                      const TransferFunction& function = sheet_function()) {
  const Geometry geometry = cube_geometry(48);
  const DensityGrid grid =
      grid_of(voxels_of({48, 48, 48}, everywhere), lobed_body({24, 24, 24}, 16));
  RenderSettings settings;
  settings.width = settings.height = 96;
  settings.step_voxels = step;
  settings.stride = 1;
  settings.lighting.model = ShadingModel::none;
  settings.classification = classification;
  settings.jitter = jitter;
  return Renderer(geometry, grid).render(default_camera(geometry, 1), function, settings);
}

TEST(UnitSampling, RaysAreLookedAtOncePerVoxelAndAtEveryLongerStep) {
  RenderSettings settings;
  const auto stride_of = [&](double step) {
    settings.set_step(step);
    EXPECT_EQ(settings.step_voxels, step);
    return settings.stride;
  };
  EXPECT_EQ(stride_of(0.01), 16);
  EXPECT_EQ(stride_of(0.1), 10);
  EXPECT_EQ(stride_of(1.0 / 3), 3);
  EXPECT_EQ(stride_of(0.5), 2);
  EXPECT_EQ(stride_of(0.6), 1);
  EXPECT_EQ(stride_of(2), 1);
  settings.set_quality(Quality::accurate);
  EXPECT_EQ(settings.stride, 5);
  EXPECT_EQ(settings.step_voxels, 0.2);
}

TEST(ConvergenceClassification, IntegratedStepsComeNearTheFinePictureWhereSamplesMissTheSheet) {
  const Image fine = quality_picture(0.02, Classification::post);
  const Comparison post = compare(quality_picture(0.5, Classification::post), fine, true);
  const Comparison integrated =
      compare(quality_picture(0.5, Classification::pre_integrated), fine, true);
  EXPECT_GT(integrated.ssim, post.ssim);
  EXPECT_LT(integrated.rmse, 0.3 * post.rmse);
}

TEST(PropertyClassification, FineStepsMakeBothClassificationsTheSamePicture) {
  const Comparison found = compare(quality_picture(0.02, Classification::pre_integrated),
                                   quality_picture(0.02, Classification::post), true);
  EXPECT_GT(found.ssim, 0.999);
}

TEST(PropertyClassification, AWayThroughFogExtinguishesAsTheIntegralSays) {
  TransferFunction f;
  f.opacity = {{0, 0}, {100, 0.5}};
  f.colour = {{0, {0, 0, 0}}, {100, {1, 1, 1}}};
  const SourceBricks source(
      grid_of(voxels_of({8, 8, 8}, everywhere), [](const Vec3d& p) { return 20 * p.x; }));
  const double step = 0.7;
  const Classifier classifier(f, source, step);
  for (const auto& [from, to] :
       {std::pair{10.0, 90.0}, {90.0, 10.0}, {-50.0, 60.0}, {80.0, 180.0}}) {
    double depth = 0, weighted = 0;
    constexpr int kParts = 20000;
    for (int n = 0; n < kParts; ++n) {
      const double density = from + (to - from) * (n + 0.5) / kParts;
      const double extinction = -std::log1p(-f.opacity_at(density));
      depth += extinction * step / kParts;
      weighted += extinction * step / kParts * f.colour_at(density)[0];
    }
    const Float4 found =
        classifier.integrate(float(source.encoded(from)), float(source.encoded(to)));
    EXPECT_NEAR(found[3], 1 - std::exp(-depth), 1e-4);
    EXPECT_NEAR(found[0], weighted / depth, 1e-3);
  }
}

TEST(FaultClassification, GradientOpacityCannotBeIntegratedAhead) {
  TransferFunction f = sheet_function();
  f.gradient_opacity = {{0, 0}, {100, 1}};
  EXPECT_THROW(quality_picture(0.5, Classification::pre_integrated, false, f), InputError);
}

/// Share of the error's variance that the means of 4×4 pixels keep: 1 for wide rings, 1/16 for
/// white noise.
double coherence(const Image& image, const Image& truth) {
  constexpr int kFirst = 32, kSize = 32, kSide = 4;
  const auto error = [&](int x, int y) {
    const std::size_t at = 4ul * ((kFirst + y) * 96 + kFirst + x) + 3;
    return double(image.rgba[at]) - double(truth.rgba[at]);
  };
  double mean = 0, variance = 0, variance_of_means = 0;
  for (int n = 0; n < kSize * kSize; ++n) mean += error(n % kSize, n / kSize) / (kSize * kSize);
  for (int y = 0; y < kSize; y += kSide) {
    for (int x = 0; x < kSize; x += kSide) {
      double sum = 0;
      for (int n = 0; n < kSide * kSide; ++n) {
        const double e = error(x + n % kSide, y + n / kSide) - mean;
        variance += e * e;
        sum += e;
      }
      variance_of_means += sum * sum / (kSide * kSide);
    }
  }
  return variance_of_means / variance;
}

/// A thin sheet that leans a little out of the picture's plane.
Image leaning_sheet(double step, bool jitter) {
  const Geometry geometry = cube_geometry(48);
  const DensityGrid grid = grid_of(voxels_of({48, 48, 48}, everywhere), [](const Vec3d& p) {
    return 500 + 60 * (p.y - 24 + 0.02 * p.x + 0.01 * p.z);
  });
  RenderSettings settings;
  settings.width = settings.height = 96;
  settings.step_voxels = step;
  settings.stride = 1;
  settings.lighting.model = ShadingModel::none;
  settings.jitter = jitter;
  const Camera camera = default_camera(geometry, 1, "anterior", Projection::orthographic);
  return Renderer(geometry, grid).render(camera, sheet_function(), settings);
}

TEST(PropertyJitter, ItTurnsRingsIntoNoiseWithoutPattern) {
  const Image fine = leaning_sheet(0.02, false);
  EXPECT_GT(coherence(leaning_sheet(0.7, false), fine), 0.8);
  EXPECT_LT(coherence(leaning_sheet(0.7, true), fine), 0.1);
}

}  // namespace
}  // namespace supple
