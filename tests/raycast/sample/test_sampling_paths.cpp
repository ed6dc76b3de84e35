// Bodies seen along procedural sampling paths (thesis section 3.3.5, figure 3.3).
#include <gtest/gtest.h>

#include "raycast/pictures/compare.h"
#include "tests/raycast/scenes.h"
#include "tests/support/sanitized.h"
#include "volumes/field/paths/path_functions.h"

namespace supple {
namespace {

constexpr int kPathSize = 40;

/// A slab of constant density, 17 nodes thick along y: 16 cells.
DensityGrid slab() {
  return grid_of(
      voxels_of({kPathSize, kPathSize, kPathSize},
                [](const Vec3i& v) { return v.y >= 12 && v.y <= 28 && v.x >= 4 && v.x < 36; }),
      [](const Vec3d&) { return 100; });
}

Image path_picture(const Geometry& geometry, const DensityGrid& grid, const OffsetField* offsets,
                   const TransferFunction& function, const std::string& view, int size = 80) {
  Renderer renderer(geometry, grid);
  renderer.set_offsets(offsets);
  const Camera camera = default_camera(geometry, 1, view, Projection::orthographic);
  RenderSettings settings = small_picture(size);
  settings.early_termination = 1;
  return renderer.render(camera, function, settings);
}

std::uint8_t alpha(const Image& image, int x, int y) {
  return image.rgba[4 * (std::size_t(y) * image.width + x) + 3];
}

TEST(PropertySamplingPaths, APathThatMovesNothingGivesTheStraightPictureBitForBit) {
  const Geometry geometry({kPathSize, kPathSize, kPathSize}, {3, -2, 1},
                          {Vec3d(0.9, 0.1, 0), {0, -1.1, 0.05}, {0, 0.2, 1.4}});
  const DensityGrid grid =
      grid_of(voxels_of(geometry.dims(), everywhere), lobed_body(Vec3d(19), 13));
  const SamplingPath path = {make_twist({{{0, 0, 0}, {0, 0, 1}, 1000, 1100}, 90}),
                             make_taper({{{0, 0, 0}, {1, 0, 0}, 1000, 1100}, 0.5})};
  const OffsetField field = follow_path(path, geometry, grid.bricks());
  for (const char* view : {"anterior", "left"}) {
    const Image straight = path_picture(geometry, grid, nullptr, surface_function(), view);
    EXPECT_EQ(path_picture(geometry, grid, &field, surface_function(), view).rgba, straight.rgba);
  }
}

TEST(PropertySamplingPaths, AnOpenedSlabIsEmptyInTheGapAndWholeBesideIt) {
  // Opened by 10 mm across the view: 39.5 mm / 80 pixels; the camera's margin is in the
  // picture.
  const Geometry geometry = cube_geometry(kPathSize);
  const DensityGrid grid = slab();
  TransferFunction fog = fog_function(0.1);
  const OffsetField field =
      follow_path({make_cut_open({{0.3, 0, 0}, {1, 0, 0}, 10})}, geometry, grid.bricks());
  ASSERT_NE(field.split, nullptr);
  const Image image = path_picture(geometry, grid, &field, fog, "anterior");
  const double mm_per_pixel =
      default_camera(geometry, 1, "anterior", Projection::orthographic).height_mm / 80;
  const int whole = int(std::lround(255 * (1 - std::pow(0.9, 16))));
  int wrong = 0, in_gap = 0, beside = 0;
  for (int x = 0; x < 80; ++x) {
    const double mm = (x + 0.5 - 40) * mm_per_pixel;
    const double from_gap = std::abs(mm - 0.3) - 5;
    const int found = alpha(image, x, 40);
    if (from_gap < 0) {
      ++in_gap;
      wrong += found != 0;
    } else if (from_gap > 0 && from_gap < 11) {
      ++beside;
      wrong += std::abs(found - whole) > 1;
    }
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(in_gap, 12);
  EXPECT_GT(beside, 20);

  OffsetField smeared = field;
  smeared.split = nullptr;
  const Image without = path_picture(geometry, grid, &smeared, fog, "anterior");
  EXPECT_LT(compare(image, without, false).ssim, 0.999);
}

TEST(PropertySamplingPaths, OpeningAlongTheViewKeepsTheLengthOfTissueOnARay) {
  const Geometry geometry = cube_geometry(kPathSize);
  const DensityGrid grid = slab();
  const TransferFunction fog = fog_function(0.1);
  const OffsetField field =
      follow_path({make_cut_open({{0, 0.2, 0}, {0, 1, 0}, 7})}, geometry, grid.bricks());
  const Image image = path_picture(geometry, grid, &field, fog, "anterior", 21);
  EXPECT_NEAR(alpha(image, 10, 10), 255 * (1 - std::pow(0.9, 16)), 3);
}

TEST(PropertySamplingPaths, AFaceIsShadedAsAFaceHoweverTheTissueBehindItLooks) {
  // Densities rise along z, so that their gradients lie in the face that is seen straight on.
  const Geometry geometry = cube_geometry(kPathSize);
  const DensityGrid grid = grid_of(voxels_of(geometry.dims(), everywhere),
                                   [](const Vec3d& p) { return 400 + 10 * p.z; });
  TransferFunction function = fog_function(0.99);
  function.full_shading_gradient = 5;
  function.ambient = 0, function.diffuse = 1, function.specular = 0;
  // Opened by half a turn about its edge at the right, so that both faces look to the left.
  const OffsetField field =
      follow_path({make_cut_open({{0, 0, 0}, {0, 1, 0}, 0, 180, {-20, 0, 0}, {0, 0, 1}})}, geometry,
                  grid.bricks());
  const Image image = path_picture(geometry, grid, &field, function, "left", 40);
  const double facing = 1 / std::sqrt(1 + 0.35 * 0.35 + 0.25 * 0.25);  // the light beside the eye
  for (const int x : {6, 12, 28, 34}) {
    for (const int y : {10, 20, 30}) {
      EXPECT_NEAR(image.rgba[4 * (std::size_t(y) * 40 + std::size_t(x))], 255 * facing, 2);
    }
  }
}

TEST(PropertySamplingPaths, SkippingEmptySpaceDoesNotChangeAnExplodedPicture) {
  LEFT_OUT_WHEN_SANITIZED();
  const Geometry geometry = cube_geometry(kPathSize);
  const DensityGrid grid =
      grid_of(voxels_of(geometry.dims(), everywhere), lobed_body(Vec3d(19.5), 12));
  const OffsetField field =
      follow_path({make_explode({{2, 2, 3}, Vec3d(-0.5), Vec3d(kPathSize - 0.5), 6}, geometry),
                   make_twist({{{0, 0, 0}, {0, 0, 1}, -20, 20}, 40})},
                  geometry, grid.bricks());
  Renderer renderer(geometry, grid);
  renderer.set_offsets(&field);
  for (const int stride : {1, 4}) {
    RenderSettings with = small_picture(64), without = with;
    with.stride = without.stride = stride;
    without.skip_empty_space = false;
    const Camera camera = default_camera(geometry, 1, "left");
    EXPECT_EQ(renderer.render(camera, surface_function(), with).rgba,
              renderer.render(camera, surface_function(), without).rgba);
  }
}

}  // namespace
}  // namespace supple
