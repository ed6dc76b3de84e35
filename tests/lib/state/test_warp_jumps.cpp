// Smoothness that a warp is said to have.
#include <cmath>

#include <gtest/gtest.h>

#include "lib/state/warp_jumps.h"

using namespace supple;

TEST(UnitWarpJumps, DifferencesAndFoldsByHand) {
  // Steps of 2 mm along i, which runs to the right, 3 mm along j and 5 mm along k.
  const Geometry grid({3, 2, 2}, Vec3d(0), {Vec3d(-2, 0, 0), {0, 3, 0}, {0, 0, 5}});
  WarpJumps jumps(grid);
  // The second point goes 1 mm on, the third 4 mm back: their order turns round once per row.
  const std::vector<Vec3f> row = {{0, 0, 0}, {-1, 0, 0}, {3, 0, 0}};
  std::vector<Vec3f> slice = row;
  slice.insert(slice.end(), row.begin(), row.end());
  jumps.add(slice.data());
  EXPECT_EQ(jumps.largest_mm(), 4);
  EXPECT_EQ(jumps.folded_pairs(), 2);
  // The slice above comes down by 6 mm, beyond the one below it, and so does not fold along i.
  const std::vector<Vec3f> lowered(6, Vec3f(0, 0, -6));
  jumps.add(lowered.data());
  EXPECT_EQ(jumps.folded_pairs(), 2 + 6);
  EXPECT_NEAR(jumps.largest_mm(), std::sqrt(45.0), 1e-6);
  EXPECT_NE(use_of_warp(VoidMode::nearest, jumps).find("6.708 mm, 8 pairs of them fold"),
            std::string::npos);
}

TEST(UnitWarpJumps, AShiftNeitherJumpsNorFolds) {
  const Geometry grid({4, 4, 4}, Vec3d(0), {Vec3d(1, 0, 0), {0, 1, 0}, {0, 0, 1}});
  WarpJumps jumps(grid);
  const std::vector<Vec3f> slice(16, Vec3f(7, -8, 9));
  for (int k = 0; k < 4; ++k) jumps.add(slice.data());
  EXPECT_EQ(jumps.largest_mm(), 0);
  EXPECT_EQ(jumps.folded_pairs(), 0);
  EXPECT_EQ(
      use_of_warp(VoidMode::extend, jumps),
      "smooth beyond the tissue, for points, inversion and registration; neighbouring vectors "
      "differ by up to 0 mm, none fold");
}
