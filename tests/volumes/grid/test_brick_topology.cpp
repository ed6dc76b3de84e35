#include <random>
#include <set>
#include <tuple>

#include <gtest/gtest.h>

#include "volumes/grid/cell.h"
#include "volumes/grid/density_grid.h"
#include "volumes/grid/mask_steps.h"
#include "volumes/grid/voxel_sets.h"

using namespace supple;

namespace {

using Voxel = std::tuple<int, int, int>;

BrickTopology bricks_of(const std::set<Voxel>& voxels) {
  std::vector<Vec3i> origins;
  std::vector<BrickMask> masks;
  for (const auto& [i, j, k] : voxels) {
    const Vec3i origin(i & ~7, j & ~7, k & ~7);
    std::size_t b = 0;
    while (b < origins.size() && origins[b] != origin) ++b;
    if (b == origins.size()) {
      origins.push_back(origin);
      masks.push_back(BrickMask{});
    }
    mask_set(masks[b], brick_offset({i, j, k}));
  }
  return {origins, masks};
}

/// The voxels from -9 to 9 along each axis but for one in fifty.
std::set<Voxel> cube_with_holes(std::mt19937& random) {
  std::set<Voxel> voxels;
  for (int n = 0; n < 19 * 19 * 19; ++n) {
    if (random() % 50 != 0) voxels.insert({n / 361 - 9, n / 19 % 19 - 9, n % 19 - 9});
  }
  return voxels;
}

std::set<Voxel> random_voxels(std::mt19937& random, int count, int range) {
  std::uniform_int_distribution<int> coordinate(-range, range);
  std::set<Voxel> voxels;
  for (int n = 0; n < count; ++n) {
    voxels.insert({coordinate(random), coordinate(random), coordinate(random)});
  }
  return voxels;
}

}  // namespace

TEST(UnitBrickTopology, VoxelsAreFoundAcrossNegativeCoordinatesAndRegions) {
  const BrickTopology topology = bricks_of({{-1, -1, -1}, {0, 0, 0}, {1000, -2000, 5}});
  EXPECT_EQ(topology.brick_count(), 3u);
  EXPECT_EQ(topology.active_count(), 3);
  EXPECT_TRUE(topology.is_active({-1, -1, -1}));
  EXPECT_TRUE(topology.is_active({1000, -2000, 5}));
  EXPECT_FALSE(topology.is_active({1000, -2000, 6}));
  EXPECT_EQ(topology.find({5000, 0, 0}), -1);
  EXPECT_EQ(topology.active_bounds().lo, Vec3i(-1, -2000, -1));
  EXPECT_EQ(topology.active_bounds().hi, Vec3i(1000, 0, 5));
}

TEST(UnitBrickTopology, FaceNeighboursPointAtEachOther) {
  const BrickTopology topology = bricks_of({{7, 0, 0}, {8, 0, 0}});
  EXPECT_EQ(topology.neighbour(0, 1), 1);
  EXPECT_EQ(topology.neighbour(1, 0), 0);
  EXPECT_EQ(topology.neighbour(0, 0), -1);
}

TEST(UnitBrickTopology, ComponentsConnectThroughFacesOnly) {
  // Two voxels that share an edge are two pieces; a row across a brick border is one.
  const BrickTopology topology =
      bricks_of({{0, 0, 0}, {1, 1, 0}, {6, 20, 3}, {7, 20, 3}, {8, 20, 3}});
  EXPECT_EQ(largest_components(topology, 1).active_count(), 3);
  EXPECT_TRUE(largest_components(topology, 1).is_active({8, 20, 3}));
  EXPECT_EQ(largest_components(topology, 2).active_count(), 4);
  EXPECT_TRUE(largest_components(topology, 2).is_active({0, 0, 0}));
  EXPECT_EQ(largest_components(topology, 9).active_count(), 5);
}

TEST(PropertyBrickTopology, DilationEqualsTheBruteForceBoxNeighbourhood) {
  std::mt19937 random(7);
  for (const int rings : {1, 2, 3, 8}) {
    const std::set<Voxel> voxels = random_voxels(random, 60, 25);
    std::set<Voxel> expected;
    for (const auto& [i, j, k] : voxels) {
      for (int a = -rings; a <= rings; ++a) {
        for (int b = -rings; b <= rings; ++b) {
          for (int c = -rings; c <= rings; ++c) expected.insert({i + a, j + b, k + c});
        }
      }
    }
    EXPECT_TRUE(dilate(bricks_of(voxels), rings) == bricks_of(expected)) << rings;
  }
}

