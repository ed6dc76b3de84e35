#include <gtest/gtest.h>

#include "tests/volumes/field/offset_fixtures.h"
#include "volumes/field/inversion/forward_offsets.h"
#include "volumes/field/inversion/invert.h"

using namespace supple;
using namespace supple::test;

namespace {

/// Smooth, without folds, and zero outside a ball.
Vec3f bump(const Vec3i& v) {
  const Vec3d d = (Vec3d(v) - Vec3d(20, 22, 18)) / 14;
  const double height = std::max(0.0, 1 - d.length2());
  return Vec3f(Vec3d(3, -2, 4) * height * height);
}

bool find(const ForwardOffsets& offsets, const Vec3d& x, PointwiseOffsets::Sample& found) {
  const std::int32_t b =
      offsets.bricks().find({int(std::floor(x.x)), int(std::floor(x.y)), int(std::floor(x.z))});
  return b >= 0 && offsets.sample(std::size_t(b), x, found);
}

}  // namespace

TEST(PropertyForwardOffsets, EverySampleInsideSolvesTheEquation) {
  const Displacement displacement = displacement_on(box_topology(Vec3i(0), Vec3i(39)), bump);
  const ForwardOffsets offsets(displacement);
  std::mt19937 random(1);
  int checked = 0;
  for (int n = 0; n < 4000; ++n) {
    const Vec3d x = random_place(random, 2, 37);
    PointwiseOffsets::Sample found;
    if (offsets.bricks().find({int(x.x), int(x.y), int(x.z)}) < 0) continue;
    ASSERT_TRUE(find(offsets, x, found)) << x;
    Vec3d u;
    ASSERT_TRUE(displacement.u.sample(x + found.offset, u));
    ASSERT_LT((found.offset + u).length(), 5e-4);
    ++checked;
  }
  EXPECT_GT(checked, 1500);
}

TEST(PropertyForwardOffsets, AtNodesTheyAreThoseOfTheInversion) {
  std::mt19937 random(2);
  const BrickTopology where = box_topology(Vec3i(0), Vec3i(30));
  const Displacement displacement = noisy_displacement(random, where, 0.15f, Vec3f(5.3f, 0, -2.7f));
  const ForwardOffsets offsets(displacement);
  const OffsetField inverse = invert(displacement);
  std::int64_t nodes = 0, missing = 0;
  for_each_slot(inverse.o.topology, [&](const Vec3i& v, std::size_t slot) {
    PointwiseOffsets::Sample found;
    ++nodes;
    if (!find(offsets, Vec3d(v), found)) {
      ++missing;
      return;
    }
    ASSERT_LT((found.offset - Vec3d(inverse.o.vectors.at(slot))).length(), 1e-3);
  });
  EXPECT_GT(nodes, 20000);
  EXPECT_LE(missing, nodes / 1000);  // on the very border
}

TEST(PropertyForwardOffsets, ThereIsNothingWhereMaterialHasLeftAndWhereItNeverWas) {
  const Displacement displacement = displacement_on(box_topology(Vec3i(0), Vec3i(15)),
                                                    [](const Vec3i&) { return Vec3f(20, 0, 0); });
  const ForwardOffsets offsets(displacement);
  PointwiseOffsets::Sample found;
  EXPECT_GE(offsets.bricks().find({8, 8, 8}), 0);
  EXPECT_FALSE(find(offsets, {8, 8, 8}, found));
  EXPECT_FALSE(find(offsets, {36.5, 8, 8}, found));
  ASSERT_TRUE(find(offsets, {28.5, 8, 8}, found));
  EXPECT_EQ(found.offset, Vec3d(-20, 0, 0));
}

TEST(PropertyForwardOffsets, WhereNothingMovesThereAreNoBricks) {
  const Displacement rest =
      displacement_on(box_topology(Vec3i(0), Vec3i(30)), [](const Vec3i&) { return Vec3f(0); });
  EXPECT_TRUE(ForwardOffsets(rest).bricks().empty());
}

TEST(PropertyForwardOffsets, GradientsArePulledBackAsTheOffsetsThemselvesChange) {
  const Displacement displacement = displacement_on(box_topology(Vec3i(0), Vec3i(39)), bump);
  const ForwardOffsets offsets(displacement);
  std::mt19937 random(3);
  const Vec3d g(1, -2, 0.5);
  const double h = 1e-2;
  int checked = 0;
  for (int n = 0; n < 500; ++n) {
    const Vec3d x = random_place(random, 10, 30);
    PointwiseOffsets::Sample here;
    ASSERT_TRUE(find(offsets, x, here));
    Vec3d expected = g;
    bool same_cell = true;
    for (int a = 0; a < 3; ++a) {
      Vec3d step(0);
      step[a] = h;
      PointwiseOffsets::Sample above = here, below = here;
      ASSERT_TRUE(find(offsets, x + step, above) && find(offsets, x - step, below));
      same_cell = same_cell && above.piece == here.piece && below.piece == here.piece;
      expected[a] += (above.offset - below.offset).dot(g) / (2 * h);
    }
    if (!same_cell) continue;
    ++checked;
    ASSERT_LT((offsets.pull_back(here.piece, x, x + here.offset, g) - expected).length(), 0.05);
  }
  EXPECT_GT(checked, 300);
}

TEST(PropertyForwardOffsets, AfterLocalChangesTheyAreThoseOfTheWholeDisplacement) {
  std::mt19937 random(4);
  Displacement displacement =
      displacement_on(box_topology(Vec3i(0), Vec3i(39)), [](const Vec3i&) { return Vec3f(0); });
  ForwardOffsets followed(displacement);
  for (int step = 0; step < 5; ++step) {
    const Vec3d centre = random_place(random, 5, 35);
    const float size = step == 3 ? 0 : 2;  // once back to rest
    std::vector<std::int32_t> changed;
    for_each_slot(displacement.u.topology, [&](const Vec3i& v, std::size_t slot) {
      const double share = 1 - (Vec3d(v) - centre).length2() / 100;
      if (share <= 0 && step != 3) return;
      displacement.u.vectors.set(slot, Vec3f(size * float(share), 0, 0));
      const std::int32_t b = std::int32_t(slot / kBrickVoxels);
      if (changed.empty() || changed.back() != b) changed.push_back(b);
    });
    followed.update(changed);
    const ForwardOffsets anew(displacement);
    ASSERT_TRUE(followed.bricks() == anew.bricks());
    EXPECT_EQ(anew.bricks().empty(), step == 3);
    for (int n = 0; n < 2000; ++n) {
      const Vec3d x = random_place(random, -2, 42);
      PointwiseOffsets::Sample a, b;
      ASSERT_EQ(find(followed, x, a), find(anew, x, b));
      ASSERT_EQ(a.offset, b.offset);
    }
  }
}
