// Pose pictures against the deformed volume itself, and convergence in the step.
#include <gtest/gtest.h>

#include "raycast/march/marcher.h"
#include "raycast/pictures/compare.h"
#include "tests/raycast/scenes.h"
#include "tests/support/sanitized.h"
#include "volumes/field/inversion/invert.h"
#include "volumes/field/offset_field.h"
#include "volumes/field/procedural.h"

namespace supple {
namespace {

constexpr int kAccuracySize = 96;
const Vec3d kCentre(47.5, 47.5, 47.5);

struct AccuracyCase {
  const char* name;
  AnalyticWarp warp;
};
std::vector<AccuracyCase> cases() {
  return {{"bump", bump_warp(kCentre + Vec3d(4, 0, 2), 20, 9)},
          {"shear", shear_warp(kCentre, 0.5)},
          {"stretch", stretch_warp(kCentre, 1.35)}};
}

/// The body deformed by ray tracing through offsets, and the deformed body sampled on the grid and
/// rendered straight: f(x + o(x)) in closed form.
class DeformedBody {
 public:
  explicit DeformedBody(const AnalyticWarp& warp)
      : m_geometry(cube_geometry(kAccuracySize)),
        m_body(lobed_body(kCentre, 20)),
        m_elements(
            voxels_of(m_geometry.dims(), [&](const Vec3i& v) { return m_body(Vec3d(v)) > 100; })),
        m_shell(dilate(m_elements, 2)),
        m_source(m_geometry, grid_of(m_shell, m_body)),
        m_expected(m_geometry,
                   grid_of(voxels_of(m_geometry.dims(), everywhere),
                           [&](const Vec3d& x) { return m_body(x + warp.offset_voxels(x)); })) {}

  const Geometry& geometry() const { return m_geometry; }
  const BrickTopology& elements() const { return m_elements; }
  const BrickTopology& shell() const { return m_shell; }

  Comparison judge(const OffsetField& offsets, const RenderSettings& settings) {
    m_source.set_offsets(&offsets);
    const Camera camera = default_camera(m_geometry, 1);
    TransferFunction f = surface_function();
    return compare(m_source.render(camera, f, settings), m_expected.render(camera, f, settings),
                   true);
  }

