#include <algorithm>

#include <gtest/gtest.h>

#include "lib/chainmail/ecm.h"
#include "tests/lib/test_bodies.h"
#include "tests/support/sanitized.h"

using namespace supple;
using namespace supple::test;

TEST(ExtremesEcm, AnAllRigidBodyMovesAsOneByTenThousandVoxels) {
  const Block block = soft_block({65, 49, 50}, 0);
  Body body = body_of(block);
  const EcmReport report = drag(body, {{{0, 8, 3}, {10000 * kVoxel, -10000 * kVoxel, 1}}}, {});
  EXPECT_EQ(report.engine, Engine::block);
  EXPECT_EQ(report.moved, block.size());
  for (int n = 0; n < block.size(); ++n) {
    ASSERT_EQ(body.offset(block.voxel(n), 0), 10000 * kVoxel);
    ASSERT_EQ(body.offset(block.voxel(n), 1), -10000 * kVoxel);
    ASSERT_EQ(body.offset(block.voxel(n), 2), 1);
  }
}

TEST(ExtremesEcm, OneVoxelGoesWhereItIsTakenToTheEndOfTheRange) {
  Body body = body_of(soft_block({1, 1, 1}, 255));
  const std::int32_t most = 16383 * kVoxel;
  EXPECT_EQ(drag(body, {{{0, 0, 0}, {most, -most, 0}}}, {}).moved, 1);
  drag(body, {{{0, 0, 0}, {kVoxel - 1, 1 - kVoxel, 0}}}, {});
  EXPECT_EQ(body.offset({0, 0, 0}, 0), kMaxOffset);
  EXPECT_EQ(body.offset({0, 0, 0}, 1), -kMaxOffset);
  EXPECT_NE(input_error([&] { drag(body, {{{0, 0, 0}, {1, 0, 0}}}, {}); }), "");
}

TEST(ExtremesEcm, AChainOfVoxelsFollowsAtItsLinksFullLength) {
  const int n = 3000;
  for (const int axis : {0, 1, 2}) {
    Vec3i dims(1, 1, 1), last(0, 0, 0);
    dims[axis] = n;
    last[axis] = n - 1;
    Body body = body_of(soft_block(dims, 255));
    std::array<std::int32_t, 3> by{};
    by[axis] = 16000 * kVoxel;
    by[(axis + 1) % 3] = -16000 * kVoxel;
    drag(body, {{last, by}}, {});
    for (const int at : {0, 1, 1500, 2999}) {
      Vec3i voxel(0, 0, 0);
      voxel[axis] = at;
      EXPECT_EQ(body.offset(voxel, axis), 16000 * kVoxel - (n - 1 - at) * 32768);
      EXPECT_EQ(body.offset(voxel, (axis + 1) % 3), -16000 * kVoxel + (n - 1 - at) * 45875);
    }
  }
}

TEST(ExtremesEcm, ACheckerboardHasNoLinksAndOnlyTheGrabbedVoxelMoves) {
  Block block = soft_block({20, 20, 6}, 0);
  for (int n = 0; n < block.size(); ++n) {
    const Vec3i v = block.voxel(n);
    block.element[n] = (v.x + v.y + v.z) % 2 == 0;
  }
  Body body = body_of(block);
  EXPECT_EQ(check_links(body).links, 0);
  EXPECT_EQ(
      drag(body, {{{8, 8, 2}, {9 * kVoxel, kVoxel, -kVoxel}}}, {{{0, 0, 0}, {3, 3, 3}}}).moved, 1);
}

TEST(ExtremesEcm, WithoutShearAPlaneAcrossTheDragMovesAsOne) {
  const Block block =
      full_block({9, 8, 7}, linear_table(1.5, 0.6, 0), [](int, int, int) { return 255.0; });
  Body body = body_of(block);
  drag(body, {{{4, 0, 0}, {kVoxel, 0, 0}}}, {});
  for (int j = 0; j < 8; ++j) {
    for (int k = 0; k < 7; ++k) {
      EXPECT_EQ(body.offset({4, j, k}, 0), kVoxel);
      EXPECT_EQ(body.offset({3, j, k}, 0), kVoxel / 2);
      EXPECT_EQ(body.offset({2, j, k}, 0), 0);
      EXPECT_EQ(body.offset({5, j, k}, 0), kVoxel - 26214);
    }
  }
}

TEST(ExtremesEcm, TenThousandAlternatingDragsDoNotDrift) {
  LEFT_OUT_WHEN_SANITIZED();
  std::mt19937 random(3);
  const Block block = full_block({12, 11, 5}, linear_table(1.5, 0.6, 0.7),
                                 [&](int, int, int) { return double(random() % 256); });
  Body body = body_of(block);
  const std::vector<Region> anchor{{{0, 0, 0}, {1, 1, 1}}};
  EcmSolver solver(body, Engine::block);
  for (int n = 0; n < 10000; ++n) {
    const int sign = n % 2 ? -1 : 1;
    solver.drag({{{11, 10, 4}, {sign * 2 * kVoxel, sign * kVoxel + 1, sign * 3}}}, anchor);
    ASSERT_TRUE(body.links_known_valid);
    ASSERT_EQ(body.offset({1, 1, 1}, 0), 0);
  }
  EXPECT_EQ(check_links(body).violated, 0);
  EXPECT_EQ(body.offset({11, 10, 4}, 0), 0);
}

