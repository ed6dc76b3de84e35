#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/support/field_fixtures.h"
#include "volumes/field/offset_field.h"
#include "volumes/field/procedural.h"

using namespace supple;
using namespace supple::test;

TEST(UnitVectorBricks, AVoxelIsReadWhereItIsValidAndNowhereElse) {
  const VectorBricks field =
      field_on(box_topology({-3, -3, -3}, {9, 9, 9}), [](const Vec3i& v) { return Vec3f(v); });
  Vec3f vector;
  ASSERT_TRUE(field.at({-3, 9, 0}, vector));
  EXPECT_EQ(vector, Vec3f(-3, 9, 0));
  EXPECT_FALSE(field.at({-4, 9, 0}, vector));
  EXPECT_FALSE(field.at({100, 9, 0}, vector));
  EXPECT_GE(field.bytes(), field.topology.brick_count() * 512 * sizeof(Vec3f));
}

TEST(UnitVectorBricks, SamplingNeedsOnlyCornersWithWeight) {
  // A single voxel can be read at its centre, not beside it.
  const VectorBricks field =
      field_on(box_topology({7, 7, 7}, {7, 7, 7}), [](const Vec3i&) { return Vec3f(1, 2, 3); });
  Vec3d vector;
  ASSERT_TRUE(field.sample({7, 7, 7}, vector));
  EXPECT_EQ(vector, Vec3d(1, 2, 3));
  EXPECT_FALSE(field.sample({7.001, 7, 7}, vector));
  EXPECT_FALSE(field.sample({6.999, 7, 7}, vector));
  EXPECT_FALSE(field.sample(Vec3d(std::numeric_limits<double>::quiet_NaN()), vector));
  EXPECT_FALSE(field.sample(Vec3d(1e300), vector));
}

TEST(PropertyVectorBricks, TrilinearSamplingReproducesTrilinearFunctionsAcrossBricks) {
  const auto function = [](const Vec3d& p) {
    return Vec3d(p.x * p.y, p.y - 0.5 * p.z, p.x * p.y * p.z / 64);
  };
  const VectorBricks field = field_on(box_topology({-8, -8, -8}, {15, 15, 15}),
                                      [&](const Vec3i& v) { return Vec3f(function(Vec3d(v))); });
  std::mt19937 random(3);
  std::uniform_real_distribution<double> coordinate(-8, 15);
  for (int n = 0; n < 2000; ++n) {
    const Vec3d p(coordinate(random), coordinate(random), coordinate(random));
    Vec3d vector;
    ASSERT_TRUE(field.sample(p, vector));
    EXPECT_LT((vector - function(p)).length(), 2e-5) << n;
  }
}

TEST(PropertyProceduralWarps, DisplacementAndOffsetInvertEachOther) {
  std::mt19937 random(4);
  for (const AnalyticWarp& warp : {shear_warp({3, 4, 5}, 0.7), stretch_warp({3, 4, 5}, 1.6),
                                   stretch_warp({3, 4, 5}, 0.4), bump_warp({3, 4, 5}, 6, 2.5)}) {
    for (int n = 0; n < 500; ++n) {
      const Vec3d x = Vec3d(random_vector(random, 12));
      const Vec3d o = warp.offset_voxels(x);
      EXPECT_LT((o + warp.displacement_voxels(x + o)).length(), 1e-12);
    }
  }
}

TEST(UnitProceduralWarps, SamplesLieOnTheActiveVoxels) {
  const BrickTopology where = box_topology({0, 0, 0}, {8, 3, 3});
  const Geometry geometry = unit_geometry({9, 4, 4});
  const AnalyticWarp warp = shear_warp({0, 1, 0}, 0.5);
  Vec3f vector;
  const Displacement displacement = sample_displacement(warp, geometry, where);
  EXPECT_TRUE(displacement.u.topology == where);
  ASSERT_TRUE(displacement.u.at({8, 3, 0}, vector));
  EXPECT_EQ(vector, Vec3f(1, 0, 0));
  ASSERT_TRUE(sample_offsets(warp, geometry, where).o.at({8, 3, 0}, vector));
  EXPECT_EQ(vector, Vec3f(-1, 0, 0));
}
