// Orthogonal slices: every pixel is a voxel, and the patient lies as radiologists expect.
#include <gtest/gtest.h>

#include "raycast/drawings/slice.h"
#include "tests/raycast/scenes.h"
#include "volumes/grid/density_grid.h"

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

TEST(UnitSlice, PicturesLieInRowsAtTheTopLeftOfTheirCells) {
  Image a(2, 3), b(4, 1), c(3, 2);
  for (Image* image : {&a, &b, &c}) {
    std::fill(image->rgba.begin(), image->rgba.end(), std::uint8_t(255));
  }
  std::vector<TilePlace> places;
  const Image all = tiled({a, b, c}, 2, 1, &places);
  ASSERT_EQ(all.width, 8);
  ASSERT_EQ(all.height, 6);
  const int lefts[] = {0, 4, 0}, tops[] = {0, 0, 4};
  for (std::size_t n = 0; n < 3; ++n) {
    EXPECT_EQ(places[n].left, lefts[n]);
    EXPECT_EQ(places[n].top, tops[n]);
  }
  for (int y = 0; y < 6; ++y) {
    for (int x = 0; x < 8; ++x) {
      const bool is_covered = (x < 2 && y < 3) || (x >= 4 && y == 0) || (x < 3 && y >= 4);
      EXPECT_EQ(grey(all, x, y), is_covered ? 255 : 0) << x << " " << y;
      EXPECT_EQ(all.rgba[4 * (y * 8 + x) + 3], is_covered ? 255 : 0) << x << " " << y;
    }
  }
}

TEST(UnitSlice, AnObliqueSliceShowsTheDensityOfEachPlace) {
  const Geometry geometry({21, 17, 15}, {-10, -8, -7}, {Vec3d(1, 0, 0), {0, 1, 0}, {0, 0, 1}});
  const Vec3d normal = Vec3d(0.3, -0.8, 0.5).normalized();
  const SliceAxes axes = oblique_axes(normal, {});
  EXPECT_LT((axes.right.cross(axes.down) + normal).length(), 1e-12);  // away from the viewer
  EXPECT_LT(axes.down.z, 0);                                          // superior is up
  const Geometry slice = slice_grid(geometry, axes, {12, 8, 6}, 0.5);
  const Image image = draw_slice(geometry, slice, density_of(geometry), window());
  int inside = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const Vec3d place = slice.world_from_index(Vec3d(x, y, 0));
      EXPECT_NEAR((place - geometry.world_from_index({12, 8, 6})).dot(normal), 0, 1e-9);
      const bool is_inside =
          std::abs(place.x) <= 10.5 && std::abs(place.y) <= 8.5 && std::abs(place.z) <= 7.5;
      ASSERT_EQ(image.rgba[4 * (std::size_t(y) * image.width + x) + 3], is_inside ? 255 : 0);
      if (!is_inside) continue;
      ++inside;
      const double share = std::clamp((anatomy(place) + 100) / 400, 0.0, 1.0);
      ASSERT_NEAR(grey(image, x, y), share * 255, 0.51);
    }
  }
  EXPECT_GT(inside, 500);
}

TEST(UnitSlice, AnObliqueSliceAlongAnAxisIsTheOrthogonalOne) {
  const Geometry geometry({12, 10, 8}, {0, 0, 0}, {Vec3d(1, 0, 0), {0, 1, 0}, {0, 0, 1.5}});
  const std::pair<SlicePlane, Vec3d> cases[] = {{SlicePlane::axial, {0, 0, -2}},
                                                {SlicePlane::coronal, {0, -1, 0}},
                                                {SlicePlane::sagittal, {1, 0, 0}}};
  for (const auto& [plane, normal] : cases) {
    EXPECT_EQ(slice_grid(geometry, plane, {5, 4, 3}, 0.5),
              slice_grid(geometry, oblique_axes(normal, {}), {5, 4, 3}, 0.5));
  }
  EXPECT_THROW(oblique_axes({0, 0, 0}, {}), InputError);
  EXPECT_THROW(oblique_axes({0, 0, 1}, Vec3d(0, 0, 2)), InputError);
}