TEST(ExtremesEcm, AHugeDragOfASoftBodyWithAHugeAnchorStaysExact) {
  // 12,000 voxels requested, the anchors allow a few: the fraction is exact.
  Block block = soft_block({40, 12, 12}, 255);
  Body body = body_of(block);
  const EcmReport report =
      drag(body, {{{39, 5, 5}, {12000 * kVoxel, 0, 0}}}, {{{0, 0, 0}, {19, 11, 11}}});
  EXPECT_EQ(body.offset({39, 5, 5}, 0), 20 * 32768);
  EXPECT_EQ(report.fraction_numerator, 1);
  EXPECT_EQ(report.fraction_denominator, 1200);
  EXPECT_EQ(body.offset({19, 5, 5}, 0), 0);
  EXPECT_EQ(check_links(body).violated, 0);
}

TEST(ExtremesEcm, AMillionIslandsMoveEachByItself) {
  LEFT_OUT_WHEN_SANITIZED();
  Block block = soft_block({126, 126, 126}, 0);
  for (int n = 0; n < block.size(); ++n) {
    const Vec3i v = block.voxel(n);
    block.element[n] = (v.x + v.y + v.z) % 2 == 0;
  }
  Body body = body_of(block);
  const std::int64_t islands = body.elements.active_count();
  EXPECT_GT(islands, 1000000);
  for (const Engine engine : {Engine::block, Engine::flat}) {
    EcmSolver solver(body, engine);
    EXPECT_EQ(solver.drag({{{60, 60, 60}, {kVoxel, 0, 0}}}, {}).moved, 1);
    const IndexBox all{{0, 0, 0}, {125, 125, 125}};
    EXPECT_EQ(solver.drag({{Region(all), {0, kVoxel, 0}}}, {}).moved, islands);
  }
  EXPECT_EQ(body.offset({60, 60, 60}, 0), 2 * kVoxel);
  EXPECT_EQ(body.offset({0, 0, 2}, 1), 2 * kVoxel);
  EXPECT_EQ(body.offset({0, 0, 2}, 0), 0);
}

TEST(ExtremesEcm, BothEnginesReachBothEndsOfTheRangeAlike) {
  const Block block = soft_block({40, 12, 12}, 200);
  const std::int32_t most = 16383 * kVoxel;
  std::array<BrickValues, 3> first;
  for (const Engine engine : {Engine::flat, Engine::block}) {
    Body body = body_of(block);
    EcmSolver solver(body, engine);
    solver.drag({{{39, 5, 5}, {most, -most, 0}}}, {});
    solver.drag({{{39, 5, 5}, {kVoxel - 1, 1 - kVoxel, 0}}}, {});
    EXPECT_EQ(body.offset({39, 5, 5}, 0), kMaxOffset);
    EXPECT_EQ(body.offset({39, 5, 5}, 1), -kMaxOffset);
    EXPECT_EQ(check_links(body).violated, 0);
    // Now the other way, past everything.
    solver.drag({{{0, 5, 5}, {-most, most, 0}}}, {});
    EXPECT_EQ(check_links(body).violated, 0);
    EXPECT_NE(input_error([&] {
                solver.drag({{{0, 5, 5}, {-most, most, 0}}}, {});
                solver.drag({{{0, 5, 5}, {-most, most, 0}}}, {});
              }),
              "");
    if (engine == Engine::flat) first = body.q;
    for (int c = 0; c < 3; ++c) EXPECT_EQ(body.q[c], first[c]) << "axis " << c;
  }
}

TEST(ExtremesEcm, AnchorsAtOneEndOfTheRangeLimitHandlesAtTheOther) {
  // The run that finds the fraction takes anchors beyond the range, where only one engine goes.
  const Block block = soft_block({200, 9, 9}, 255);
  std::array<BrickValues, 3> first;
  for (const Engine engine : {Engine::flat, Engine::block}) {
    Body body = body_of(block);
    EcmSolver solver(body, engine);
    const IndexBox far{{0, 0, 0}, {0, 8, 8}};
    solver.drag({{Region(far), {-16000 * kVoxel, 0, 0}}}, {});
    solver.drag({{{199, 4, 4}, {-30 * kVoxel, 0, 0}}}, {far});
    const EcmReport report = solver.drag(
        {{{199, 4, 4}, {16000 * kVoxel, 0, 0}}, {{199, 0, 0}, {15997 * kVoxel, 0, 0}}}, {far});
    EXPECT_GT(report.fraction(), 0);
    EXPECT_LT(report.fraction(), 0.1);
    EXPECT_EQ(body.offset({0, 4, 4}, 0), -16000 * kVoxel);
    if (engine == Engine::flat) first = body.q;
    EXPECT_EQ(body.q[0], first[0]);
  }
}
