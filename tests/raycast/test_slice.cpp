// Orthogonal slices: every pixel is a voxel, and the patient lies as radiologists expect.
#include <gtest/gtest.h>

#include "raycast/drawings/slice.h"
#include "tests/raycast/scenes.h"
#include "volumes/grid/volume.h"

namespace supple {
namespace {

/// A density per place in mm of the patient, so that storages of one anatomy can be compared.
double anatomy(const Vec3d& lps) {
  return 100 + 3 * lps.x + 5 * lps.y + 7 * lps.z;
}

DensityAt density_of(const Geometry& geometry) {
  return
      [&geometry](const Vec3d& index) { return float(anatomy(geometry.world_from_index(index))); };
}

SliceStyle window() {
  SliceStyle style;
  style.grey_lo = -100;
  style.grey_hi = 300;
  return style;
}

int grey(const Image& image, int x, int y) {
  return image.rgba[4 * (std::size_t(y) * image.width + x)];
}

TEST(UnitSlice, PixelsAreVoxelsAndLieAsRadiologistsExpect) {
  const Geometry geometry({11, 9, 7}, {-5, -4, -3}, {Vec3d(1, 0, 0), {0, 1, 0}, {0, 0, 1}});
  const Vec3d through(3, 6, 2);
  struct Case {
    SlicePlane plane;
    int width, height;
    Vec3d top_left, right, down;  // LPS
  };
  const Case cases[] = {{SlicePlane::axial, 11, 9, {-5, -4, -1}, {1, 0, 0}, {0, 1, 0}},
                        {SlicePlane::coronal, 11, 7, {-5, 2, 3}, {1, 0, 0}, {0, 0, -1}},
                        {SlicePlane::sagittal, 9, 7, {-2, -4, 3}, {0, 1, 0}, {0, 0, -1}}};
  for (const Case& c : cases) {
    const Geometry slice = slice_grid(geometry, c.plane, through, 1);
    const Image image = draw_slice(geometry, slice, density_of(geometry), window());
    ASSERT_EQ(image.width, c.width);
    ASSERT_EQ(image.height, c.height);
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        const double density = anatomy(c.top_left + c.right * double(x) + c.down * double(y));
        ASSERT_NEAR(grey(image, x, y), (density + 100) / 400 * 255, 0.51) << x << " " << y;
      }
    }
  }
}

TEST(UnitSlice, LeftHandedAndPermutedStoragesShowTheSamePatient) {
  const Geometry plain({8, 8, 8}, {-3.5, -3.5, -3.5}, {Vec3d(1, 0, 0), {0, 1, 0}, {0, 0, 1}});
  const Geometry storages[] = {
      {{8, 8, 8}, {3.5, -3.5, -3.5}, {Vec3d(-1, 0, 0), {0, 1, 0}, {0, 0, 1}}},
      {{8, 8, 8}, {-3.5, 3.5, 3.5}, {Vec3d(1, 0, 0), {0, -1, 0}, {0, 0, -1}}},
      {{8, 8, 8}, {-3.5, -3.5, -3.5}, {Vec3d(0, 0, 1), {1, 0, 0}, {0, 1, 0}}}};
  const Vec3d place(0.5, -1.5, 2.5);
  for (const SlicePlane plane : {SlicePlane::axial, SlicePlane::coronal, SlicePlane::sagittal}) {
    const Image expected =
        draw_slice(plain, slice_grid(plain, plane, plain.index_from_world(place), 0.5),
                   density_of(plain), window());
    EXPECT_EQ(expected.width, 15);
    for (const Geometry& storage : storages) {
      const Geometry slice = slice_grid(storage, plane, storage.index_from_world(place), 0.5);
      EXPECT_EQ(draw_slice(storage, slice, density_of(storage), window()).rgba, expected.rgba);
    }
  }
}

TEST(UnitSlice, PixelsAreSquareOnShearedGridsAndInThePlaneOfItsVoxels) {
  const Geometry sheared({9, 8, 7}, {3, -2, 1},
                         {Vec3d(0.9, 0.3, 0), {-0.2, -1.1, 0.05}, {0.3, 0.2, 1.4}});
  const Geometry slice = slice_grid(sheared, SlicePlane::axial, {4, 4, 3}, 0.7);
  EXPECT_TRUE(slice.is_orthogonal());
  EXPECT_NEAR(slice.spacing_mm().x, 0.7, 1e-12);
  EXPECT_NEAR(slice.spacing_mm().y, 0.7, 1e-12);
  for (const Vec3d& pixel : {Vec3d(0, 0, 0), Vec3d(8, 2, 0), Vec3d(1, 9, 0)}) {
    EXPECT_NEAR(sheared.index_from_world(slice.world_from_index(pixel)).z, 3, 1e-9);
  }
}

TEST(UnitSlice, TheRimOfTheMaterialIsOnePixelWide) {
  const Geometry geometry({12, 12, 12}, {0, 0, 0}, {Vec3d(1, 0, 0), {0, 1, 0}, {0, 0, 1}});
  const BrickTopology box = voxels_of(
      {12, 12, 12}, [](const Vec3i& v) { return v.x >= 3 && v.x <= 8 && v.y >= 4 && v.y <= 7; });
  SliceStyle style = window();
  style.rest = &box;
  const Geometry slice = slice_grid(geometry, SlicePlane::axial, {5, 5, 5}, 1);
  const Image image = draw_slice(
      geometry, slice, [](const Vec3d&) { return 0.0f; }, style);
  for (int y = 0; y < 12; ++y) {
    for (int x = 0; x < 12; ++x) {
      const bool inside = x >= 3 && x <= 8 && y >= 4 && y <= 7;
      const bool core = x >= 4 && x <= 7 && y >= 5 && y <= 6;
      const std::uint8_t* pixel = &image.rgba[4 * (y * 12 + x)];
      EXPECT_EQ(pixel[0] == 255 && pixel[1] == 200 && pixel[2] == 0, inside && !core);
    }
  }
}

TEST(UnitSlice, PicturesLieSideBySideOnBlack) {
  Image a(2, 3), b(4, 1);
  std::fill(a.rgba.begin(), a.rgba.end(), std::uint8_t(255));
  std::fill(b.rgba.begin(), b.rgba.end(), std::uint8_t(255));
  const Image all = side_by_side({a, b}, 1);
  ASSERT_EQ(all.width, 7);
  ASSERT_EQ(all.height, 3);
  for (int y = 0; y < 3; ++y) {
    for (int x = 0; x < 7; ++x) {
      EXPECT_EQ(grey(all, x, y), x < 2 || (x > 2 && y == 0) ? 255 : 0);
      EXPECT_EQ(all.rgba[4 * (y * 7 + x) + 3], 255);
    }
  }
}

TEST(UnitSlice, WhatIsNoSliceIsRefused) {
  const Geometry geometry = cube_geometry(8);
  const auto grid = [&](const Vec3d& at, double pixel) {
    return slice_grid(geometry, SlicePlane::axial, at, pixel);
  };
  EXPECT_THROW(grid({-0.1, 0, 0}, 1), InputError);
  EXPECT_THROW(grid({0, 7.1, 0}, 1), InputError);
  EXPECT_THROW(grid({NAN, 0, 0}, 1), InputError);
  EXPECT_THROW(grid({0, 0, 0}, 0), InputError);
  EXPECT_THROW(grid({0, 0, 0}, 1e-5), InputError);
  SliceStyle style;
  style.grey_lo = style.grey_hi;
  EXPECT_THROW(style.validate(), InputError);
}

}  // namespace
}  // namespace supple
