#include <gtest/gtest.h>

#include "tests/support/field_fixtures.h"
#include "tests/support/sanitized.h"
#include "volumes/base/parallel.h"
#include "volumes/field/offset_field.h"
#include "volumes/field/ring_fill.h"
#include "volumes/grid/voxel_sets.h"

using namespace supple;
using namespace supple::test;

namespace {

/// Ring by ring on a map of voxels, as plain as can be: two linear ones, then means.
VoxelField brute_force_rings(VoxelField field, const BrickTopology& target, int rings) {
  for (int ring = 0; ring < rings; ++ring) {
    VoxelField grown;
    for_each_slot(target, [&](const Vec3i& v, std::size_t) {
      if (field.count(key(v))) return;
      Vec3d sum(0), linear(0);
      int count = 0, rows = 0;
      for (int x = -1; x <= 1; ++x) {
        for (int y = -1; y <= 1; ++y) {
          for (int z = -1; z <= 1; ++z) {
            const auto found = field.find(key(v + Vec3i(x, y, z)));
            if (found == field.end()) continue;
            const Vec3d near(found->second);
            sum += near;
            ++count;
            const auto behind = field.find(key(v + 2 * Vec3i(x, y, z)));
            if (ring >= 2 || behind == field.end()) continue;
            for (int a = 0; a < 3; ++a) {
              linear[a] += near[a] + std::clamp(near[a] - double(behind->second[a]), -1.0, 1.0);
            }
            ++rows;
          }
        }
      }
      if (count == 0) return;
      grown[key(v)] = rows > 0 ? Vec3f(linear / double(rows)) : Vec3f(sum / double(count));
    });
    if (grown.empty()) break;
    field.insert(grown.begin(), grown.end());
  }
  return field;
}

VectorBricks random_blob(std::mt19937& random, const Vec3i& lo, const Vec3i& hi, double density) {
  std::bernoulli_distribution active(density);
  return field_on(topology_where(lo, hi, [&](const Vec3i&) { return active(random); }),
                  [&](const Vec3i&) { return random_vector(random, 5); });
}

}  // namespace

TEST(PropertyExtend, EqualsTheBruteForceRingsBitForBit) {
  std::mt19937 random(11);
  for (int n = 0; n < cases(12); ++n) {
    const VectorBricks seed = random_blob(random, {-9, -5, -12}, {6, 9, 3}, 0.02);
    const BrickTopology target = random_blob(random, {-14, -10, -14}, {10, 12, 8}, 0.6).topology;
    const Displacement extended = extend({unit_geometry({9, 9, 9}), seed}, target);
    EXPECT_EQ(to_map(extended.u), brute_force_rings(to_map(seed), target, 1000)) << n;
  }
}

TEST(PropertyExtend, KeepsTheSeedAndLeavesUnreachableVoxelsInvalid) {
  const VectorBricks seed =
      field_on(box_topology({0, 0, 0}, {3, 3, 3}), [](const Vec3i& v) { return Vec3f(v); });
  const BrickTopology target = topology_where(
      {0, 0, 0}, {40, 3, 3}, [](const Vec3i& v) { return (v.x > 3 && v.x < 7) || v.x > 8; });
  const VectorBricks extended = extend({unit_geometry({41, 4, 4}), seed}, target).u;
  Vec3f vector;
  ASSERT_TRUE(extended.at({2, 1, 3}, vector));
  EXPECT_EQ(vector, Vec3f(2, 1, 3));
  EXPECT_TRUE(extended.at({6, 0, 0}, vector));
  EXPECT_FALSE(extended.at({8, 0, 0}, vector));
  EXPECT_FALSE(extended.at({9, 0, 0}, vector));
  EXPECT_EQ(extended.topology.active_count(), 7 * 16);
}

