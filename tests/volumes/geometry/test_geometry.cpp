#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "volumes/base/error.h"
#include "volumes/geometry/geometry.h"

using namespace supple;

TEST(UnitGeometry, IndexToWorldByHand) {
  const Geometry geometry({4, 5, 6}, {10, 20, 30}, {Vec3d(2, 0, 0), {0, -3, 0}, {0, 0, 4}});
  EXPECT_EQ(geometry.world_from_index({1, 1, 1}), Vec3d(12, 17, 34));
  EXPECT_EQ(geometry.spacing_mm(), Vec3d(2, 3, 4));
  EXPECT_EQ(geometry.direction()[1], Vec3d(0, -1, 0));
  EXPECT_LT(geometry.determinant(), 0);
  EXPECT_TRUE(geometry.is_orthogonal());
}

TEST(UnitGeometry, GradientsAreCovectors) {
  // density = world x: in index space the gradient is the spacing along i.
  const Geometry geometry({4, 4, 4}, {0, 0, 0}, {Vec3d(2, 0, 0), {1, 3, 0}, {0, 0, 4}});
  const Vec3d gradient = geometry.world_gradient_from_index({2, 1, 0});
  EXPECT_NEAR((gradient - Vec3d(1, 0, 0)).length(), 0, 1e-12);
}

TEST(PropertyGeometry, WorldAndIndexInvertEachOtherAtAnyScaleAndShear) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> coordinate(-1, 1);
  const auto vector = [&] {
    return Vec3d(coordinate(random), coordinate(random), coordinate(random));
  };
  for (const double scale : {1e-8, 1.0, 1e8}) {
    for (int n = 0; n < 100; ++n) {
      std::array<Vec3d, 3> axes = {vector(), vector(), vector()};
      if (std::abs(axes[0].normalized().dot(axes[1].normalized().cross(axes[2].normalized()))) <
          0.05)
        continue;
      for (Vec3d& axis : axes) axis *= scale;
      const Geometry geometry({9, 9, 9}, vector() * scale, axes);
      const Vec3d index = vector() * 100.0;
      EXPECT_LT((geometry.index_from_world(geometry.world_from_index(index)) - index).length(),
                1e-9);
    }
  }
}

TEST(UnitGeometry, UnusableGeometriesAreRejected) {
  const std::array<Vec3d, 3> unit = {Vec3d(1, 0, 0), {0, 1, 0}, {0, 0, 1}};
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(Geometry({0, 1, 1}, {0, 0, 0}, unit), InputError);
  EXPECT_THROW(Geometry({-3, 1, 1}, {0, 0, 0}, unit), InputError);
  EXPECT_THROW(Geometry({2000000, 2000000, 2000000}, {0, 0, 0}, unit), InputError);
  EXPECT_THROW(Geometry({1, 1, 1}, {nan, 0, 0}, unit), InputError);
  EXPECT_THROW(Geometry({1, 1, 1}, {0, 0, 0}, {Vec3d(nan, 0, 0), {0, 1, 0}, {0, 0, 1}}),
               InputError);
  EXPECT_THROW(Geometry({1, 1, 1}, {0, 0, 0}, {Vec3d(1, 0, 0), {1, 0, 0}, {0, 0, 1}}), InputError);
  EXPECT_THROW(Geometry({1, 1, 1}, {0, 0, 0}, {Vec3d(0, 0, 0), {0, 1, 0}, {0, 0, 1}}), InputError);
  // Neither an inverse nor a file of 32-bit floats holds such lengths.
  for (const double length : {1e-320, 1e-40, 1e39, 1e300}) {
    EXPECT_THROW(Geometry({1, 1, 1}, {0, 0, 0}, {Vec3d(length, 0, 0), {0, 1, 0}, {0, 0, 1}}),
                 InputError);
  }
  EXPECT_THROW(Geometry({1, 1, 1}, {1e39, 0, 0}, unit), InputError);
  EXPECT_NO_THROW(Geometry({1, 1, 1}, {1e20, 0, 0}, {Vec3d(1e-8, 0, 0), {0, 1e8, 0}, {0, 0, 1}}));
}
