// Dense warps on any grid as offsets of a volume's lattice.
#include <gtest/gtest.h>

#include "tests/volumes/field/offset_fixtures.h"
#include "volumes/base/error.h"
#include "volumes/field/dense/resample.h"
#include "volumes/field/dense/warp.h"
#include "volumes/grid/voxel_sets.h"

using namespace supple;
using namespace supple::test;

namespace {

Warp make_warp(const Geometry& grid, const std::function<Vec3d(const Vec3d&)>& vector_at_mm) {
  return warp_of(grid, {}, vector_at_mm);
}

Warp constant_warp(const Geometry& grid, const Vec3d& vector_mm) {
  return make_warp(grid, [=](const Vec3d&) { return vector_mm; });
}

/// Stretches, shears and turns a little; in mm.
Vec3d linear_vector(const Vec3d& p) {
  return Vec3d(0.05 * p.x - 0.1 * p.y, 0.02 * p.z, -0.03 * p.x) + Vec3d(0.5, -0.25, 0.75);
}

}  // namespace

TEST(UnitWarp, VectorsTakeMemoryWhereSomeAreOtherThanZero) {
  WarpVectors vectors(4000000);
  std::vector<Vec3f> expected(vectors.size(), Vec3f(0)), part(700, Vec3f(0));
  // Parts lie over the end of a run, over that part, and zeros over some of both.
  for (const auto& [first, value] : {std::pair(300u, Vec3f(1, 2, 3)),
                                     {900u, Vec3f(4, 0, 0)},
                                     {500u, Vec3f(0)},
                                     {3000000u, Vec3f(0)}}) {
    std::fill(part.begin(), part.end(), value);
    vectors.put(first, part.data(), part.size());
    std::copy(part.begin(), part.end(), expected.begin() + first);
  }
  vectors.put(1000000, &expected[1000000], 400000);
  EXPECT_EQ(vectors.all(), expected);
  EXPECT_EQ(vectors[1599], Vec3f(4, 0, 0));
  EXPECT_LT(vectors.bytes(), 1000000u);
  EXPECT_TRUE(vectors == WarpVectors(expected));
  vectors.put(2000, part.data(), 1);
  EXPECT_TRUE(vectors == WarpVectors(expected));
  vectors.put(2000, &expected[1300], 1);
  EXPECT_FALSE(vectors == WarpVectors(expected));
}

TEST(UnitWarp, OnTheSameGridEveryVectorComesBackExactly) {
  const Geometry grid({21, 9, 10}, {3, -7, 11}, {Vec3d(0, 0.5, 0), {-2, 0, 0}, {0, 0, 4}});
  std::mt19937 random(5);
  Warp warp = constant_warp(grid, Vec3d(0));
  std::vector<Vec3f> vectors(warp.vectors.size());
  for (Vec3f& vector : vectors) vector = random_vector(random, 0.25f);
  warp.vectors = vectors;
  const OffsetField field = offsets_from_warp(warp, grid);
  EXPECT_EQ(field.geometry, grid);
  EXPECT_EQ(field.o.topology, box_topology(Vec3i(0), grid.dims() - Vec3i(1)));
  for_each_slot(field.o.topology, [&](const Vec3i& v, std::size_t slot) {
    const Vec3f mm = warp.vectors[(std::size_t(v.z) * 9 + v.y) * 21 + v.x];
    EXPECT_EQ(field.o.vectors.at(slot), Vec3f(mm.y * 2, mm.x / -2, mm.z / 4));
  });
}

TEST(PropertyWarp, AnExportedFieldReadsBackOnItsOwnGridAndOnAMarginGrid) {
  const Geometry grid = oblique_geometry({18, 17, 12}, {-31, 17, 5}, {0.7, 1.1, 2.5}, 0.4);
  std::mt19937 random(6);
  const BrickTopology where = topology_where(
      {-2, 1, 2}, {15, 19, 9}, [](const Vec3i& v) { return (v - Vec3i(7, 9, 6)).length2() < 81; });
  OffsetField offsets{grid,
                      field_on(where,
                               [&](const Vec3i& v) {
                                 // Towards the middle, so that all of them read inside the box.
                                 const Vec3d inward = (Vec3d(8, 8, 6) - Vec3d(v)) * 0.3;
                                 return Vec3f(inward) + random_vector(random, 0.2f);
                               }),
                      {}};
  const Geometry wide = with_margin(grid, 6);
  const auto slices = dense_offsets(offsets, where, wide, VoidMode::outside);
  Warp warp = constant_warp(wide, Vec3d(0));
  std::vector<Vec3f> slice(std::size_t(wide.dims().x) * wide.dims().y);
  for (int k = 0; k < wide.dims().z; ++k) {
    slices(k, slice.data());
    warp.vectors.put(slice.size() * k, slice.data(), slice.size());
  }
  const OffsetField back = offsets_from_warp(warp, grid);
  // Exports by `outside` leave o = 0 where the grid is already far outside the box.
  for_each_slot(back.o.topology, [&](const Vec3i& v, std::size_t slot) {
    Vec3f expected(0);
    ASSERT_TRUE(offsets.o.at(v, expected)) << v;
    EXPECT_LT((back.o.vectors.at(slot) - expected).length(), 1e-5f) << v;
  });
  EXPECT_EQ(back.o.topology, where);
}

