// Volumes, cameras and offsets at the edges of what is allowed.
#include <limits>

#include <gtest/gtest.h>

#include "tests/raycast/scenes.h"

namespace supple {
namespace {

int visible_pixels(const Image& image) {
  int count = 0;
  for (std::size_t n = 3; n < image.rgba.size(); n += 4) count += image.rgba[n] > 0;
  return count;
}

Image render_default(const Geometry& geometry, const DensityGrid& grid,
                     const RenderSettings& settings = small_picture(32)) {
  return Renderer(geometry, grid).render(default_camera(geometry, 1), fog_function(0.9), settings);
}

DensityGrid full(const Vec3i& dims, double value = 10) {
  return grid_of(voxels_of(dims, everywhere), [=](const Vec3d&) { return value; });
}

TEST(ExtremesRender, VolumesWithoutACellAreEmptyPictures) {
  EXPECT_EQ(visible_pixels(render_default(Geometry(), full({1, 1, 1}))), 0);
  EXPECT_EQ(visible_pixels(render_default(cube_geometry(16), DensityGrid())), 0);
  const Geometry slice({20, 20, 1}, {0, 0, 0}, {Vec3d(1, 0, 0), {0, 1, 0}, {0, 0, 1}});
  EXPECT_EQ(visible_pixels(render_default(slice, full({20, 20, 1}))), 0);
}

TEST(ExtremesRender, ASlabOfOneCellIsSeen) {
  const Geometry geometry({16, 2, 16}, {0, 0, 0}, {Vec3d(1, 0, 0), {0, 1, 0}, {0, 0, 1}});
  RenderSettings settings = small_picture(32, 0.25);
  settings.stride = 1;
  EXPECT_GT(visible_pixels(render_default(geometry, full({16, 2, 16}), settings)), 500);
}

TEST(ExtremesRender, TheCameraMayStandInsideTheVolume) {
  const Geometry geometry = cube_geometry(16);
  const Renderer renderer(geometry, full({16, 16, 16}));
  Camera camera = default_camera(geometry, 1);
  camera.position_lps_mm = {0.3, 0.1, -0.2};
  camera.target_lps_mm = {0.3, 9, 1};
  EXPECT_EQ(visible_pixels(renderer.render(camera, fog_function(0.9), small_picture(20))), 400);
  camera.position_lps_mm = {0, 20, 0};  // behind it, looking away
  camera.target_lps_mm = {0, 40, 0};
  EXPECT_EQ(visible_pixels(renderer.render(camera, fog_function(0.9), small_picture(20))), 0);
}

TEST(ExtremesRender, RaysAlongAGridPlaneAndHugeStepsStayFinite) {
  const Geometry geometry = cube_geometry(17);  // voxel centres at integers
  const Renderer renderer(geometry, full({17, 17, 17}));
  Camera camera = default_camera(geometry, 1, "left", Projection::orthographic);
  camera.height_mm = 8;
  for (const double step : {0.01, 0.5, 16.0}) {
    RenderSettings settings = small_picture(8, step);
    settings.stride = 1;
    const Image image = renderer.render(camera, fog_function(0.9), settings);
    if (step < 16) {
      EXPECT_EQ(visible_pixels(image), 64) << "step " << step;
    }
  }
}

TEST(ExtremesRender, SpacingsFromMicrometresToMetresGiveTheSamePicture) {
  const DensityGrid grid = grid_of(voxels_of({16, 16, 16}, everywhere), lobed_body(Vec3d(7.5), 5));
  Image first;
  for (const double spacing : {1.0, 1e-6, 1e6}) {
    const Geometry geometry = cube_geometry(16, spacing);
    TransferFunction f = surface_function();
    f.unit_distance_mm = spacing;
    const Image image =
        Renderer(geometry, grid).render(default_camera(geometry, 1), f, small_picture(48));
    if (first.width == 0) first = image;
    ASSERT_GT(visible_pixels(image), 200);
    for (std::size_t n = 0; n < image.rgba.size(); ++n) {
      ASSERT_NEAR(image.rgba[n], first.rgba[n], 1) << "spacing " << spacing;
    }
  }
}

TEST(ExtremesRender, OffsetsThatLeadNowhereAreEmptyAndNotANumberIsVoid) {
  const Geometry geometry = cube_geometry(16);
  const DensityGrid grid = full({16, 16, 16});
  Renderer renderer(geometry, grid);
  const BrickTopology& where = grid.bricks();
  for (const float far : {1e4f, 1e30f, std::numeric_limits<float>::infinity(),
                          std::numeric_limits<float>::quiet_NaN()}) {
    const OffsetField offsets{geometry, {where, vectors_of(where, Vec3f(0, far, 0))}, {}};
    renderer.set_offsets(&offsets);
    EXPECT_EQ(visible_pixels(renderer.render(default_camera(geometry, 1), fog_function(0.9),
                                             small_picture(16))),
              0);
  }
  const DensityGrid broken = grid_of(voxels_of({16, 16, 16}, everywhere), [](const Vec3d& p) {
    return p.x < 8 ? std::numeric_limits<double>::quiet_NaN() : 5.0;
  });
  const int seen = visible_pixels(render_default(geometry, broken));
  EXPECT_GT(seen, 50);
  EXPECT_LT(seen, visible_pixels(render_default(geometry, full({16, 16, 16}))));
}

TEST(ExtremesRender, FractionalDensitiesOfATinyRangeKeepTheirContrast) {
  const Geometry geometry = cube_geometry(16);
  const DensityGrid grid = grid_of(voxels_of({16, 16, 16}, everywhere),
                                   [](const Vec3d& p) { return p.z < 8 ? 1e-3 : 2e-3; });
  TransferFunction f = fog_function(0.9);
  f.opacity = {{1.4e-3, 0}, {1.6e-3, 0.9}};
  const Image image =
      Renderer(geometry, grid).render(default_camera(geometry, 1), f, small_picture(32));
  EXPECT_GT(image.rgba[4 * (8 * 32 + 16) + 3], 200);
  EXPECT_EQ(image.rgba[4 * (24 * 32 + 16) + 3], 0);
}

}  // namespace
}  // namespace supple
