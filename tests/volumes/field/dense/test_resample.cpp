#include <limits>

#include <gtest/gtest.h>

#include "tests/volumes/field/offset_fixtures.h"
#include "volumes/base/error.h"
#include "volumes/field/dense/nearest_void.h"
#include "volumes/field/dense/resample.h"
#include "volumes/field/inversion/deformed_cell.h"
#include "volumes/field/inversion/invert.h"
#include "volumes/field/procedural.h"
#include "volumes/field/split_offsets.h"
#include "volumes/grid/voxel_sets.h"

using namespace supple;
using namespace supple::test;

namespace {

/// All slices of a source, k slowest.
template <class Value, class Source>
std::vector<Value> all_slices(const Source& source, const Vec3i& dims) {
  const std::size_t slice = std::size_t(dims.x) * dims.y;
  std::vector<Value> values(slice * dims.z);
  for (int k = 0; k < dims.z; ++k) source(k, &values[slice * k]);
  return values;
}

std::size_t dense_index(const Vec3i& v, const Vec3i& dims) {
  return (std::size_t(v.z) * dims.y + v.y) * dims.x + v.x;
}

OffsetField constant_offsets(const Geometry& geometry, const BrickTopology& where, const Vec3f& o) {
  return {geometry, field_on(where, [&](const Vec3i&) { return o; }), {}};
}

/// One brick in which every sample reads the same offset, whatever the lattice holds.
class ConstantSplit : public SplitOffsets {
 public:
  ConstantSplit(const Vec3i& brick, const Vec3d& offset) : m_offset(offset) { set_bricks({brick}); }
  bool sample(std::size_t, const Vec3d&, Sample& found) const override {
    found.offset = m_offset;
    return true;
  }
  void source_box(std::size_t, Vec3d& lo, Vec3d& hi) const override { lo = hi = Vec3d(0); }
  bool offset_of(int, const Vec3d&, Vec3d& offset) const override {
    offset = m_offset;
    return true;
  }
  double depth_mm(int, const Vec3d&) const override { return 1; }

 private:
  Vec3d m_offset;
};

double distance_mm(const Vec3d& step, const Vec3d& spacing) {
  return (step * spacing).length();
}

}  // namespace

TEST(PropertyNearestVoid, IsAsNearAsTheBruteForceFindsInMillimetres) {
  std::mt19937 random(31);
  const Vec3i dims(23, 17, 20);
  for (const double density : {0.6, 0.98, 0.9995}) {
    for (const Vec3d& spacing : {Vec3d(1, 1, 1), Vec3d(0.4, 1.3, 3)}) {
      std::bernoulli_distribution active(density);
      const BrickTopology source =
          topology_where(Vec3i(0), dims - Vec3i(1), [&](const Vec3i&) { return active(random); });
      const VectorBricks nearest = nearest_void(source, source, dims, spacing);
      std::vector<Vec3i> empty;
      for_each_slot(box_topology(Vec3i(0), dims - Vec3i(1)), [&](const Vec3i& v, std::size_t) {
        if (!source.is_active(v)) empty.push_back(v);
      });
      for_each_slot(source, [&](const Vec3i& v, std::size_t) {
        double best = 1e30;
        for (const Vec3i& e : empty) best = std::min(best, distance_mm(Vec3d(e - v), spacing));
        Vec3f step;
        ASSERT_EQ(nearest.at(v, step), !empty.empty());
        if (empty.empty()) return;
        EXPECT_NEAR(distance_mm(Vec3d(step), spacing), best, 1e-9);
        EXPECT_FALSE(source.is_active(v + Vec3i(step)));
      });
    }
  }
}

TEST(PropertyNearestVoid, TheWindowGrowsUntilNothingBeyondItIsNearer) {
  // One wanted voxel deep inside a solid. The first window ends 8 voxels away and holds only the
  // void voxel on the diagonal, 13.9 away; the one 10 away lies beyond it.
  const Vec3i dims(70, 70, 70);
  const Vec3i hole(45, 35, 35), diagonal(43, 43, 43);
  const BrickTopology source = topology_where(
      Vec3i(0), dims - Vec3i(1), [&](const Vec3i& v) { return v != hole && v != diagonal; });
  const BrickTopology wanted = box_topology(Vec3i(35), Vec3i(35));
  Vec3f step;
  ASSERT_TRUE(nearest_void(source, wanted, dims, {1, 1, 1}).at(Vec3i(35), step));
  EXPECT_EQ(step, Vec3f(10, 0, 0));
  ASSERT_TRUE(nearest_void(source, wanted, dims, {2, 1, 1}).at(Vec3i(35), step));
  EXPECT_EQ(step, Vec3f(8, 8, 8));
}

