// The spline through all voxels: it interpolates, reproduces cubics, and is what its weights say.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "volumes/grid/b_spline.h"

namespace supple {
namespace {

DensityGrid full_grid(const Vec3i& dims, const std::function<double(const Vec3i&)>& density) {
  std::vector<Vec3i> origins;
  std::vector<BrickMask> masks;
  for (int x = 0; x < dims.x; x += 8) {
    for (int y = 0; y < dims.y; y += 8) {
      for (int z = 0; z < dims.z; z += 8) {
        BrickMask mask{};
        for (int n = 0; n < kBrickVoxels; ++n) {
          const Vec3i v = Vec3i(x, y, z) + brick_local(n);
          if (v.x < dims.x && v.y < dims.y && v.z < dims.z) mask_set(mask, n);
        }
        origins.push_back({x, y, z});
        masks.push_back(mask);
      }
    }
  }
  const BrickTopology bricks(origins, masks);
  std::vector<float> values(bricks.brick_count() * kBrickVoxels);
  for (std::size_t b = 0; b < bricks.brick_count(); ++b) {
    for_each_active(bricks.mask(b), [&](int n) {
      values[b * kBrickVoxels + std::size_t(n)] = float(density(bricks.origin(b) + brick_local(n)));
    });
  }
  return make_density_grid(bricks, values, 0);
}

TEST(PropertyBSpline, TheInterpolatingOnePassesThroughEveryVoxel) {
  for (const Vec3i& dims : {Vec3i(20, 9, 33), {1, 2, 3}, {40, 1, 1}}) {
    const DensityGrid grid = full_grid(dims, [](const Vec3i& v) {
      return 1000 * std::sin(1.7 * v.x + 2.9 * v.y * v.y + 0.3 * v.z);
    });
    const SplineDensity spline(grid, dims, true);
    for (int i = 0; i < dims.x; ++i) {
      for (int j = 0; j < dims.y; ++j) {
        for (int k = 0; k < dims.z; ++k) {
          ASSERT_NEAR(spline.at(Vec3d(i, j, k)), double(grid.at({i, j, k})), 0.01);
        }
      }
    }
  }
}

/// Away from the borders, where the mirror is felt.
TEST(PropertyBSpline, CubicPolynomialsComeOutAsTheyAre) {
  const auto cubic = [](const Vec3d& p) {
    return 0.01 * p.x * p.x * p.x - 0.2 * p.y * p.y + 0.1 * p.x * p.y * p.z + 3 * p.z;
  };
  const DensityGrid grid = full_grid({48, 48, 48}, [&](const Vec3i& v) { return cubic(Vec3d(v)); });
  const SplineDensity spline(grid, {48, 48, 48}, true);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(16, 31);
  for (int n = 0; n < 500; ++n) {
    const Vec3d p(place(random), place(random), place(random));
    ASSERT_NEAR(spline.at(p), cubic(p), 0.01);
  }
}

TEST(UnitBSpline, TheCardinalSplineIsOneAtItsNodeAndZeroAtAllOthers) {
  for (int n = -6; n <= 6; ++n) EXPECT_NEAR(cardinal_spline(n), n == 0 ? 1 : 0, 1e-12) << n;
  for (const double x : {0.0, 0.3, 0.77}) {
    double sum = 0, first = 0;
    for (int n = -40; n <= 40; ++n) {
      sum += cardinal_spline(x - n);
      first += n * cardinal_spline(x - n);
    }
    EXPECT_NEAR(sum, 1, 1e-12);
    EXPECT_NEAR(first, x, 1e-10);
  }
  EXPECT_LT(cardinal_spline(1.5), -0.05);  // it overshoots
}

}  // namespace
}  // namespace supple