TEST(PropertyBrickTopology, ErosionLeavesVoxelsWhoseNeighboursAreAllThere) {
  std::mt19937 random(8);
  const std::set<Voxel> voxels = cube_with_holes(random);
  std::set<Voxel> expected;
  for (const auto& [i, j, k] : voxels) {
    bool is_inside = true;
    for (int n = 0; n < 27; ++n) {
      is_inside = is_inside && voxels.count({i + n / 9 - 1, j + n / 3 % 3 - 1, k + n % 3 - 1}) != 0;
    }
    if (is_inside) expected.insert({i, j, k});
  }
  ASSERT_GT(expected.size(), 500u);
  EXPECT_TRUE(eroded(bricks_of(voxels)) == bricks_of(expected));
}

TEST(PropertyBrickTopology, CellsOfWholeBricksAndTheirCornersAreThoseOfSingleVoxels) {
  std::mt19937 random(10);
  const std::set<Voxel> voxels = cube_with_holes(random);
  std::set<Voxel> cells, corners;
  for (const auto& [i, j, k] : voxels) {
    bool is_cell = true;
    for (int n = 0; n < 8; ++n) {
      is_cell = is_cell && voxels.count({i + (n >> 2), j + (n >> 1 & 1), k + (n & 1)}) != 0;
    }
    if (!is_cell) continue;
    cells.insert({i, j, k});
    for (int n = 0; n < 8; ++n) corners.insert({i + (n >> 2), j + (n >> 1 & 1), k + (n & 1)});
  }
  const BrickTopology of_voxels = bricks_of(voxels), of_cells = bricks_of(cells);
  const auto masks_beside = [](const BrickTopology& bricks, const Vec3i& origin, int side) {
    std::array<BrickMask, 8> masks{};
    for (std::size_t n = 0; n < 8; ++n) {
      const std::int32_t b = bricks.find(origin + cell_corner(int(n)) * kBrickDim * side);
      if (b >= 0) masks[n] = bricks.mask(std::size_t(b));
    }
    return masks;
  };
  ASSERT_GT(cells.size(), 1000u);
  for (std::size_t b = 0; b < of_cells.brick_count(); ++b) {
    const Vec3i& origin = of_cells.origin(b);
    EXPECT_EQ(cells_in(masks_beside(of_voxels, origin, 1)), of_cells.mask(b));
  }
  const BrickTopology of_corners = bricks_of(corners);
  for (std::size_t b = 0; b < of_corners.brick_count(); ++b) {
    const Vec3i& origin = of_corners.origin(b);
    EXPECT_EQ(corners_of(masks_beside(of_cells, origin, -1)), of_corners.mask(b));
  }
}

TEST(PropertyBrickTopology, UnionsIntersectionsAndDifferencesAreThoseOfSets) {
  std::mt19937 random(9);
  const std::set<Voxel> one = random_voxels(random, 900, 9), other = random_voxels(random, 900, 9);
  const BrickTopology a = bricks_of(one), b = bricks_of(other);
  std::set<Voxel> both, any(one), only(one);
  for (const Voxel& voxel : other) {
    if (one.count(voxel) != 0) both.insert(voxel);
    any.insert(voxel);
    only.erase(voxel);
  }
  ASSERT_GT(both.size(), 50u);
  EXPECT_TRUE(intersect(a, b) == bricks_of(both));
  EXPECT_TRUE(unite(a, b) == bricks_of(any));
  EXPECT_TRUE(subtract(a, b) == bricks_of(only));
}

TEST(PropertyBrickTopology, ADensityGridGivesBackTheValuesItWasMadeOf) {
  std::mt19937 random(8);
  const BrickTopology topology = bricks_of(random_voxels(random, 400, 40));
  std::vector<float> values(topology.brick_count() * kBrickVoxels, -5.0f);
  std::uniform_real_distribution<float> density(0, 1);
  for (std::size_t b = 0; b < topology.brick_count(); ++b) {
    for_each_active(topology.mask(b),
                    [&](int offset) { values[b * kBrickVoxels + offset] = density(random); });
  }
  const DensityGrid grid = make_density_grid(topology, values, -5.0f);
  ASSERT_TRUE(grid.bricks() == topology);
  for (std::size_t b = 0; b < topology.brick_count(); ++b) {
    for (int offset = 0; offset < kBrickVoxels; ++offset) {
      ASSERT_EQ(grid.values(b)[offset], values[b * kBrickVoxels + offset]);
    }
  }
}
