// Laws of regions and push handles by hand: what moves as one, what sticks and what does not.
#include <gtest/gtest.h>

#include "lib/chainmail/ecm.h"
#include "tests/lib/test_bodies.h"

using namespace supple;
using namespace supple::test;

namespace {

Handle push(int i, std::int32_t by) {
  return {Vec3i(i, 0, 0), {by, 0, 0}, HandleKind::push};
}
Handle grab(int i, std::int32_t by) {
  return {Vec3i(i, 0, 0), {by, 0, 0}};
}
std::int32_t at(const Body& body, int i) {
  return body.offset({i, 0, 0}, 0);
}

}  // namespace

TEST(PropertyPush, WithdrawingAToolLeavesTheTissueWhereItWasPushed) {
  Body body = soft_row(12);
  Holds holds;
  drag(body, {push(6, 4 * kVoxel)}, {}, holds);
  EXPECT_EQ(at(body, 6), 4 * kVoxel);
  const auto pushed = body.q;
  EXPECT_EQ(drag(body, {push(6, -4 * kVoxel)}, {}, holds).moved, 0);
  EXPECT_EQ(body.q, pushed);
  // On its way back it touches nothing before it is where the tissue is.
  EXPECT_EQ(drag(body, {push(6, 4 * kVoxel)}, {}, holds).moved, 0);
  drag(body, {push(6, kVoxel)}, {}, holds);
  EXPECT_EQ(at(body, 6), 5 * kVoxel);
}

TEST(PropertyPush, ATwoSidedHandleTakesTheTissueBack) {
  Body body = soft_row(12);
  Holds holds;
  drag(body, {grab(6, 4 * kVoxel)}, {}, holds);
  drag(body, {grab(6, -4 * kVoxel)}, {}, holds);
  EXPECT_EQ(at(body, 6), 0);
}

TEST(PropertyPush, OthersMayMovePushedTissueOnButNotBack) {
  Body body = soft_row(12);
  Holds holds;
  drag(body, {push(3, 4 * kVoxel)}, {}, holds);
  // Ahead: the whole drag, and the pushed voxel follows.
  EXPECT_EQ(drag(body, {grab(8, 20 * kVoxel)}, {}, holds).fraction(), 1);
  EXPECT_EQ(at(body, 8), at(body, 3) + 5 * 32768);
  EXPECT_GT(at(body, 3), 4 * kVoxel);
  // Back: until the links between 8 and the tool at 3 are as short as they go, which is where 8 was
  // after the push.
  const EcmReport report = drag(body, {grab(8, -60 * kVoxel)}, {}, holds);
  EXPECT_EQ(report.fraction_numerator, 1);
  EXPECT_EQ(report.fraction_denominator, 3);
  EXPECT_EQ(at(body, 3), 4 * kVoxel);
  EXPECT_EQ(at(body, 8), 4 * kVoxel - 5 * 26214);
  EXPECT_EQ(check_links(body).violated, 0);
}

TEST(PropertyPush, AToolThatFollowsTissueMovedByOthersReachesItOnlyWithItsOwnPlace) {
  Body body = soft_row(12);
  Holds holds;
  drag(body, {push(3, kVoxel)}, {}, holds);
  drag(body, {grab(8, 20 * kVoxel)}, {}, holds);
  const std::int32_t carried = at(body, 3);
  EXPECT_EQ(drag(body, {push(3, kVoxel)}, {}, holds).moved, 0);
  EXPECT_EQ(at(body, 3), carried);
}

TEST(PropertyPush, ToolsOfOneDirectionAgreeAndOpposedOnesMayNot) {
  Body body = soft_row(12);
  Holds holds;
  drag(body, {push(3, kVoxel), push(4, 9 * kVoxel)}, {}, holds);
  EXPECT_EQ(at(body, 4), 9 * kVoxel);
  EXPECT_EQ(at(body, 3), 9 * kVoxel - 32768);
  // 5 is behind 4, which pushes on: the link between them shortens by 26214.
  EXPECT_EQ(input_error([&] {
              drag(body, {push(4, kVoxel), push(5, -kVoxel)}, {}, holds);
            }),
            "grab 4,0,0 and 5,0,0: found targets 2 mm further apart along axis i than the links "
            "between them allow, expected handles that agree with each other");
}

TEST(PropertyPush, AToolAsksForNothingAlongAxesItDoesNotMoveAlong) {
  Body body = soft_row(12);
  Holds holds;
  drag(body, {push(3, kVoxel)}, {}, holds);
  EXPECT_EQ(drag(body, {{Vec3i(3, 0, 0), {0, kVoxel, 0}}}, {}, holds).fraction(), 1);
  Holds others;
  drag(body, {push(3, kVoxel)}, {}, others);
  EXPECT_EQ(drag(body, {{Vec3i(4, 0, 0), {0, 9 * kVoxel, 0}}}, {}, others).fraction(), 1);
  EXPECT_GT(body.offset({3, 0, 0}, 1), kVoxel);
}

TEST(PropertyRegions, ADeformedRegionMovesAsOne) {
  Block block = full_block({20, 12, 9}, linear_table(1.5, 0.6, 0.7),
                           [](int i, int j, int k) { return double(60 + (i * j + k) % 190); });
  Body body = body_of(block);
  drag(body, {{Vec3i(10, 6, 4), {5 * kVoxel, -3 * kVoxel, kVoxel}}}, {});
  const Body before = body;
  const IndexBox region{{6, 3, 2}, {13, 8, 6}};
  const std::array<std::int32_t, 3> by{-4 * kVoxel + 3, 7 * kVoxel, 11};
  EXPECT_EQ(drag(body, {{region, by}}, {}).fraction(), 1);
  for (int n = 0; n < block.size(); ++n) {
    if (!region.contains(block.voxel(n))) continue;
    for (int c = 0; c < 3; ++c) {
      ASSERT_EQ(body.offset(block.voxel(n), c), before.offset(block.voxel(n), c) + by[c]);
    }
  }
  EXPECT_EQ(check_links(body).violated, 0);
}

