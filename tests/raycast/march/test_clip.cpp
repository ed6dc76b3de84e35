// Clips and maximum-intensity projection: laws, and brute force along the voxel columns.
#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include "raycast/pictures/compare.h"
#include "tests/raycast/scenes.h"

namespace supple {
namespace {

constexpr int kClipSize = 40;

DensityGrid body_grid() {
  const DensityFunction body = lobed_body(Vec3d(19.5), 13);
  return grid_of(voxels_of(Vec3i(kClipSize), everywhere), body);
}

/// Grey and opacity rise with density, so that the brighter of two pixels is the larger maximum.
TransferFunction maximum_function() {
  TransferFunction f;
  f.blend = Blend::maximum;
  f.opacity = {{0, 0}, {1000, 1}};
  f.colour = {{0, {1, 1, 1}}};
  return f;
}

Clip plane(const Vec3d& point, const Vec3d& normal, ClipKeep keep = ClipKeep::inside,
           ClipSpace space = ClipSpace::deformed) {
  return {{{point, normal}}, keep, space};
}

Image clipped_picture(const Renderer& renderer, const Camera& camera,
                      const TransferFunction& function, const std::vector<Clip>& clips,
                      bool skip = true) {
  RenderSettings settings = small_picture(96);
  settings.clips = clips;
  settings.skip_empty_space = skip;
  return renderer.render(camera, function, settings);
}

TEST(UnitClip, ABoxHoldsExactlyItsVoxelsOnAnObliqueGrid) {
  const Geometry geometry({9, 8, 7}, {3, -2, 1},
                          {Vec3d(0.9, 0.3, 0), {-0.2, -1.1, 0.05}, {0.1, 0.2, 1.4}});
  const Clip inside{box_region(geometry, {6.5, 1.5, 1.5}, {1.5, 5.5, 4.5})};
  Clip outside = inside;
  outside.keep = ClipKeep::outside;
  const IndexClip keeps(inside, geometry), removes(outside, geometry);
  for (int n = 0; n < 9 * 8 * 7; ++n) {
    const Vec3i v(n / 56, n / 7 % 8, n % 7);
    const bool in_box = v.x > 1 && v.x < 7 && v.y > 1 && v.y < 6 && v.z > 1 && v.z < 5;
    EXPECT_EQ(keeps.keeps(Vec3d(v)), in_box) << v.x << " " << v.y << " " << v.z;
    EXPECT_EQ(removes.keeps(Vec3d(v)), !in_box);
  }
}

TEST(UnitClip, WhatIsNoRegionIsRefused) {
  for (const Clip& clip : {Clip{}, plane({0, 0, 0}, {0, 0, 0}), plane({NAN, 0, 0}, {1, 0, 0}),
                           plane({0, 0, 0}, {HUGE_VAL, 0, 0})}) {
    RenderSettings settings = small_picture(8);
    settings.clips = {clip};
    EXPECT_THROW(settings.validate(), InputError);
  }
}

TEST(PropertyClip, WhatCutsNothingChangesNothingAndWhatCutsAllLeavesNothing) {
  const Geometry geometry = cube_geometry(kClipSize);
  const Renderer renderer(geometry, body_grid());
  const Camera camera = default_camera(geometry, 1);
  const Image whole = clipped_picture(renderer, camera, surface_function(), {});
  for (const ClipSpace space : {ClipSpace::source, ClipSpace::deformed}) {
    const Clip far = plane({-500, 0, 0}, {1, 0, 0}, ClipKeep::inside, space);
    const Clip all = plane({-500, 0, 0}, {1, 0, 0}, ClipKeep::outside, space);
    EXPECT_EQ(clipped_picture(renderer, camera, surface_function(), {far}).rgba, whole.rgba);
    const Image nothing = clipped_picture(renderer, camera, surface_function(), {all});
    EXPECT_EQ(std::count(nothing.rgba.begin(), nothing.rgba.end(), 0), 4 * 96 * 96);
  }
}

TEST(PropertyClip, SkippingEmptySpaceDoesNotChangeAClippedPicture) {
  const Geometry geometry = cube_geometry(kClipSize);
  const Renderer renderer(geometry, body_grid());
  for (const TransferFunction& function : {surface_function(), maximum_function()}) {
    for (const ClipKeep keep : {ClipKeep::inside, ClipKeep::outside}) {
      for (const ClipSpace space : {ClipSpace::source, ClipSpace::deformed}) {
        const Clip box{box_region(geometry, {10.2, 3, 18.3}, {30.7, 25.1, 60}), keep, space};
        const Clip oblique = plane({1, 2, 3}, {1, -2, 0.5}, ClipKeep::inside, space);
        const Camera camera = default_camera(geometry, 1, "left");
        EXPECT_EQ(clipped_picture(renderer, camera, function, {box, oblique}, true).rgba,
                  clipped_picture(renderer, camera, function, {box, oblique}, false).rgba);
      }
    }
  }
}

/// Every sample lies in one of two complementary clips: pixel by pixel the whole's maximum is the
/// larger of the parts'.
TEST(PropertyClip, MaximaOfComplementaryPartsMakeTheWhole) {
  const Geometry geometry = cube_geometry(kClipSize);
  const Renderer renderer(geometry, body_grid());
  const Camera camera = default_camera(geometry, 1, "superior");
  const Image whole = clipped_picture(renderer, camera, maximum_function(), {});
  EXPECT_GT(compare(whole, Image(96, 96), true).compared_pixels, 500);
  for (const ClipSpace space : {ClipSpace::source, ClipSpace::deformed}) {
    const auto region = box_region(geometry, {12, 9, 4}, {22.5, 40, 27});
    const Image in =
        clipped_picture(renderer, camera, maximum_function(), {{region, ClipKeep::inside, space}});
    const Image out =
        clipped_picture(renderer, camera, maximum_function(), {{region, ClipKeep::outside, space}});
    int from_in = 0, from_out = 0;
    for (std::size_t n = 3; n < whole.rgba.size(); n += 4) {
      ASSERT_EQ(whole.rgba[n], std::max(in.rgba[n], out.rgba[n])) << n;
      from_in += in.rgba[n] > out.rgba[n];
      from_out += out.rgba[n] > in.rgba[n];
    }
    EXPECT_GT(from_in, 100);
    EXPECT_GT(from_out, 100);
  }
}

/// Rays through the voxel centres meet the largest voxel of their column.
TEST(PropertyMaximum, EqualsBruteForceAlongVoxelColumns) {
  constexpr int kDim = 24;
  const Geometry geometry = cube_geometry(kDim);
  std::mt19937 random(3);
  std::vector<double> densities(kDim * kDim * kDim);
  for (double& density : densities) density = double(random() % 1000);
  // The border is 0: whether a sample at 0 lies in the first cell or before it is rounding.
  const auto at = [&](const Vec3d& p) {
    for (int a = 0; a < 3; ++a) {
      if (p[a] == 0 || p[a] == kDim - 1) return 0.0;
    }
    return densities[(std::size_t(p.x) * kDim + std::size_t(p.y)) * kDim + std::size_t(p.z)];
  };
  const Renderer renderer(geometry, grid_of(voxels_of(Vec3i(kDim), everywhere), at));

  // The view is from anterior: columns along y; to the right, the patient's left (x), and up z.
  Camera camera;
  camera.projection = Projection::orthographic;
  camera.position_lps_mm = {0, -100, 0};
  camera.height_mm = kDim;
  RenderSettings settings = small_picture(kDim, 0.25);
  const Image image = renderer.render(camera, maximum_function(), settings);
  for (int x = 0; x < kDim; ++x) {
    for (int z = 0; z < kDim; ++z) {
      double largest = 0;
      for (int y = 0; y < kDim; ++y) largest = std::max(largest, at(Vec3d(x, y, z)));
      const std::uint8_t* pixel = &image.rgba[4 * ((kDim - 1 - z) * kDim + x)];
      ASSERT_NEAR(pixel[3], largest / 1000 * 255, 1.0) << x << " " << z;
      ASSERT_EQ(pixel[0], pixel[3] > 0 ? 255 : 0);
    }
  }
}

/// A brick of which nothing is opaque still hides what is less dense.
TEST(PropertyMaximum, ATransparentMaximumHidesWhatIsVisible) {
  const Geometry geometry = cube_geometry(32);
  // Slabs along y; some bricks of the dense one, which covers half of the picture, hold no
  // other density.
  const DensityGrid grid = grid_of(voxels_of(Vec3i(32), everywhere), [](const Vec3d& p) {
    if (p.y < 8) return 500.0;
    return p.y >= 16 && p.x < 16 ? 1000.0 : 0.0;
  });
  TransferFunction window = maximum_function();
  window.opacity = {{0, 0}, {400, 1}, {600, 1}, {900, 0}};
  Camera camera;
  camera.projection = Projection::orthographic;
  camera.position_lps_mm = {0, -100, 0};
  camera.height_mm = 32;
  const Image image = Renderer(geometry, grid).render(camera, window, small_picture(32, 0.25));
  const auto alpha = [&](int x, int z) { return int(image.rgba[4 * (z * 32 + x) + 3]); };
  EXPECT_EQ(alpha(5, 16), 0);
  EXPECT_EQ(alpha(25, 16), 255);
}

/// The tissue moves by a constant offset: a clip of the tissue moves along, one of the
/// picture does not.
TEST(PropertyClip, ACutOfTheTissueMovesWithIt) {
  const Geometry geometry = cube_geometry(kClipSize);
  const BrickTopology where = voxels_of(Vec3i(kClipSize), everywhere);
  Renderer renderer(geometry, body_grid());
  // Shown at x is the source at x + o: the tissue moves by 4 voxels towards higher x.
  OffsetField offsets{geometry, {where, {}}, {}};
  offsets.o.vectors = vectors_of(where, Vec3f(-4, 0, 0));
  renderer.set_offsets(&offsets);
  const Camera camera = default_camera(geometry, 1);
  const Clip tissue = plane({2, 0, 0}, {1, 0.3, 0}, ClipKeep::inside, ClipSpace::source);
  const Clip moved = plane({6, 0, 0}, {1, 0.3, 0}), still = plane({2, 0, 0}, {1, 0.3, 0});
  const Image expected = clipped_picture(renderer, camera, surface_function(), {moved});
  EXPECT_GT(
      compare(clipped_picture(renderer, camera, surface_function(), {tissue}), expected, true).ssim,
      0.999);
  EXPECT_LT(
      compare(clipped_picture(renderer, camera, surface_function(), {still}), expected, true).ssim,
      0.97);
}

/// A face that a plane opens is as bright as the plane, however rough the densities behind it.
TEST(PropertyClip, AFaceIsShadedAsAPlane) {
  const Geometry geometry = cube_geometry(kClipSize);
  std::mt19937 random(5);
  const DensityGrid rough = grid_of(voxels_of(Vec3i(kClipSize), everywhere),
                                    [&](const Vec3d&) { return 700.0 + double(random() % 300); });
  TransferFunction function = fog_function(0.9);
  function.specular = 0;
  Camera camera = default_camera(geometry, 1);
  camera.projection = Projection::orthographic;
  camera.height_mm = 20;  // well inside the cube
  for (const ClipSpace space : {ClipSpace::source, ClipSpace::deformed}) {
    for (const bool outside : {false, true}) {
      // Towards the viewer, at anterior, everything is cut away.
      const Clip clip = plane({0, -3, 0}, {0, outside ? -1.0 : 1.0, 0},
                              outside ? ClipKeep::outside : ClipKeep::inside, space);
      const Renderer renderer(geometry, rough);
      const Image image = clipped_picture(renderer, camera, function, {clip});
      int darkest = 255, brightest = 0;
      for (std::size_t n = 0; n < image.rgba.size(); n += 4) {
        darkest = std::min(darkest, int(image.rgba[n]));
        brightest = std::max(brightest, int(image.rgba[n]));
      }
      EXPECT_LE(brightest - darkest, 12) << darkest;
      EXPECT_GT(darkest, 200);
    }
  }
}

}  // namespace
}  // namespace supple