TEST(UnitNearestVoid, ASolidThatReachesBeyondTheBoxStillHasNone) {
  Vec3f step;
  const BrickTopology wanted = box_topology(Vec3i(2), Vec3i(5));
  EXPECT_FALSE(nearest_void(box_topology(Vec3i(-3), Vec3i(9)), wanted, Vec3i(9), {1, 1, 1})
                   .at(Vec3i(4), step));
  // The solid has as many voxels as the box, but one of them lies beyond it.
  const BrickTopology shifted = box_topology({1, 0, 0}, {9, 8, 8});
  ASSERT_TRUE(nearest_void(shifted, wanted, Vec3i(9), {1, 1, 1}).at(Vec3i(4), step));
  EXPECT_EQ(step, Vec3f(-4, 0, 0));
}

TEST(UnitDenseOffsets, VacatedVoxelsReadTheNearestVoidAndVoidStaysPut) {
  // A block of 6^3 moves by 4 along i in a box of 20^3.
  const Geometry geometry = oblique_geometry(Vec3i(20), {-31, 17, 5}, {1, 2, 3}, 0.4);
  const BrickTopology source = box_topology(Vec3i(6), Vec3i(11));
  const OffsetField offsets =
      constant_offsets(geometry, box_topology({10, 6, 6}, {15, 11, 11}), Vec3f(-4, 0, 0));
  const auto dense = all_slices<Vec3f>(dense_offsets(offsets, source, geometry, VoidMode::nearest),
                                       geometry.dims());
  for_each_slot(box_topology(Vec3i(0), Vec3i(19)), [&](const Vec3i& v, std::size_t) {
    const Vec3f vector = dense[dense_index(v, geometry.dims())];
    const Vec3d o = geometry.index_vector_from_world(Vec3d(vector));
    if (offsets.o.topology.is_active(v)) {
      EXPECT_LT((o - Vec3d(-4, 0, 0)).length(), 1e-6);
    } else if (!source.is_active(v)) {
      EXPECT_EQ(vector, Vec3f(0));
    } else {
      const Vec3d target = Vec3d(v) + o;
      const Vec3i voxel(int(std::lround(target.x)), int(std::lround(target.y)),
                        int(std::lround(target.z)));
      EXPECT_LT((target - Vec3d(voxel)).length(), 1e-5);
      EXPECT_FALSE(source.is_active(voxel));
      const double i_way = std::min(v.x - 5, 12 - v.x), j_way = 2 * std::min(v.y - 5, 12 - v.y);
      EXPECT_NEAR(o.length() > 0 ? distance_mm(o, {1, 2, 3}) : 0,
                  std::min({i_way, j_way, 3.0 * std::min(v.z - 5, 12 - v.z)}), 1e-5);
    }
  });
}

TEST(UnitDenseOffsets, SplitBricksReadTheirPieceAndNotTheLattice) {
  const Geometry geometry = unit_geometry(Vec3i(20));
  const BrickTopology all = box_topology(Vec3i(0), Vec3i(19));
  OffsetField offsets = constant_offsets(geometry, all, Vec3f(1, 0, 0));
  offsets.split = std::make_shared<ConstantSplit>(Vec3i(8, 0, 8), Vec3d(0, 2, 0));
  const auto dense =
      all_slices<Vec3f>(dense_offsets(offsets, all, geometry, VoidMode::nearest), geometry.dims());
  EXPECT_EQ(dense[dense_index({8, 7, 15}, geometry.dims())], Vec3f(0, 2, 0));
  EXPECT_EQ(dense[dense_index({7, 7, 15}, geometry.dims())], Vec3f(1, 0, 0));
}