TEST(PropertyExtend, AConstantFieldStaysThatConstantExactly) {
  for (const Vec3f& constant : {Vec3f(0), Vec3f(0.1f, -3.7f, 1234.567f)}) {
    const VectorBricks seed =
        field_on(box_topology({0, 0, 0}, {4, 9, 3}), [&](const Vec3i&) { return constant; });
    const BrickTopology target = dilate(seed.topology, 5);
    const VectorBricks extended = extend({unit_geometry({9, 9, 9}), seed}, target).u;
    EXPECT_TRUE(extended.topology == target);
    for_each_slot(target, [&](const Vec3i&, std::size_t slot) {
      ASSERT_EQ(extended.vectors.at(slot), constant);
    });
  }
}

TEST(PropertyExtend, ALinearFieldGoesOnLinearlyForTwoRings) {
  const auto linear = [](const Vec3i& v) {
    return Vec3f(Vec3d(0.25 * v.x - 0.5 * v.y, 0.125 * v.z, -0.75 * v.x));
  };
  const BrickTopology ball = topology_where(
      Vec3i(0), Vec3i(20), [](const Vec3i& v) { return (Vec3d(v) - Vec3d(10)).length() < 8; });
  const BrickTopology target = dilate(ball, 4);
  const VectorBricks extended =
      extend({unit_geometry(Vec3i(21)), field_on(ball, linear)}, target).u;
  const BrickTopology near = dilate(ball, 2);
  int beyond = 0;
  for_each_slot(target, [&](const Vec3i& v, std::size_t slot) {
    if (near.is_active(v)) {
      ASSERT_EQ(extended.vectors.at(slot), linear(v)) << v;
    } else {
      beyond += extended.vectors.at(slot) != linear(v);
    }
  });
  EXPECT_GT(beyond, 1000);  // which take means
}

TEST(PropertyExtend, JumpsAreNotContinuedByMoreThanAVoxel) {
  const VectorBricks seed = field_on(box_topology({0, 0, 0}, {1, 0, 0}),
                                     [](const Vec3i& v) { return Vec3f(float(50 * v.x), 0, 0); });
  const VectorBricks extended =
      extend({unit_geometry(Vec3i(5)), seed}, box_topology({0, 0, 0}, {3, 0, 0})).u;
  Vec3f u;
  ASSERT_TRUE(extended.at({2, 0, 0}, u));
  EXPECT_EQ(u, Vec3f(51, 0, 0));
}

TEST(PropertyExtend, DoesNotDependOnTheNumberOfThreads) {
  std::mt19937 random(12);
  const VectorBricks seed = random_blob(random, {0, 0, 0}, {60, 60, 60}, 0.001);
  const BrickTopology target = box_topology({-4, -4, -4}, {64, 64, 64});
  const auto with_threads = [&](int threads) {
    return on_threads(threads, [&] {
      return extend({unit_geometry({61, 61, 61}), seed}, target).u;
    });
  };
  const VectorBricks one = with_threads(1), four = with_threads(4);
  EXPECT_TRUE(one.topology == four.topology);
  EXPECT_EQ(one.vectors, four.vectors);
}

TEST(UnitRingFill, TheRingOfAVoxelIsItsChebyshevDistanceInTheOpen) {
  const VectorBricks seed =
      field_on(box_topology({7, 7, 7}, {7, 7, 7}), [](const Vec3i&) { return Vec3f(1); });
  std::vector<std::uint8_t> ring;
  const VectorBricks filled =
      fill_rings(seed, box_topology({0, 0, 0}, {20, 20, 20}), 5, RingFill::means, &ring);
  EXPECT_EQ(filled.topology.active_count(), 11 * 11 * 11);
  for_each_slot(filled.topology, [&](const Vec3i& v, std::size_t slot) {
    const Vec3i d = v - Vec3i(7);
    EXPECT_EQ(ring[slot], std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)}));
  });
}

TEST(UnitRingFill, TheUnionHoldsTheVoxelsOfBoth) {
  const BrickTopology a = box_topology({0, 0, 0}, {9, 3, 3});
  const BrickTopology b = box_topology({-9, 2, 2}, {1, 20, 3});
  const BrickTopology both = unite(a, b);
  for_each_slot(box_topology({-10, -1, -1}, {21, 21, 5}), [&](const Vec3i& v, std::size_t) {
    EXPECT_EQ(both.is_active(v), a.is_active(v) || b.is_active(v));
  });
}