 private:
  Geometry m_geometry;
  DensityFunction m_body;
  BrickTopology m_elements, m_shell;
  Renderer m_source, m_expected;
};

TEST(PropertyRenderAccuracy, DisplacementsRenderedThroughInversionMatchTheDeformedVolume) {
  for (const AccuracyCase& c : cases()) {
    DeformedBody body(c.warp);
    const Displacement u = sample_displacement(c.warp, body.geometry(), body.elements());
    const OffsetField offsets = invert(extend(u, body.shell()));
    const Comparison result = body.judge(offsets, small_picture(200));
    EXPECT_GE(result.ssim, 0.99) << c.name;
    EXPECT_GT(result.compared_pixels, 2500) << c.name;
  }
}

TEST(PropertyRenderAccuracy, WithoutTheGradientTermShearMissesThatBar) {
  LEFT_OUT_WHEN_SANITIZED();
  DeformedBody body(shear_warp(kCentre, 0.5));
  const OffsetField offsets = sample_offsets(shear_warp(kCentre, 0.5), body.geometry(),
                                             voxels_of(body.geometry().dims(), everywhere));
  RenderSettings settings = small_picture(200);
  EXPECT_GE(body.judge(offsets, settings).ssim, 0.99);
  settings.transform_gradient = false;
  EXPECT_LT(body.judge(offsets, settings).ssim, 0.96);
}

TEST(PropertyRenderAccuracy, OffsetsOfTheWrongSignFailWidely) {
  LEFT_OUT_WHEN_SANITIZED();
  for (const AccuracyCase& c : cases()) {
    DeformedBody body(c.warp);
    OffsetField offsets =
        sample_offsets(c.warp, body.geometry(), voxels_of(body.geometry().dims(), everywhere));
    for_each_stored(offsets.o.vectors, [](Vec3f& v) { v = -v; });
    EXPECT_LT(body.judge(offsets, small_picture(200)).ssim, 0.9) << c.name;
  }
}

/// Least-squares slope of log(error) over log(step).
double slope(const std::vector<double>& steps, const std::vector<double>& errors) {
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  const double n = double(steps.size());
  for (std::size_t k = 0; k < steps.size(); ++k) {
    const double x = std::log(steps[k]), y = std::log(errors[k]);
    sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

RenderSettings every_sample(double step) {
  RenderSettings settings = small_picture(1, step);
  settings.stride = 1;
  settings.lighting.model = ShadingModel::none;
  settings.early_termination = 1;
  return settings;
}

TEST(ConvergenceRender, TheOpacityOfARampConvergesToItsIntegralWithOrderOne) {
  // Opacity per mm a(v) = v along 0 … 0.6: optical depth is the integral of -ln(1 - v).
  const int cells = 20;
  const Geometry geometry = cube_geometry(cells + 1);
  const SourceBricks source(grid_of(voxels_of(geometry.dims(), everywhere),
                                    [](const Vec3d& p) { return 1000 * 0.6 * p.y / cells; }));
  const OffsetBricks straight(source);
  TransferFunction f;
  f.opacity = {{0, 0}, {600, 0.6}};
  f.colour = {{0, {0, 0, 0}}, {600, {1, 1, 1}}};
  f.unit_distance_mm = 4;
  const double depth = (0.4 * std::log(0.4) + 0.6) / 0.6 * cells / f.unit_distance_mm;
  const Camera camera = default_camera(geometry, 1, "anterior", Projection::orthographic);
  const std::vector<double> steps = {1, 0.5, 0.25, 0.125, 0.0625};
  std::vector<double> errors;
  for (const double step : steps) {
    const RenderContext context(geometry, source, straight, camera, f, every_sample(step));
    const Float4 sum = Marcher(context).march(camera_ray(camera, 1, 1, 0.52, 0.47));
    errors.push_back(std::abs(sum[3] - (1 - std::exp(-depth))));
  }
  EXPECT_GT(slope(steps, errors), 0.9);
  EXPECT_LT(slope(steps, errors), 1.1);
  EXPECT_LT(errors.back(), 2e-3);
}

TEST(ConvergenceRender, TheColourOfASphereConvergesWithTheStep) {
  const Geometry geometry = cube_geometry(32);
  const SourceBricks source(
      grid_of(voxels_of(geometry.dims(), everywhere), lobed_body(Vec3d(15.5), 9)));
  const OffsetBricks straight(source);
  TransferFunction f = surface_function();
  f.opacity = {{200, 0}, {900, 0.4}};
  const Camera camera = default_camera(geometry, 1);
  const auto picture = [&](double step) {
    RenderSettings settings = every_sample(step);
    settings.lighting = Lighting();
    const RenderContext context(geometry, source, straight, camera, f, settings);
    Marcher marcher(context);
    std::vector<Float4> pixels;
    for (int n = 0; n < 24 * 24; ++n) {
      pixels.push_back(marcher.march(camera_ray(camera, 24, 24, n % 24 + 0.5, n / 24 + 0.5)));
    }
    return pixels;
  };
  const std::vector<Float4> reference = picture(1.0 / 128);
  const std::vector<double> steps = {1, 0.5, 0.25, 0.125};
  std::vector<double> errors;
  for (const double step : steps) {
    const std::vector<Float4> pixels = picture(step);
    double squares = 0;
    for (std::size_t n = 0; n < pixels.size(); ++n) {
      for (int c = 0; c < 4; ++c) {
        squares += std::pow(double(pixels[n][c]) - double(reference[n][c]), 2);
      }
    }
    errors.push_back(std::sqrt(squares / double(4 * pixels.size())));
  }
  EXPECT_GT(slope(steps, errors), 0.9);
  EXPECT_LT(errors.back(), 5e-3);
}

}  // namespace
}  // namespace supple