TEST(UnitDenseOffsets, WithoutAVoidVoxelAVacatedOneKeepsZero) {
  const Geometry geometry = unit_geometry(Vec3i(9));
  const BrickTopology source = box_topology(Vec3i(0), Vec3i(8));
  const OffsetField offsets =
      constant_offsets(geometry, box_topology({4, 0, 0}, {12, 8, 8}), Vec3f(-4, 0, 0));
  const auto dense = all_slices<Vec3f>(dense_offsets(offsets, source, geometry, VoidMode::nearest),
                                       geometry.dims());
  EXPECT_EQ(dense[dense_index({2, 4, 4}, geometry.dims())], Vec3f(0));
  EXPECT_EQ(dense[dense_index({5, 4, 4}, geometry.dims())], Vec3f(-4, 0, 0));
}

TEST(UnitDenseOffsets, OutsideLeadsEveryVoidVoxelOutOfTheSourceBox) {
  const Geometry geometry = oblique_geometry({20, 16, 12}, {-31, 17, 5}, {1, 2, 3}, 0.3);
  const BrickTopology source = box_topology(Vec3i(4), Vec3i(9));
  const OffsetField offsets = constant_offsets(geometry, source, Vec3f(0));
  const Geometry grid = with_margin(geometry, 40);
  const auto dense =
      all_slices<Vec3f>(dense_offsets(offsets, source, grid, VoidMode::outside), grid.dims());
  for_each_slot(box_topology(Vec3i(0), grid.dims() - Vec3i(1)), [&](const Vec3i& v, std::size_t) {
    const Vec3d world = grid.world_from_index(Vec3d(v));
    const Vec3d at = geometry.index_from_world(world + Vec3d(dense[dense_index(v, grid.dims())]));
    bool inside = true;
    for (int a = 0; a < 3; ++a) {
      inside = inside && at[a] > -9.9 && at[a] < geometry.dims()[a] - 1 + 9.9;
    }
    const Vec3d pos = geometry.index_from_world(world);
    const bool material = source.is_active(
        Vec3i(int(std::lround(pos.x)), int(std::lround(pos.y)), int(std::lround(pos.z))));
    ASSERT_EQ(inside, material) << v;
  });
}

TEST(PropertyDenseOffsets, ExtendKeepsConstantsAndCarriesOnWithoutJumps) {
  const Geometry geometry = unit_geometry({60, 60, 30});
  const BrickTopology where = box_topology({20, 20, 8}, {35, 30, 20});
  const auto constant = constant_offsets(geometry, where, Vec3f(1.5f, -2, 0.25f));
  for (const Vec3f& o : all_slices<Vec3f>(
           dense_offsets(constant, where, geometry, VoidMode::extend), geometry.dims())) {
    ASSERT_LT((o - Vec3f(1.5f, -2, 0.25f)).length(), 1e-5f);
  }
  const OffsetField linear{
      geometry, field_on(where, [](const Vec3i& v) { return Vec3f(0.1f * float(v.y), 0, 0); }), {}};
  const auto dense =
      all_slices<Vec3f>(dense_offsets(linear, where, geometry, VoidMode::extend), geometry.dims());
  const Vec3i dims = geometry.dims();
  for (int k = 0; k < dims.z; ++k) {
    for (int j = 0; j < dims.y; ++j) {
      for (int i = 0; i + 1 < dims.x; ++i) {
        const Vec3f step =
            dense[dense_index({i + 1, j, k}, dims)] - dense[dense_index({i, j, k}, dims)];
        ASSERT_LT(step.length(), 0.35f) << i << " " << j << " " << k;
      }
    }
  }
  EXPECT_EQ(dense[dense_index({25, 24, 10}, dims)], Vec3f(0.1f * 24, 0, 0));
}