TEST(PropertyRegions, GrabbingPartOfWhatIsHeldLeavesTheRestHeld) {
  Body body = soft_row(30);
  Holds holds;
  drag(body, {{IndexBox{{10, 0, 0}, {20, 0, 0}}, {0, kVoxel, 0}}}, {}, holds);
  drag(body, {{Vec3i(20, 0, 0), {kVoxel / 4, 0, 0}}}, {}, holds);
  EXPECT_EQ(at(body, 20), kVoxel / 4);
  EXPECT_EQ(at(body, 19), 0);
  EXPECT_LT(drag(body, {{Vec3i(25, 0, 0), {0, 99 * kVoxel, 0}}}, {}, holds).fraction(), 1);
  EXPECT_EQ(body.offset({19, 0, 0}, 1), kVoxel);
  EXPECT_EQ(body.offset({20, 0, 0}, 1), kVoxel);
}

TEST(PropertyRegions, AFailedDragHoldsWhatWasHeldBefore) {
  Body body = soft_row(12);
  Holds holds;
  drag(body, {push(3, kVoxel), grab(8, kVoxel)}, {}, holds);
  EXPECT_NE(input_error([&] { drag(body, {grab(3, 0), grab(4, 99 * kVoxel)}, {}, holds); }), "");
  EXPECT_NE(input_error([&] { drag(body, {grab(40, kVoxel)}, {}, holds); }), "");
  ASSERT_EQ(holds.at_least[0].size(), 1u);
  EXPECT_EQ(holds.at_least[0][0].value, kVoxel);
  EXPECT_EQ(holds.anchored.size(), 1u);
}

TEST(UnitRegions, ConflictsBetweenRegionsNameBothAndTheVoxelsInBetween) {
  Body body = soft_row(12);
  const Handle left(IndexBox{{0, 0, 0}, {3, 0, 0}}, {0, 0, 0});
  const Handle right(Region::of_points({{8, 0, 0}, {6, 0, 0}}, "points.csv"), {3 * kVoxel, 0, 0});
  EXPECT_EQ(input_error([&] {
              drag(body, {left, right}, {});
            }),
            "grab points.csv and 0,0,0:3,0,0: found targets 1.5 mm further apart along axis i than "
            "the links between voxels 6,0,0 and 3,0,0 allow, expected handles that agree with each "
            "other");
}

TEST(UnitRegions, OverlapsNameBothRegions) {
  Body body = soft_row(12);
  const Handle box(IndexBox{{2, 0, 0}, {5, 0, 0}}, {kVoxel, 0, 0});
  EXPECT_EQ(input_error([&] {
              drag(body, {grab(1, 5), box, grab(4, 5)}, {});
            }),
            "grab 2,0,0:5,0,0 and grab 4,0,0: found voxel 4,0,0 in both, expected every voxel in "
            "one of them");
  EXPECT_EQ(input_error([&] {
              drag(body, {grab(1, 5), box}, {Vec3i(9, 0, 0), Vec3i(3, 0, 0)});
            }),
            "grab 2,0,0:5,0,0 and fix 3,0,0: found voxel 3,0,0 in both, expected every voxel in "
            "one of them");
}

TEST(UnitRegions, PointsAndMasksWithoutElementsNameTheNearestOne) {
  Body body = soft_row(12);
  const Region points = Region::of_points({{3, 0, 0}, {3, 4, 0}}, "points.csv");
  EXPECT_EQ(input_error([&] {
              drag(body, {{points, {1, 0, 0}}}, {});
            }),
            "grab points.csv: found no element at 3,4,0, expected points in the body; the nearest "
            "is 3,0,0, 4 mm away");
  BrickMask mask{};
  mask_set(mask, brick_offset({0, 2, 0}));
  const Region label = Region::of_mask(
      std::make_shared<BrickTopology>(std::vector<Vec3i>{{0, 0, 0}}, std::vector<BrickMask>{mask}),
      "label 3");
  EXPECT_EQ(input_error([&] { drag(body, {}, {label}); }),
            "fix label 3: found no element, expected a region that holds elements; the nearest is "
            "0,0,0, 2 mm away");
}

TEST(ExtremesRegions, AHundredThousandVoxelsMoveAsOneAndStopAtAnchors) {
  const Block block = full_block({64, 56, 56}, linear_table(1.5, 0.6, 0.7),
                                 [](int i, int j, int k) { return double((i * 7 + j + k) % 256); });
  Body body = body_of(block);
  const IndexBox region{{4, 3, 3}, {53, 52, 42}};
  Holds holds;
  EXPECT_EQ(drag(body, {{region, {3 * kVoxel, kVoxel, 0}}}, {}, holds).fraction(), 1);
  EXPECT_EQ(holds.anchored.size(), 100000u);
  EXPECT_EQ(body.offset(region.lo, 0), 3 * kVoxel);
  EXPECT_EQ(body.offset(region.hi, 0), 3 * kVoxel);
  EXPECT_EQ(check_links(body).violated, 0);
  // The tool moves on, and an anchor ahead stops it.
  const EcmReport report = drag(body, {{region, {90 * kVoxel, 0, 0}, HandleKind::push}},
                                {{{63, 0, 0}, {63, 55, 55}}}, holds);
  EXPECT_LT(report.fraction(), 1);
  EXPECT_EQ(holds.anchored.size(), 0u);
  EXPECT_EQ(holds.at_least[0].size(), 100000u);
  EXPECT_EQ(check_links(body).violated, 0);
}