TEST(PropertyWarp, VectorsInMillimetresComeBackToTheBitAtPowersOfTwoAndToTheLastDigitElsewhere) {
  const Vec3i dims(16, 16, 16);
  const BrickTopology where = box_topology(dims);
  std::mt19937 random(14);
  const VectorBricks o = field_on(where, [&](const Vec3i&) { return random_vector(random, 0.5f); });
  for (const Vec3d& spacing : {Vec3d(1, 0.5, 2), Vec3d(0.957031, 0.957031, 1.5)}) {
    const Geometry grid(dims, {3, -7, 11},
                        {Vec3d(0, -spacing.x, 0), {spacing.y, 0, 0}, {0, 0, spacing.z}});
    const OffsetField offsets{grid, o, {}};
    std::vector<Vec3f> vectors(16 * 16 * 16);
    const auto slices = dense_offsets(offsets, where, grid, VoidMode::outside);
    for (int k = 0; k < dims.z; ++k) slices(k, &vectors[std::size_t(k) * 16 * 16]);
    const OffsetField back =
        offsets_from_warp({"w.nrrd", grid, WarpDirection::resample, vectors}, grid);
    int same = 0, compared = 0;
    for_each_slot(back.o.topology, [&](const Vec3i& v, std::size_t slot) {
      Vec3f expected;
      ASSERT_TRUE(o.at(v, expected));
      for (int a = 0; a < 3; ++a) {
        const float found = back.o.vectors.at(slot)[a];
        same += found == expected[a];
        EXPECT_LE(std::abs(found - expected[a]), std::ldexp(std::abs(expected[a]), -23)) << v;
        ++compared;
      }
    });
    EXPECT_EQ(compared, 3 * 16 * 16 * 16);
    EXPECT_EQ(same == compared, spacing.x == 1);
  }
}

TEST(PropertyWarp, LinearWarpsAreExactOnObliqueAnisotropicGrids) {
  const Geometry source = oblique_geometry({40, 38, 30}, {-20, -20, -20}, {1, 1.1, 1.4}, -0.2);
  const Geometry grids[] = {
      oblique_geometry({9, 11, 8}, {-9, -12, -8}, {2.1, 3.3, 2.7}, 0.7),
      Geometry({5, 6, 7}, {12, -8, -6}, {Vec3d(-4, 0, 0), {0.8, 4, 0}, {0, -0.3, 3}})};
  for (const Geometry& grid : grids) {
    const OffsetField field = offsets_from_warp(make_warp(grid, linear_vector), source);
    EXPECT_GT(field.o.topology.active_count(), 500);
    for_each_slot(field.o.topology, [&](const Vec3i& v, std::size_t slot) {
      const Vec3d expected =
          source.index_vector_from_world(linear_vector(source.world_from_index(Vec3d(v))));
      EXPECT_LT((Vec3d(field.o.vectors.at(slot)) - expected).length(), 2e-6) << v;
    });
    // Valid is what lies in the warp's grid and reads the source box, and nothing else.
    const IndexBox box{Vec3i(-16), source.dims() + Vec3i(16)};
    for_each_slot(box_topology(box.lo, box.hi), [&](const Vec3i& v, std::size_t) {
      const Vec3d pos = grid.index_from_world(source.world_from_index(Vec3d(v)));
      const Vec3d target = Vec3d(v) + source.index_vector_from_world(
                                          linear_vector(source.world_from_index(Vec3d(v))));
      double depth = 1e9;
      for (int a = 0; a < 3; ++a) {
        depth = std::min({depth, pos[a], grid.dims()[a] - 1 - pos[a], target[a] + 1,
                          source.dims()[a] - target[a]});
      }
      if (std::abs(depth) < 1e-5) return;
      EXPECT_EQ(field.o.topology.is_active(v), depth > 0) << v;
    });
  }
}

