// Warps of other programs are inverted on grids of any orientation.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/volumes/field/offset_fixtures.h"
#include "volumes/field/dense/invert_warp.h"
#include "volumes/field/dense/resample.h"

namespace supple::test {
namespace {

const Geometry kTurnedGrid({40, 36, 30}, {5, -3, 2},
                           {Vec3d(0, 1.5, 0.3), {-2, 0, 0}, {0, -0.5, 2.5}});

/// Smooth in world millimetres, up to 6 mm long.
Vec3d smooth(const Vec3d& x) {
  return {3 * std::sin(x.y / 15), 4 * std::cos(x.z / 20), 2 * std::sin((x.x + x.y) / 18)};
}

TEST(PropertyInvertWarp, TheInverseLeadsBackToWhereThePointCameFrom) {
  const OffsetField inverse =
      invert(displacement_of_warp(warp_of(kTurnedGrid, WarpDirection::resample, smooth)));
  EXPECT_LE(inverse.certificate.residual_max, 1e-3);
  EXPECT_EQ(inverse.certificate.folded_cells, 0);
  int checked = 0;
  for (int n = 0; n < 1000; ++n) {
    const Vec3d start = kTurnedGrid.world_from_index(
        Vec3d(8 + n % 10 * 2.3, 8 + n / 10 % 10 * 1.9, 6 + n / 100 * 1.7));
    const Vec3d index = kTurnedGrid.index_from_world(start);
    Vec3d offset;
    ASSERT_TRUE(inverse.sample(index, offset)) << index;
    const Vec3d back = kTurnedGrid.world_from_index(index + offset);
    EXPECT_LE((back + smooth(back) - start).length(), 0.05) << index;
    ++checked;
  }
  EXPECT_EQ(checked, 1000);
}

TEST(UnitInvertWarp, AShiftIsUndoneAndWhatItLeavesUncoveredIsCounted) {
  const Geometry grid({40, 36, 30}, {5, -3, 2}, {Vec3d(0, 0.5, 0), {-2, 0, 0}, {0, 0, 4}});
  Warp warp = warp_of(grid, WarpDirection::resample, smooth);
  const Vec3d shift = grid.world_vector_from_index({2, 0, 0});
  warp.vectors = std::vector<Vec3f>(warp.vectors.size(), Vec3f(shift));
  const OffsetField inverse = invert(displacement_of_warp(warp));
  Vec3f offset;
  ASSERT_TRUE(inverse.o.at({20, 7, 9}, offset));
  EXPECT_EQ(Vec3d(offset), Vec3d(-2, 0, 0));
  EXPECT_EQ(count_uncovered(inverse, grid), 2 * 36 * 30);
  EXPECT_EQ(count_uncovered(inverse, grid.with_dims({43, 36, 30})), 3 * 36 * 30);
}

}  // namespace
}  // namespace supple::test