TEST(UnitSlice, ASlabGathersAlongItsThickness) {
  const Geometry geometry({9, 9, 9}, {0, 0, 0}, {Vec3d(1, 0, 0), {0, 1, 0}, {0, 0, 1}});
  // Quadratic along the line of sight: mean, largest and least differ.
  const DensityAt bowl = [](const Vec3d& index) { return float(index.z * index.z); };
  SliceStyle style;
  style.grey_lo = 0;
  style.grey_hi = 255;
  style.thickness_mm = 4;
  const Geometry slice = slice_grid(geometry, SlicePlane::axial, {4, 4, 4}, 1);
  const auto shown = [&](SlabMode mode) {
    style.slab = mode;
    return grey(draw_slice(geometry, slice, bowl, style), 3, 3);
  };
  // Samples in the middle of four parts: at 2.5, 3.5, 4.5 and 5.5.
  EXPECT_EQ(shown(SlabMode::mean), 17);  // 17.25
  EXPECT_EQ(shown(SlabMode::maximum), 30);
  EXPECT_EQ(shown(SlabMode::minimum), 6);
  style.thickness_mm = 0;
  EXPECT_EQ(shown(SlabMode::mean), 16);
  // Only what lies inside counts at the border: -1.5 does not, -0.5, 0.5 and 1.5 do.
  style.thickness_mm = 4;
  const Geometry border = slice_grid(geometry, SlicePlane::axial, {4, 4, 0}, 1);
  style.slab = SlabMode::maximum;
  EXPECT_EQ(grey(draw_slice(geometry, border, bowl, style), 3, 3), 2);
  style.grey_hi = 2.55;
  style.slab = SlabMode::mean;
  EXPECT_EQ(grey(draw_slice(geometry, border, bowl, style), 3, 3), 92);  // 2.75 / 3
}

TEST(UnitSlice, StackedSlicesLieEvenlyInTheVolume) {
  const Geometry geometry({9, 9, 21}, {0, 0, 0}, {Vec3d(1, 0, 0), {0, 1, 0}, {0, 0, 2}});
  const SliceAxes axes = slice_axes(geometry, SlicePlane::axial);
  const std::vector<Vec3d> even = stacked_places(geometry, axes, {4, 4, 3}, 5, {});
  ASSERT_EQ(even.size(), 5u);
  for (int n = 0; n < 5; ++n) EXPECT_NEAR(even[std::size_t(n)].z, 2 + 4 * n, 1e-9);
  // 12 mm apart about the place; those beyond the box are left out.
  const std::vector<Vec3d> apart = stacked_places(geometry, axes, {4, 4, 3}, 3, 12.0);
  ASSERT_EQ(apart.size(), 2u);
  EXPECT_NEAR(apart[0].z, 3, 1e-9);
  EXPECT_NEAR(apart[1].z, 9, 1e-9);
}

TEST(UnitSlice, LabelsAreOutlinedWhereTheTissueHasGone) {
  const Geometry geometry = cube_geometry(16);
  SliceStyle style = window();
  const Vec3d moved(-3, -1, 0);  // from where it is to where it was
  style.rest_place = [&](const Vec3d& index, Vec3d& at_rest) {
    at_rest = index + moved;
    return true;
  };
  const auto is_label = [](const Vec3d& v) { return v.x >= 3 && v.x <= 7 && v.y >= 4 && v.y <= 9; };
  style.label = [&](const Vec3d& at_rest) { return std::int64_t(is_label(at_rest) ? 5 : 0); };
  const Geometry slice = slice_grid(geometry, SlicePlane::axial, {8, 8, 8}, 1);
  const Image image = draw_slice(
      geometry, slice, [](const Vec3d&) { return 0.0f; }, style);
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 16; ++x) {
      const Vec3d index = geometry.index_from_world(slice.world_from_index(Vec3d(x, y, 0))) + moved;
      bool is_rim = false;
      for (const Vec3d& step : {Vec3d(1, 0, 0), {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}}) {
        is_rim = is_rim || !is_label(index + step);
      }
      is_rim = is_rim && is_label(index);
      const std::uint8_t* pixel = &image.rgba[4 * (std::size_t(y) * 16 + x)];
      EXPECT_EQ(std::equal(pixel, pixel + 3, label_colour(5).begin()), is_rim) << x << " " << y;
    }
  }
}

TEST(UnitSlice, TheGridBendsWithTheTissue) {
  const Geometry geometry = cube_geometry(32);
  SliceStyle style = window();
  style.grid_mm = 8 * geometry.spacing_mm().x;
  style.rest_place = [](const Vec3d& index, Vec3d& at_rest) {
    at_rest = index + Vec3d(-0.25 * index.y, 0, 0);  // sheared
    return true;
  };
  const Geometry slice = slice_grid(geometry, SlicePlane::axial, {16, 16, 16}, 1);
  const Image image = draw_slice(
      geometry, slice, [](const Vec3d&) { return 0.0f; }, style);
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 32; ++x) {
      const Vec3d index = geometry.index_from_world(slice.world_from_index(Vec3d(x, y, 0)));
      const double i = index.x - 0.25 * index.y;
      const bool on_line = std::abs(i - 8 * std::round(i / 8)) < 1e-6 ||
                           std::abs(index.y - 8 * std::round(index.y / 8)) < 1e-6;
      const bool far = std::abs(i - 8 * std::round(i / 8)) > 1.1 &&
                       std::abs(index.y - 8 * std::round(index.y / 8)) > 1.1;
      const std::uint8_t* pixel = &image.rgba[4 * (std::size_t(y) * 32 + x)];
      if (on_line) {
        EXPECT_TRUE(std::equal(pixel, pixel + 3, style.grid.begin())) << x << " " << y;
      }
      if (far) {
        EXPECT_EQ(pixel[0], pixel[2]) << x << " " << y;
      }
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
