// Colours over slices and pictures: which pixels are painted, with what, and the gradients of which
// det F is told.
#include <cmath>

#include <gtest/gtest.h>

#include "raycast/drawings/painted_values.h"

using namespace supple;

namespace {

const Geometry kGrid({8, 6, 4}, {10, -20, 5}, {Vec3d(2, 0, 0), {0, 1, 0}, {0, 0, 1}});

/// Greys of 100, opaque but for the first column.
Image grey_slice() {
  Image image(8, 6);
  for (std::size_t n = 0; n < image.rgba.size(); ++n) image.rgba[n] = n % 4 == 3 ? 255 : 100;
  for (std::size_t y = 0; y < 6; ++y) image.rgba[4 * 8 * y + 3] = 0;
  return image;
}

/// The values are the voxels' first indices, known from 3 on.
ValuePaint columns_paint() {
  return {[](const Vec3d& index) {
            return index.x < 2.5 ? std::nullopt : std::optional<double>(index.x);
          },
          {3, 6},
          ValueColours::ascending};
}

}  // namespace

TEST(UnitPaintedValues, OpaquePixelsWithAValueTakeItsColour) {
  Image slice = grey_slice();
  const Geometry plane({8, 6, 1}, kGrid.world_from_index({0, 0, 2}), kGrid.axes_mm());
  paint_values(slice, plane, columns_paint(), kGrid);
  for (int y = 0; y < 6; ++y) {
    for (int x = 0; x < 8; ++x) {
      const Rgb colour = offset_colour(std::clamp((x - 3) / 3.0, 0., 1.));
      for (int c = 0; c < 3; ++c) {
        const double expected = x < 3 ? 100 : 0.45 * 100 + 0.55 * 255 * colour[std::size_t(c)];
        EXPECT_NEAR(slice.rgba[4 * std::size_t(y * 8 + x) + std::size_t(c)], expected, 0.5001);
      }
    }
  }
}

TEST(UnitPaintedValues, ATransparentPixelStays) {
  Image slice = grey_slice();
  const Geometry plane({8, 6, 1}, kGrid.world_from_index({0, 0, 2}), kGrid.axes_mm());
  ValuePaint everywhere = columns_paint();
  everywhere.value = [](const Vec3d&) { return std::optional<double>(5); };
  paint_values(slice, plane, everywhere, kGrid);
  EXPECT_EQ(slice.rgba[0], 100);
  EXPECT_NE(slice.rgba[4], 100);
}

TEST(UnitPaintedValues, WhatIsSeenInSpaceIsPaintedWhereItLiesAndSurfacesAreNot) {
  // A camera that looks along +k; pixels are a voxel of kGrid apart along the axis of 1 mm.
  Camera camera;
  camera.projection = Projection::orthographic;
  camera.target_lps_mm = kGrid.world_from_index({3.5, 2.5, 1});
  camera.position_lps_mm = camera.target_lps_mm - Vec3d(0, 0, 100);
  camera.up_lps = {0, -1, 0};
  camera.height_mm = 6;
  FloatImage picture(6, 6);
  picture.depth_mm.assign(36, 100);
  picture.surface.assign(36, -1);
  for (std::size_t n = 0; n < 36; ++n) {
    for (std::size_t c = 0; c < 4; ++c) picture.rgba[4 * n + c] = c == 1 ? 0.5f : 0.25f;
  }
  picture.depth_mm[0] = std::nanf("");
  picture.surface[1] = 0;
  std::array<Vec3d, 36> seen;
  ValuePaint paint{[&](const Vec3d& index) {
                     const Vec3d pixel = kGrid.world_from_index(index) - camera.target_lps_mm;
                     const int x =
                         int(std::lround(2.5 + std::abs(pixel.x) * (pixel.x < 0 ? -1 : 1)));
                     seen[std::size_t(std::lround(2.5 + pixel.y)) * 6 + std::size_t(x)] = index;
                     return std::optional<double>(0.25);
                   },
                   {0, 1},
                   ValueColours::about_middle};
  paint_values(picture, camera, paint, kGrid);
  const Rgb colour = value_colour(ValueColours::about_middle, 0.25);
  for (std::size_t n = 0; n < 36; ++n) {
    const bool is_painted = n > 1;
    for (std::size_t c = 0; c < 3; ++c) {
      const double plain = c == 1 ? 0.5 : 0.25;
      const double expected = is_painted ? 0.45 * plain + 0.55 * 0.5 * colour[c] : plain;
      EXPECT_NEAR(picture.rgba[4 * n + c], expected, 1e-6) << n;
    }
  }
  EXPECT_NEAR(seen[14].z, 1, 1e-9);  // at the depth of the target
}

TEST(UnitPaintedValues, ColoursAboutAMiddleAreGreyThere) {
  const Rgb middle = value_colour(ValueColours::about_middle, 0.5);
  EXPECT_EQ(middle[0], middle[1]);
  EXPECT_EQ(middle[1], middle[2]);
  EXPECT_GT(value_colour(ValueColours::about_middle, 0)[2], 0.8);  // blue
  EXPECT_GT(value_colour(ValueColours::about_middle, 1)[0], 0.8);  // red
}

TEST(UnitPaintedValues, TheGradientOfAnAffineMotionIsItsMatrix) {
  // x = F X with det F = 1.2 * 0.9 * 1.1; rest places are its inverse.
  const RestPlaceAt rest = [](const Vec3d& x, Vec3d& at_rest) {
    at_rest = {(x.x - 0.3 * x.y / 0.9) / 1.2, x.y / 0.9, x.z / 1.1};
    return x.x < 100;
  };
  const auto f = deformation_at(rest, {3, 4, 5});
  ASSERT_TRUE(f);
  EXPECT_NEAR(determinant(*f), 1.2 * 0.9 * 1.1, 1e-12);
  EXPECT_NEAR((*f)[1].x, 0.3, 1e-12);
  EXPECT_NEAR((*f)[0].x, 1.2, 1e-12);
  EXPECT_FALSE(deformation_at(rest, {99.8, 4, 5}));
}