TEST(PropertyDenseOffsets, ExtendDoesNotFoldTheAirBetweenPartsThatComeNearEachOther) {
  // One of two slabs with 12 voxels between goes 4 up, the other 5 down: 3 are left.
  const Geometry geometry = unit_geometry({24, 24, 40});
  const BrickTopology slabs =
      unite(box_topology({4, 4, 4}, {19, 19, 10}), box_topology({4, 4, 23}, {19, 19, 30}));
  const Displacement u = extend(
      {geometry,
       field_on(slabs,
                [](const Vec3i& v) { return v.z < 17 ? Vec3f(3, 0, 4) : Vec3f(-3, 0, -5); })},
      dilate(slabs, 2));
  InvertParams params;
  params.material = &slabs;
  const OffsetField offsets = invert(u, params);
  const Vec3i dims = geometry.dims();
  const auto dense = all_slices<Vec3f>(
      dense_offsets(offsets, u.u.topology, geometry, VoidMode::extend, &slabs), dims);
  int folded = 0;
  for_each_slot(box_topology(dims - Vec3i(1)), [&](const Vec3i& cell, std::size_t) {
    CellCorners corners;
    for (int n = 0; n < 8; ++n) {
      const Vec3i step(n >> 2, n >> 1 & 1, n & 1);
      const Vec3d moved = Vec3d(step) + Vec3d(dense[dense_index(cell + step, dims)]);
      for (int a = 0; a < 3; ++a) corners.p[a][n] = moved[a];
    }
    folded += is_folded(corners);
  });
  EXPECT_EQ(folded, 0);
  for_each_slot(slabs, [&](const Vec3i& v, std::size_t) {
    const Vec3i at = v + (v.z < 17 ? Vec3i(3, 0, 4) : Vec3i(-3, 0, -5));
    ASSERT_EQ(dense[dense_index(at, dims)], v.z < 17 ? Vec3f(-3, 0, -4) : Vec3f(3, 0, 5)) << v;
  });
}

TEST(PropertyDenseOffsets, AnotherGridReadsTheSameWorldVectors) {
  // A linear warp is reproduced by trilinear reading on any grid.
  const Geometry geometry = oblique_geometry({40, 30, 20}, {-31, 17, 5}, {0.8, 1.1, 2.5}, 0.5);
  const BrickTopology where = box_topology(Vec3i(0), geometry.dims() - Vec3i(1));
  const AnalyticWarp shear = shear_warp({20, 15, 10}, 0.3);
  const OffsetField offsets = sample_offsets(shear, geometry, where);
  const Geometry grid({15, 14, 13}, geometry.world_from_index({6, 5, 4}),
                      {Vec3d(1.1, 0.1, 0.3), {-0.2, 1.3, 0}, {0, 0.1, 1.7}});
  const auto dense =
      all_slices<Vec3f>(dense_offsets(offsets, where, grid, VoidMode::outside), grid.dims());
  int compared = 0;
  for_each_slot(box_topology(Vec3i(0), grid.dims() - Vec3i(1)), [&](const Vec3i& v, std::size_t) {
    const Vec3d pos = geometry.index_from_world(grid.world_from_index(Vec3d(v)));
    if (std::min({pos.x, pos.y, pos.z, 39 - pos.x, 29 - pos.y, 19 - pos.z}) < 0) return;
    const Vec3d expected = geometry.world_vector_from_index(shear.offset_voxels(pos));
    ASSERT_LT((Vec3d(dense[dense_index(v, grid.dims())]) - expected).length(), 1e-5);
    ++compared;
  });
  EXPECT_GT(compared, 500);
}

TEST(PropertyDenseOffsets, AGrownGridHoldsTheSameVectorsInItsMiddle) {
  std::mt19937 random(33);
  const Geometry geometry = oblique_geometry({12, 13, 14}, {-31, 17, 5}, {0.7, 1, 2}, 0.2);
  const BrickTopology where = box_topology({3, 3, 3}, {10, 9, 11});
  const OffsetField offsets{
      geometry, field_on(where, [&](const Vec3i&) { return random_vector(random, 2); }), {}};
  const Geometry grid = with_margin(geometry, 5);
  const Vec3i margin(8, 5, 3);
  ASSERT_EQ(grid.dims(), geometry.dims() + margin * 2);
  for (const VoidMode mode : {VoidMode::nearest, VoidMode::extend, VoidMode::outside}) {
    const auto small =
        all_slices<Vec3f>(dense_offsets(offsets, where, geometry, mode), geometry.dims());
    const auto large = all_slices<Vec3f>(dense_offsets(offsets, where, grid, mode), grid.dims());
    for_each_slot(box_topology(Vec3i(0), geometry.dims() - Vec3i(1)),
                  [&](const Vec3i& v, std::size_t) {
                    ASSERT_EQ(small[dense_index(v, geometry.dims())],
                              large[dense_index(v + margin, grid.dims())]);
                  });
  }
}