TEST(UnitWarp, BetweenItsNodesAWarpIsTrilinear) {
  const Geometry source = unit_geometry({9, 9, 9});
  Warp warp = constant_warp(Geometry({2, 2, 2}, {0, 0, 0}, {Vec3d(4, 0, 0), {0, 2, 0}, {0, 0, 8}}),
                            Vec3d(0));
  const Vec3f corner(1, 2, -4);  // (1, 1, 1)
  warp.vectors.put(7, &corner, 1);
  const OffsetField field = offsets_from_warp(warp, source);
  EXPECT_EQ(field.o.topology, box_topology({0, 0, 0}, {4, 2, 8}));
  Vec3f o;
  ASSERT_TRUE(field.o.at({1, 1, 6}, o));
  EXPECT_EQ(o, Vec3f(1, 2, -4) * (0.25f * 0.5f * 0.75f));
}

TEST(UnitWarp, OnlyBricksThatMoveAreStored) {
  // The grid begins two bricks and a half before the volume; vectors lead into it.
  const Geometry source = unit_geometry({40, 24, 32});
  const Geometry grid({64, 24, 32}, {-20, 0, 0}, source.axes_mm());
  const Vec3i moved[] = {{3, 17, 30}, {39, 0, 8}};
  const OffsetField field =
      offsets_from_warp(make_warp(grid,
                                  [&](const Vec3d& p) {
                                    const bool moves = p == Vec3d(moved[0]) || p == Vec3d(moved[1]);
                                    return moves ? Vec3d(0, 0.25, 0) : Vec3d(0);
                                  }),
                        source);
  EXPECT_EQ(field.o.topology, box_topology({0, 0, 0}, {39, 23, 31}));
  EXPECT_EQ(field.o.vectors.stored_bricks(), 2u);
  for_each_slot(field.o.topology, [&](const Vec3i& v, std::size_t slot) {
    const bool moves = v == moved[0] || v == moved[1];
    EXPECT_EQ(field.o.vectors.at(slot), Vec3f(0, moves ? 0.25F : 0, 0)) << v;
  });
}

TEST(UnitWarp, VoxelsOutsideTheSourceBoxMayReadInsideIt) {
  const Geometry source = unit_geometry({8, 8, 8});
  const Geometry grid({24, 8, 8}, {-8, 0, 0}, source.axes_mm());
  const OffsetField field = offsets_from_warp(constant_warp(grid, {6, 0, 0}), source);
  // x + 6 within the box, or less than a voxel beside it.
  EXPECT_EQ(field.o.topology, box_topology({-6, 0, 0}, {1, 7, 7}));
}

TEST(UnitWarp, VectorsThatLeadAVoxelOutOfTheBoxAreVoid) {
  const Geometry source = unit_geometry({8, 8, 8});
  const auto active = [&](double x) {
    const OffsetField field = offsets_from_warp(constant_warp(source, {x, 0, 0}), source);
    return field.o.topology.active_count() / 64;
  };
  EXPECT_EQ(active(0), 8);
  EXPECT_EQ(active(0.9), 8);
  EXPECT_EQ(active(1), 7);
  EXPECT_EQ(active(-1), 7);
  EXPECT_EQ(active(-2.5), 6);
  EXPECT_EQ(active(1e30), 0);
}

TEST(UnitWarp, MaterialDirectionAndAbsurdGridsAreRefused) {
  const Geometry source = unit_geometry({8, 8, 8});
  const auto error_of = [&](const Warp& warp) -> std::string {
    try {
      offsets_from_warp(warp, source);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  Warp warp = constant_warp(source, Vec3d(0));
  warp.direction = WarpDirection::resample;
  EXPECT_EQ(error_of(warp), "");
  warp.direction = WarpDirection::material;
  EXPECT_EQ(error_of(warp),
            "w.nrrd: direction: found a material-direction warp, expected a resample-direction "
            "warp, which supple export writes by default");
  for (const double spacing : {1e4, 1e9, 1e20}) {
    const Geometry huge({2, 2, 2}, {0, 0, 0},
                        {Vec3d(spacing, 0, 0), {0, spacing, 0}, {0, 0, spacing}});
    const std::string line = error_of(constant_warp(huge, Vec3d(0)));
    EXPECT_NE(line.find("grid: found a grid over voxels"), std::string::npos) << line;
    EXPECT_LT(line.size(), 400u);
  }
}
