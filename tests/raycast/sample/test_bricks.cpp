// Sampling bricks, offset bricks, classification, bounds: the parts of the marcher.
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "raycast/march/embree_bounds.h"
#include "raycast/sample/classify.h"
#include "raycast/sample/offset_bricks.h"
#include "tests/raycast/scenes.h"
#include "tests/support/scalar_sampling.h"
#include "volumes/base/parallel.h"
#include "volumes/grid/padded_rows.h"
#include "volumes/grid/voxel_sets.h"

namespace supple {
namespace {

VectorBricks offsets_of(const BrickTopology& where, const std::function<Vec3d(const Vec3d&)>& o) {
  VectorBricks field{where, BrickVectors(where.brick_count())};
  for (std::size_t b = 0; b < where.brick_count(); ++b) {
    for_each_active(where.mask(b), [&](int n) {
      field.vectors.touch(b)[n] = Vec3f(o(Vec3d(where.origin(b) + brick_local(n))));
    });
  }
  return field;
}

SourceCell cell_at(const SourceBricks& bricks, const Vec3i& voxel, const Vec3f& within) {
  const std::int32_t b = bricks.topology().find(voxel);
  return {bricks.node(b, voxel - bricks.topology().origin(b)), within.x, within.y, within.z};
}

std::size_t deformed_count(const OffsetBricks& bricks) {
  std::size_t count = 0;
  for (std::size_t b = 0; b < bricks.brick_count(); ++b) count += bricks.is_deformed(b);
  return count;
}

TEST(UnitBricks, OffsetsTakeTheMemoryThatIsDocumented) {
  // docs/offsets.md, bytes per brick of 8^3 voxels.
  const BrickTopology where = voxels_of(Vec3i(64), everywhere);
  const SourceBricks source(grid_of(where, [](const Vec3d& p) { return p.x; }));
  VectorBricks moved{where, {}};
  moved.vectors = vectors_of(where, Vec3f(0.3f, -0.2f, 0.1f));
  const auto per_brick = [&](const OffsetBricks& bricks) {
    return double(bricks.bytes()) / double(bricks.brick_count());
  };
  const OffsetBricks straight(source), full(source, moved), half(source, moved, nullptr, 2);
  EXPECT_GT(deformed_count(full), 500u);
  EXPECT_NEAR(per_brick(full), 9000, 100);
  EXPECT_NEAR(per_brick(straight), 90, 10);
  EXPECT_NEAR(per_brick(half), 1700, 50);
}

TEST(UnitBricks, OpacityIsCorrectedForTheStepByHand) {
  EXPECT_DOUBLE_EQ(corrected_opacity(0.75, 0.5, 1.0), 0.5);
  EXPECT_DOUBLE_EQ(corrected_opacity(0.5, 2.0, 1.0), 0.75);
  EXPECT_DOUBLE_EQ(corrected_opacity(1.0, 0.1, 1.0), 1.0);
  EXPECT_DOUBLE_EQ(corrected_opacity(0.0, 0.1, 1.0), 0.0);
}

TEST(UnitBricks, IntegerDataOfASixteenBitRangeAreExact) {
  std::mt19937 random(1);
  const BrickTopology where = voxels_of({16, 16, 16}, everywhere);
  for (const int range : {1, 4095, 65533}) {
    const DensityGrid grid = grid_of(where, [&](const Vec3d& p) {
      return p.x == 0 ? -1024 : p.x == 1 ? range - 1024 : double(int(random() % range) - 1024);
    });
    const SourceBricks bricks(grid);
    for (int n = 0; n < 4096; ++n) {
      const Vec3i voxel(n >> 8, (n >> 4) & 15, n & 15);
      ASSERT_EQ(bricks.density(*cell_at(bricks, voxel, Vec3f(0)).node), grid.at(voxel));
    }
  }
}

TEST(UnitBricks, OneFractionAmongIntegersIsSeenWhateverTheirSize) {
  for (const bool is_full : {true, false}) {
    const BrickTopology where =
        voxels_of({16, 16, 16}, [&](const Vec3i& v) { return is_full || v != Vec3i(3); });
    // Up to 2^23, from which on all floats are integers; sums of integers above 2^22 are not exact.
    for (const double base : {-8388592.0, -4194310.0, -20.0, 4194294.0, 8388592.0}) {
      const auto scale_with = [&](double odd) {
        return SourceBricks(
                   grid_of(where,
                           [&](const Vec3d& p) { return p == Vec3d(9, 4, 12) ? odd : base + p.x; }))
            .scale();
      };
      EXPECT_EQ(scale_with(base), 1) << base;
      EXPECT_NE(scale_with(base + 0.5), 1) << base;
      EXPECT_EQ(scale_with(std::numeric_limits<double>::quiet_NaN()), 1) << base;
      EXPECT_EQ(scale_with(HUGE_VAL), 1) << base;
    }
  }
}

TEST(UnitBricks, BricksAreFilledWhenTheyAreRead) {
  const BrickTopology where = voxels_of({32, 32, 32}, everywhere);
  const SourceBricks bricks(grid_of(where, [](const Vec3d& p) { return p.x + 100 * p.y; }));
  const std::size_t before = bricks.bytes();
  const std::size_t of_brick = SourceBricks::kBrickNodes * sizeof(std::int16_t);
  parallel_for(64, [&](int n) {
    const Vec3i local(n & 7, n >> 3, 3);
    EXPECT_EQ(*bricks.node(5, local),
              std::int16_t(where.origin(5).x + local.x + 100 * (where.origin(5).y + local.y)));
  });
  EXPECT_EQ(bricks.bytes(), before + of_brick);
  bricks.ensure(6);
  bricks.ensure(5);
  EXPECT_EQ(bricks.bytes(), before + 2 * of_brick);
  for (const Interpolation cubic : {Interpolation::cubic, Interpolation::interpolating}) {
    const SourceBricks all(grid_of(where, [](const Vec3d& p) { return p.x; }), cubic);
    EXPECT_GE(all.bytes(), where.brick_count() * of_brick);
  }
}

TEST(PropertyBricks, RangesAreThoseOfTheNodesThatCellsReach) {
  std::mt19937 random(9);
  const BrickTopology where =
      voxels_of({40, 24, 24}, [&](const Vec3i&) { return random() % 16 != 0; });
  // Along the ramps the ends of a range lie in the corner that a brick shares with the next.
  const std::function<double(const Vec3d&)> laws[] = {
      [&](const Vec3d&) { return double(random() % 5000) - 1024; },
      [](const Vec3d& p) { return p.x + 2 * p.y + 3 * p.z; },
      [](const Vec3d& p) { return -p.x - 2 * p.y - 3 * p.z; }};
  for (const auto& law : laws) {
    const SourceBricks bricks(grid_of(where, law));
    for (std::size_t b = 0; b < where.brick_count(); ++b) {
      EncodedRange range;
      for (int n = 0; n < 729; ++n) {
        const std::int16_t code = *bricks.node(b, {n / 81, n / 9 % 9, n % 9});
        if (code != SourceBricks::kVoid) range.add(float(code));
      }
      EXPECT_EQ(bricks.range(b).lo, range.lo) << where.origin(b);
      EXPECT_EQ(bricks.range(b).hi, range.hi) << where.origin(b);
    }
  }
}

TEST(UnitBricks, ASampleIsEmptyWhenAnyCornerIsVoid) {
  const BrickTopology where =
      voxels_of({16, 16, 16}, [](const Vec3i& v) { return v != Vec3i(8, 8, 8); });
  const SourceBricks bricks(grid_of(where, [](const Vec3d& p) { return p.x; }));
  float value = 0;
  for (int c = 0; c < 8; ++c) {
    const Vec3i base(8 - (c & 1), 8 - ((c >> 1) & 1), 8 - (c >> 2));
    EXPECT_FALSE(sample_cell(cell_at(bricks, base, Vec3f(0)), value));
  }
  EXPECT_TRUE(sample_cell(cell_at(bricks, {6, 7, 7}, Vec3f(0.5f)), value));
  EXPECT_FALSE(sample_cell(cell_at(bricks, {15, 3, 3}, Vec3f(0)), value));
}

TEST(UnitBricks, TheGradientOfALinearFieldIsExactAlsoAcrossBricksAndBesideTheVoid) {
  const BrickTopology where = voxels_of({24, 24, 24}, everywhere);
  const SourceBricks bricks(
      grid_of(where, [](const Vec3d& p) { return 3 * p.x - 2 * p.y + 5 * p.z; }));
  for (const Vec3i& voxel : {Vec3i(3, 3, 3), Vec3i(7, 8, 15), Vec3i(0, 0, 0), Vec3i(22, 22, 22)}) {
    const SourceCell cell = cell_at(bricks, voxel, {0.25f, 0.5f, 0.75f});
    float value = 0;
    ASSERT_TRUE(sample_cell(cell, value));
    const Vec3d p = Vec3d(voxel) + Vec3d(0.25, 0.5, 0.75);
    EXPECT_NEAR(bricks.density(value), 3 * p.x - 2 * p.y + 5 * p.z, 1e-4);
    const Vec3f gradient = sample_gradient(cell, value);
    EXPECT_NEAR(gradient.x, 3, 1e-4);
    EXPECT_NEAR(gradient.y, -2, 1e-4);
    EXPECT_NEAR(gradient.z, 5, 1e-4);
  }
}

TEST(UnitBricks, ASheetOneCellThickHasNoGradientAcrossItself) {
  const BrickTopology where =
      voxels_of({8, 8, 8}, [](const Vec3i& v) { return v.x == 3 || v.x == 4; });
  const SourceBricks bricks(grid_of(where, [](const Vec3d& p) { return p.x * p.x + p.y; }));
  const SourceCell cell = cell_at(bricks, {3, 3, 3}, Vec3f(0.5f));
  float value = 0;
  ASSERT_TRUE(sample_cell(cell, value));
  const Vec3f gradient = sample_gradient(cell, value);
  EXPECT_EQ(gradient.x, 0);
  EXPECT_NEAR(gradient.y, 1, 1e-5);
}

TEST(UnitBricks, GradientsArePulledBackByTheTransposeOfIdentityPlusGradO) {
  const BrickTopology where = voxels_of({8, 8, 8}, everywhere);
  const SourceBricks source(grid_of(where, [](const Vec3d& p) { return p.x; }));
  // o = M x with rows (0, 2, 0), (0, 0, 3), (4, 0, 0).
  const OffsetBricks bricks(
      source, offsets_of(where, [](const Vec3d& p) { return Vec3d(2 * p.y, 3 * p.z, 4 * p.x); }));
  const std::size_t brick = bricks.find({0, 0, 0});
  const NodeCell cell{bricks.node(brick, {2, 3, 4}), 0.5f, 0.25f, 0.75f};
  const Vec3f offset = sample_offset(cell);
  EXPECT_FLOAT_EQ(offset[0], 6.5f);
  EXPECT_FLOAT_EQ(offset[1], 14.25f);
  EXPECT_FLOAT_EQ(offset[2], 10.0f);
  const Vec3f g = pull_back_gradient(cell, {1, 10, 100});
  EXPECT_NEAR(g.x, 1 + 400, 1e-3);
  EXPECT_NEAR(g.y, 10 + 2, 1e-3);
  EXPECT_NEAR(g.z, 100 + 30, 1e-3);
}

TEST(UnitBricks, SmoothPullBackIsExactWhereOffsetsAreLinearAndHasNoStepWhereCellsMeet) {
  const BrickTopology where = voxels_of({24, 16, 16}, everywhere);
  const SourceBricks source(grid_of(where, [](const Vec3d& p) { return p.x; }));
  for (const int spacing : {1, 2}) {
    const OffsetBricks linear(
        source,
        offsets_of(
            where,
            [](const Vec3d& p) { return Vec3d(0.25 * p.x, 0.5 * p.x - 0.125 * p.y, 0.25 * p.z); }),
        nullptr, spacing);
    Vec3f pulled;
    ASSERT_TRUE(pull_back_smoothly(linear, {7.9, 5.3, 8.2}, {1, 2, 4}, pulled));
    EXPECT_NEAR(pulled.x, 1 + 0.25 * 1 + 0.5 * 2, 1e-5);
    EXPECT_NEAR(pulled.y, 2 - 0.125 * 2, 1e-5);
    EXPECT_NEAR(pulled.z, 4 + 0.25 * 4, 1e-5);
    // A kink in the plane x = 8, where bricks meet.
    const OffsetBricks kinked(
        source, offsets_of(where, [](const Vec3d& p) { return Vec3d(std::abs(p.x - 8), 0, 0); }),
        nullptr, spacing);
    Vec3f before, after;
    ASSERT_TRUE(pull_back_smoothly(kinked, {7.999, 5.3, 8.2}, {1, 0, 0}, before));
    ASSERT_TRUE(pull_back_smoothly(kinked, {8.001, 5.3, 8.2}, {1, 0, 0}, after));
    EXPECT_NEAR(before.x, after.x, 0.01);
    EXPECT_NEAR(before.x, 1, 0.01);
    ASSERT_TRUE(pull_back_smoothly(kinked, {10.5, 5.3, 8.2}, {1, 0, 0}, after));
    EXPECT_NEAR(after.x, 2, 1e-5);
    EXPECT_FALSE(pull_back_smoothly(kinked, {23.9, 5.3, 8.2}, {1, 0, 0}, after));
  }
}

TEST(UnitBricks, ZeroOffsetsGiveIdentityBricksAndOneVectorMakesItsBricksDeformed) {
  const BrickTopology where = voxels_of({32, 32, 32}, [](const Vec3i& v) { return v.x > 2; });
  const SourceBricks source(grid_of(where, [](const Vec3d& p) { return p.y; }));
  VectorBricks offsets = offsets_of(where, [](const Vec3d&) { return Vec3d(0); });
  EXPECT_EQ(deformed_count(OffsetBricks(source, offsets)), 0u);
  offsets.vectors.touch(std::size_t(where.find({16, 16, 16})))[0] = Vec3f(0.5f, 0, 0);
  // Its own brick and the seven whose apron holds the node.
  EXPECT_EQ(deformed_count(OffsetBricks(source, offsets)), 8u);
}

TEST(UnitBricks, AVacatedPlaceIsNotAnIdentityBrick) {
  const BrickTopology where = voxels_of({16, 16, 16}, everywhere);
  const SourceBricks source(grid_of(where, [](const Vec3d& p) { return p.y; }));
  const BrickTopology reached = voxels_of({16, 16, 16}, [](const Vec3i& v) { return v.x > 5; });
  const OffsetBricks bricks(source, offsets_of(reached, [](const Vec3d&) { return Vec3d(0); }));
  EXPECT_FALSE(bricks.is_identity(bricks.find({0, 0, 0})));
  EXPECT_TRUE(bricks.is_identity(bricks.find({8, 8, 8})));
  // Cells of a brick touch the voxels above it, even across a gap.
  const BrickTopology apart = voxels_of({16, 8, 8}, [](const Vec3i& v) { return v.x / 4 != 1; });
  const SourceBricks parts(grid_of(apart, [](const Vec3d& p) { return p.y; }));
  const BrickTopology lower = voxels_of({4, 8, 8}, everywhere);
  const OffsetBricks left(parts, {lower, BrickVectors(lower.brick_count())});
  EXPECT_FALSE(left.is_identity(left.find({0, 0, 0})));
}

TEST(UnitBricks, VectorsThatLeadNowhereCountAsNone) {
  const BrickTopology where = voxels_of({16, 16, 16}, everywhere);
  const SourceBricks source(grid_of(where, [](const Vec3d& p) { return p.y; }));
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  // The second leads somewhere, though its longest component is beyond a third of what does.
  for (const auto& [vector, leads] :
       {std::pair(Vec3f(0, 3e6F, 0), false), std::pair(Vec3f(0, 5e5F, 0), true),
        std::pair(Vec3f(kNaN, 0, 0), false)}) {
    VectorBricks offsets = offsets_of(where, [](const Vec3d&) { return Vec3d(1, 0, 0); });
    offsets.vectors.touch(std::size_t(where.find({0, 0, 0})))[brick_offset(Vec3i(3))] = vector;
    const OffsetBricks bricks(source, offsets);
    const float* const node = bricks.node(std::size_t(bricks.find({0, 0, 0})), Vec3i(3));
    EXPECT_EQ(std::isnan(node[0]) && std::isnan(node[1]) && std::isnan(node[2]), !leads) << vector;
    EXPECT_EQ(node[3], 1) << vector;  // the next along z
  }
  // Nor is a brick with such a place at rest, inside and beside void.
  const BrickTopology part = voxels_of({16, 16, 16}, [](const Vec3i& v) { return v.x < 12; });
  const SourceBricks cut(grid_of(part, [](const Vec3d& p) { return p.y; }));
  for (const Vec3i& voxel : {Vec3i(3), Vec3i(11, 3, 3)}) {
    VectorBricks still = offsets_of(part, [](const Vec3d&) { return Vec3d(0); });
    still.vectors.touch(std::size_t(part.find(voxel)))[brick_offset(voxel)] = Vec3f(0, kNaN, 0);
    const OffsetBricks bricks(cut, still);
    EXPECT_FALSE(bricks.is_identity(std::size_t(bricks.find(voxel)))) << voxel;
  }
}

/// Compares all that samples tell of a brick: nothing, no brick and no densities are the same.
void expect_same_brick(const OffsetBricks& a, const OffsetBricks& b, const Vec3i& origin) {
  const std::int32_t m = a.find(origin), n = b.find(origin);
  const auto is = [](const OffsetBricks& bricks, std::int32_t brick, bool deformed) {
    return brick >= 0 && (deformed ? bricks.is_deformed(brick)
                                   : bricks.is_identity(brick) && !bricks.range(brick).empty());
  };
  ASSERT_EQ(is(a, m, true), is(b, n, true)) << origin;
  ASSERT_EQ(is(a, m, false), is(b, n, false)) << origin;
  if (!is(a, m, true)) return;
  EXPECT_EQ(a.range(m).lo, b.range(n).lo);
  EXPECT_EQ(a.range(m).hi, b.range(n).hi);
  EXPECT_EQ(
      std::memcmp(a.node(m, {0, 0, 0}), b.node(n, {0, 0, 0}), BrickNodes::kFloats * sizeof(float)),
      0)
      << origin;
}

TEST(PropertyBricks, OffsetsOfBricksThatRestNeedNotBeStored) {
  std::mt19937 random(23);
  for (int round = 0; round < 20; ++round) {
    const int empty = int(random() % 7);  // a layer of bricks
    const BrickTopology where = voxels_of(
        {48, 32, 32}, [&](const Vec3i& v) { return v.x >> 3 != empty && random() % 300 != 0; });
    const SourceBricks source(grid_of(where, [](const Vec3d& p) { return 7 * p.x + p.y * p.z; }));
    // Places that nothing reaches, mostly where cells of the brick below have corners.
    std::vector<Vec3i> left;
    for (int n = round % 4; n > 0; --n) {
      Vec3i middle(int(random() % 48), int(random() % 32), int(random() % 32));
      middle[int(random() % 3)] &= ~7;
      for (int m = 0; m < 27; ++m) left.push_back(middle + surrounding_step(m));
    }
    const BrickTopology reached = subtract(where, topology_of(left));
    VectorBricks sparse{reached, BrickVectors(reached.brick_count())};
    for (int moving = round % 3; moving > 0; --moving) {
      sparse.vectors.touch(random() % reached.brick_count())[random() % 512] = Vec3f(2, -1, 0.5F);
    }
    VectorBricks all = sparse;
    all.vectors.touch_all();
    const OffsetBricks found(source, sparse), wanted(source, all);
    EXPECT_EQ(deformed_count(found), deformed_count(wanted));
    EXPECT_EQ(found.valid_bounds().lo, wanted.valid_bounds().lo);
    EXPECT_EQ(found.valid_bounds().hi, wanted.valid_bounds().hi);
    for (int n = 0; n < 8 * 6 * 6; ++n) {
      expect_same_brick(found, wanted, Vec3i(n / 36 - 1, n / 6 % 6 - 1, n % 6 - 1) * kBrickDim);
    }
  }
}

TEST(PropertyBricks, UpdatedBricksAreThoseOfTheChangedOffsets) {
  std::mt19937 random(7);
  const SourceBricks source(
      grid_of(voxels_of({40, 40, 40}, everywhere), [](const Vec3d& p) { return 10 * p.x + p.y; }));
  // Some vectors of the changed bricks change, and which voxels have any.
  BrickTopology where = voxels_of({40, 40, 40}, [](const Vec3i& v) { return v.z < 30; });
  VectorBricks offsets = offsets_of(where, [](const Vec3d&) { return Vec3d(0); });
  OffsetBricks followed(source, offsets);
  for (int step = 0; step < 6; ++step) {
    const Vec3i corner(int(random() % 32), int(random() % 32), int(random() % 32));
    const IndexBox box{corner, corner + Vec3i(9)};
    const VectorBricks before = offsets;
    where = voxels_of({40, 40, 40}, [&](const Vec3i& v) {
      return box.contains(v) ? (v.x + step) % 4 != 0 : before.topology.is_active(v);
    });
    offsets = offsets_of(where, [&](const Vec3d& p) {
      const Vec3i voxel(int(p.x), int(p.y), int(p.z));
      Vec3f old(0, 0, 0);
      before.at(voxel, old);
      return box.contains(voxel) ? Vec3d(0.5 * (step % 3), 0, -0.25) : Vec3d(old);
    });
    for (std::size_t b = 0; step % 2 && b < offsets.topology.brick_count(); ++b) {
      if (are_zeros(offsets.vectors.brick_or_zero(b))) offsets.vectors.release(b);
    }
    std::vector<Vec3i> changed;
    for (int n = 0; n < 125; ++n) {
      const Vec3i origin = Vec3i(n / 25, n / 5 % 5, n % 5) * kBrickDim;
      const IndexBox brick{origin, origin + Vec3i(kBrickDim - 1)};
      bool meets = true;
      for (int a = 0; a < 3; ++a) {
        meets = meets && brick.lo[a] <= box.hi[a] && box.lo[a] <= brick.hi[a];
      }
      if (meets) changed.push_back(origin);
    }
    followed.update(changed, finder_of(offsets));
    const OffsetBricks anew(source, offsets);
    EXPECT_TRUE(followed.valid_bounds() == anew.valid_bounds());
    EXPECT_EQ(deformed_count(followed), deformed_count(anew));
    for (int n = 0; n < 343; ++n) {
      expect_same_brick(followed, anew, (Vec3i(n / 49, n / 7 % 7, n % 7) - Vec3i(1)) * kBrickDim);
    }
  }
}

TEST(PropertyBricks, RangesCallNothingTransparentThatASampleCanShow) {
  std::mt19937 random(2);
  const BrickTopology where = voxels_of({16, 16, 16}, everywhere);
  const SourceBricks source(
      grid_of(where, [&](const Vec3d&) { return double(int(random() % 4000) - 1000); }));
  std::uniform_real_distribution<float> within(0, 1);
  for (const double threshold : {-900.0, 500.0, 2500.0, 2998.5}) {
    TransferFunction f;
    f.opacity = {{threshold, 0}, {threshold + 0.5, 1}};
    f.colour = {{0, {1, 1, 1}}};
    const Classifier classifier(f, source, 0.5);
    for (int n = 0; n < 4000; ++n) {
      const Vec3i voxel(int(random() % 15), int(random() % 15), int(random() % 15));
      float value = 0;
      ASSERT_TRUE(sample_cell(
          cell_at(source, voxel, {within(random), within(random), within(random)}), value));
      if (classifier.classify(value)[3] > 0) {
        ASSERT_TRUE(classifier.may_be_visible(source.range(source.topology().find(voxel))));
      }
    }
  }
}

TEST(PropertyBricks, IntervalsCoverEveryPlaceInsideAVisibleBrick) {
  std::mt19937 random(3);
  const BrickTopology where = voxels_of({64, 64, 64}, [&](const Vec3i& v) {
    return ((v.x >> 3) * 7 + (v.y >> 3) * 5 + (v.z >> 3) * 3) % 4 == 0;
  });
  std::vector<std::uint8_t> visible(where.brick_count());
  for (std::uint8_t& v : visible) v = random() % 3 == 0;
  const VisibleBounds bounds(where.index(), visible);
  std::uniform_real_distribution<double> coordinate(-20, 84), unit(-1, 1);
  std::vector<Interval> intervals;
  for (int n = 0; n < 500; ++n) {
    const IndexRay ray{{coordinate(random), coordinate(random), -4000},
                       {0.02 * unit(random) * (n % 3), 0.02 * unit(random) * (n % 4 < 2 ? 0 : 1),
                        n % 2 ? 1.0 : 1.3}};
    const Interval span = clip_to_box(ray, Vec3d(-1), Vec3d(64), {0, HUGE_VAL});
    if (span.begin > span.end) continue;
    bounds.intervals(ray, span, intervals);
    std::size_t next = 0;
    for (double t = span.begin; t <= span.end; t += 0.37) {
      const Vec3d p = ray.at(t);
      const std::int32_t b =
          where.find({int(std::floor(p.x)), int(std::floor(p.y)), int(std::floor(p.z))});
      while (next < intervals.size() && intervals[next].end < t) ++next;
      const bool covered = next < intervals.size() && intervals[next].begin <= t;
      if (b >= 0 && visible[b]) {
        ASSERT_TRUE(covered) << "ray " << n << " at " << t;
      }
    }
    for (std::size_t k = 1; k < intervals.size(); ++k) {
      ASSERT_LT(intervals[k - 1].end, intervals[k].begin);
    }
  }
}

}  // namespace
}  // namespace supple