TEST(UnitDenseDisplacement, HoldsTheVectorsInMillimetresAndZeroInTheAir) {
  const Geometry geometry = oblique_geometry(Vec3i(8), {-31, 17, 5}, {1, 2, 3}, 0.3);
  const Displacement displacement{geometry, field_on(box_topology(Vec3i(2), Vec3i(4)),
                                                     [](const Vec3i& v) { return Vec3f(v); })};
  const auto dense = all_slices<Vec3f>(dense_displacement(displacement), geometry.dims());
  EXPECT_EQ(dense[dense_index({1, 2, 2}, geometry.dims())], Vec3f(0));
  EXPECT_EQ(dense[dense_index({2, 3, 4}, geometry.dims())],
            Vec3f(geometry.world_vector_from_index({2, 3, 4})));
}

TEST(PropertyDenseResampled, AShiftByWholeVoxelsMovesTheDensitiesExactly) {
  std::mt19937 random(34);
  std::uniform_real_distribution<float> value(0, 100);
  const Geometry geometry = oblique_geometry(Vec3i(16), {-31, 17, 5}, {1, 2, 3}, 0.6);
  const BrickTopology where = box_topology(Vec3i(3), Vec3i(9));
  std::vector<float> values(where.brick_count() * kBrickVoxels, -7);
  for_each_slot(where, [&](const Vec3i&, std::size_t slot) { values[slot] = value(random); });
  const DensityGrid density = make_density_grid(where, values, -7);
  for (const Vec3i& shift : {Vec3i(0), Vec3i(2, -3, 4)}) {
    const OffsetField offsets =
        constant_offsets(geometry, box_topology(Vec3i(3) + shift, Vec3i(9) + shift), Vec3f(-shift));
    const auto dense =
        all_slices<float>(dense_resampled(offsets, density, geometry, -50), geometry.dims());
    for_each_slot(box_topology(Vec3i(0), Vec3i(15)), [&](const Vec3i& v, std::size_t) {
      const bool material = where.is_active(v - shift);
      ASSERT_EQ(dense[dense_index(v, geometry.dims())], material ? density.at(v - shift) : -50);
    });
  }
}

TEST(PropertyDenseResampled, AOneSliceVolumeIsResampledInItsPlane) {
  const Geometry geometry = unit_geometry({24, 18, 1});
  const BrickTopology where = box_topology({0, 0, 0}, {23, 17, 0});
  std::vector<float> values(where.brick_count() * kBrickVoxels, 0);
  for_each_slot(where, [&](const Vec3i& v, std::size_t slot) { values[slot] = float(v.x); });
  const Displacement stretched{
      geometry, field_on(where, [](const Vec3i& v) { return Vec3f(0.5f * float(v.x), 0, 0); })};
  const auto dense = all_slices<float>(
      dense_resampled(invert(stretched), make_density_grid(where, values, 0), geometry, -1),
      geometry.dims());
  for (int i = 0; i < 24; ++i)
    EXPECT_NEAR(dense[dense_index({i, 9, 0}, geometry.dims())], i / 1.5, 1e-4);
}

TEST(UnitCountOutside, CountsTheMovedVoxelsBeyondTheGrid) {
  const Geometry geometry = oblique_geometry(Vec3i(10), {-31, 17, 5}, {1, 2, 3}, 0.3);
  // Voxels 7 to 9 along i move by 1.6: the last face lies at 9.5, so 8 and 9 are lost.
  const BrickTopology where = box_topology({7, 0, 2}, {9, 4, 4});
  const Displacement moved{geometry,
                           {where, BrickVectors::of(std::vector<Vec3f>(
                                       where.brick_count() * kBrickVoxels, Vec3f(1.6f, 0, 0)))}};
  EXPECT_EQ(count_outside(moved, geometry), 2 * 5 * 3);
  EXPECT_EQ(count_outside(moved, with_margin(geometry, 9)), 0);
}

TEST(UnitWithMargin, GrowsByWholeVoxelsAndRefusesNonsense) {
  const Geometry geometry = unit_geometry({4, 5, 6});
  const Geometry grown = with_margin(geometry, 2.2);
  EXPECT_EQ(grown.dims(), Vec3i(10, 11, 12));
  EXPECT_EQ(grown.world_from_index({3, 3, 3}), Vec3d(0));
  EXPECT_TRUE(with_margin(geometry, 0) == geometry);
  EXPECT_EQ(with_margin(geometry, 2).dims(), Vec3i(8, 9, 10));
  for (const double bad : {-1.0, std::numeric_limits<double>::quiet_NaN(), 1e300}) {
    EXPECT_THROW(with_margin(geometry, bad), InputError);
  }
}
