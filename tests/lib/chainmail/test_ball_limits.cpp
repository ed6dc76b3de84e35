// Ball limits (thesis eq. 4.6): what holds whatever the order, and that the order matters.
#include <gtest/gtest.h>

#include "lib/chainmail/ball_limits.h"
#include "tests/lib/test_bodies.h"
#include "tests/support/sanitized.h"
#include "volumes/base/parallel.h"

using namespace supple;
using namespace supple::test;

namespace {

std::array<std::int32_t, 3> by_voxels(double i, double j, double k) {
  return {std::int32_t(i * kVoxel), std::int32_t(j * kVoxel), std::int32_t(k * kVoxel)};
}

Vec3d place_mm(const Body& body, const Vec3i& voxel) {
  Vec3d index(voxel);
  for (int c = 0; c < 3; ++c) index[c] += body.offset(voxel, c) / kFixedOne;
  return body.geometry.world_from_index(index);
}

/// Shortest and longest link, in rest lengths.
struct Lengths {
  double shortest = 1e30, longest = 0;
  bool finite = true;
};
Lengths lengths_of(const Body& body) {
  Lengths lengths;
  for (std::size_t b = 0; b < body.elements.brick_count(); ++b) {
    for_each_link(body.elements, body.cuts, b, [&](int axis, Slot low, Slot high) {
      const Vec3d link = place_mm(body, voxel_of(body.elements, high)) -
                         place_mm(body, voxel_of(body.elements, low));
      const double length = link.length() / body.geometry.spacing_mm()[axis];
      lengths.shortest = std::min(lengths.shortest, length);
      lengths.longest = std::max(lengths.longest, length);
      lengths.finite &= std::isfinite(length);
    });
  }
  return lengths;
}

double largest_distance_voxels(const Body& a, const Body& b) {
  double largest = 0;
  for_each_element(a.elements, [&](Slot slot) {
    Vec3d apart;
    for (int c = 0; c < 3; ++c) apart[c] = (a.q[c].at(slot) - b.q[c].at(slot)) / kFixedOne;
    largest = std::max(largest, apart.length());
  });
  return largest;
}

}  // namespace

TEST(UnitBallLimits, AlongAChainTheyAreTheBoxLimits) {
  for (const double pull : {9.0, -0.9, 0.2}) {
    // 1.25 and 0.75 are exact in 2^-16 voxel.
    Body ball = body_of(homogeneous({20, 1, 1}, 1.25, 0.75, 0));
    Body box = ball;
    const BallReport report = drag_ball(ball, {{Vec3i(19, 0, 0), by_voxels(pull, 0, 0)}}, {});
    drag(box, {{Vec3i(19, 0, 0), by_voxels(pull, 0, 0)}}, {});
    EXPECT_TRUE(same_offsets(ball, box)) << pull;
    EXPECT_EQ(report.violated, 0);
    EXPECT_EQ(report.moves, report.moved - 1);
    EXPECT_FALSE(report.capped);
  }
}

TEST(UnitBallLimits, AlongAChainWithATableOfALabelTheyAreTheBoxLimits) {
  Block chain = homogeneous({20, 1, 1}, 1.25, 0.75, 0);
  chain.table.labels[3] = linear_table(1, 1, 0);
  for (int i = 0; i < 20; ++i) chain.label.push_back(i > 4 && i < 15 ? 3 : 0);
  for (const double pull : {4.0, -0.9}) {
    Body ball = body_of(chain);
    Body box = ball;
    drag_ball(ball, {{Vec3i(19, 0, 0), by_voxels(pull, 0, 0)}}, {});
    drag(box, {{Vec3i(19, 0, 0), by_voxels(pull, 0, 0)}}, {});
    EXPECT_TRUE(same_offsets(ball, box)) << pull;
    EXPECT_EQ(box.offset({5, 0, 0}, 0), box.offset({14, 0, 0}, 0));
  }
}

TEST(UnitBallLimits, AHandleThatJumpsPastItsNeighbourTurnsTheLinkRound) {
  Body body = body_of(homogeneous({2, 1, 1}, 1.25, 0.75, 0));
  drag_ball(body, {{Vec3i(1, 0, 0), by_voxels(-3, 0, 0)}}, {});
  EXPECT_EQ(body.offset({0, 0, 0}, 0), -0.75 * kVoxel);  // the handle is at -2
}

TEST(UnitBallLimits, AChainPulledSidewaysLiesOnTheStraightLineToItsSponsor) {
  Body body = body_of(homogeneous({2, 1, 1}, 1.25, 0.75, 0));
  drag_ball(body, {{Vec3i(1, 0, 0), by_voxels(2, 4, 0)}}, {});
  // The sponsor stands at (3, 4): 1.25 of the 5 voxels to it remain.
  EXPECT_NEAR(body.offset({0, 0, 0}, 0), 2.25 * kVoxel, 1);
  EXPECT_NEAR(body.offset({0, 0, 0}, 1), 3.0 * kVoxel, 1);
}

TEST(UnitBallLimits, LengthsAreMillimetres) {
  Block block = homogeneous({2, 1, 1}, 1.25, 0.75, 0);
  block.spacing_mm = {2, 0.5, 1};
  Body body = body_of(block);
  drag_ball(body, {{Vec3i(1, 0, 0), by_voxels(2, 16, 0)}}, {});
  // The sponsor stands at (6, 8) mm: 2.5 of the 10 mm to it remain.
  EXPECT_NEAR(body.offset({0, 0, 0}, 0), 2.25 * kVoxel, 1);
  EXPECT_NEAR(body.offset({0, 0, 0}, 1), 12.0 * kVoxel, 1);
}

TEST(PropertyBallLimits, ATurnedSheetKeepsItsLengthsWhereBoxLimitsStretchItsDiagonals) {
  Body ball = body_of(homogeneous({24, 24, 1}, 1.1, 0.9, 1));
  Body box = ball;
  const Handle corner(Vec3i(23, 23, 0), by_voxels(-10, 8, 0));
  const Region held(Vec3i(0, 0, 0));
  const BallReport report = drag_ball(ball, {corner}, {held});
  drag(box, {corner}, {held});
  EXPECT_EQ(report.violated, 0) << report.worst_excess_voxels;
  const double tolerance = BallParams().tolerance;
  EXPECT_LE(lengths_of(ball).longest, 1.1 + tolerance);
  EXPECT_GE(lengths_of(ball).shortest, 0.9 - tolerance);
  EXPECT_GT(lengths_of(box).longest, 1.4);
}

TEST(PropertyBallLimits, LinksBeyondTheToleranceAreExactlyThoseReported) {
  LEFT_OUT_WHEN_SANITIZED();
  std::mt19937 random(5);
  int resolved = 0, torn = 0;
  for (int n = 0; n < 60; ++n) {
    Block block = random_block(random, {9, 8, 5});
    if (n % 3 == 0) cut_randomly(random, block);
    Body body = body_of(block);
    const Vec3i voxel = block.voxel(random_element(random, block));
    const auto by = by_voxels(int(random() % 9) - 4.0, int(random() % 9) - 4.0, 2);
    // Every other body is torn: an anchor stays and the handle goes far.
    std::vector<Region> anchors;
    const Vec3i other = block.voxel(random_element(random, block));
    if (n % 2 == 1 && other != voxel) anchors.push_back(other);
    const Handle handle(voxel, anchors.empty() ? by : by_voxels(60, 0, 0));
    const BallReport report = drag_ball(body, {handle}, anchors);
    EXPECT_FALSE(body.links_known_valid);
    const auto is_held = [&](const Vec3i& at) {
      return at == voxel || (!anchors.empty() && at == other);
    };
    std::int64_t violated = 0, violated_and_held = 0;
    double worst = 0;
    for (std::size_t b = 0; b < body.elements.brick_count(); ++b) {
      for_each_link(body.elements, body.cuts, b, [&](int axis, Slot low, Slot high) {
        const LinkLimits limits =
            limits_of(body.material, axis, body.classes[low], body.classes[high]);
        const double length = (place_mm(body, voxel_of(body.elements, high)) -
                               place_mm(body, voxel_of(body.elements, low)))
                                  .length() /
                              block.spacing_mm[axis];
        const double excess = std::max(length - limits.max_length, limits.min_length - length);
        const bool is_violated = excess > BallParams().tolerance;
        violated += is_violated;
        violated_and_held += is_violated && is_held(voxel_of(body.elements, low)) &&
                             is_held(voxel_of(body.elements, high));
        worst = std::max(worst, excess);
      });
    }
    EXPECT_EQ(report.violated, violated) << n;
    EXPECT_NEAR(report.worst_excess_voxels, worst, 1e-9) << n;
    // No move mends a link between the handle and the anchor.
    EXPECT_TRUE(report.violated == violated_and_held || report.capped) << n;
    resolved += report.violated == 0;
    torn += report.violated > 1;
  }
  EXPECT_GE(resolved, 30);
  EXPECT_GE(torn, 10);
}

TEST(PropertyBallLimits, TheResultIsTheSameBitsWhateverTheThreads) {
  std::mt19937 random(6);
  const Block block = random_block(random, {12, 12, 6});
  const Vec3i voxel = block.voxel(random_element(random, block));
  std::vector<Body> bodies;
  for (const int threads : {1, 2, 3, 8}) {
    bodies.push_back(body_of(block));
    on_threads(threads, [&] { drag_ball(bodies.back(), {{voxel, by_voxels(3, 2, -1)}}, {}); });
    EXPECT_TRUE(same_offsets(bodies.back(), bodies.front())) << threads;
  }
}

TEST(PropertyBallLimits, AnotherProcessingOrderEndsElsewhere) {
  Body largest_first = body_of(homogeneous({12, 12, 1}, 1.2, 0.8, 0));
  Body moved_first = largest_first;
  const Handle handle(Vec3i(11, 6, 0), by_voxels(8, 5, 0));
  BallParams params;
  EXPECT_EQ(drag_ball(largest_first, {handle}, {}, params).violated, 0);
  params.order = BallOrder::first_moved_first;
  EXPECT_EQ(drag_ball(moved_first, {handle}, {}, params).violated, 0);
  EXPECT_GT(largest_distance_voxels(largest_first, moved_first), 0.1);
}

TEST(PropertyBallLimits, HandlesMeetTheirTargetsAndAnchorsStay) {
  Body body = body_of(homogeneous({10, 6, 4}, 1.3, 0.7, 0));
  const auto by = by_voxels(3, -1, 0.5);
  drag_ball(body, {{Region(Vec3i(8, 0, 0), Vec3i(9, 5, 3)), by}},
            {Region(Vec3i(0, 0, 0), Vec3i(1, 5, 3))});
  for_each_element(body.elements, [&](Slot slot) {
    const Vec3i voxel = voxel_of(body.elements, slot);
    for (int c = 0; c < 3; ++c) {
      if (voxel.x > 1 && voxel.x < 8) continue;
      EXPECT_EQ(body.offset(voxel, c), voxel.x <= 1 ? 0 : by[std::size_t(c)]);
    }
  });
}

TEST(PropertyBallLimits, WhatEarlierDragsHoldStays) {
  Body body = body_of(homogeneous({16, 1, 1}, 1.25, 0.75, 0));
  Holds holds;
  drag_ball(body, {{Vec3i(0, 0, 0), by_voxels(0, 2, 0)}}, {}, holds, {});
  drag_ball(body, {{Vec3i(15, 0, 0), by_voxels(1, 3, 0)}}, {}, holds, {});
  EXPECT_EQ(body.offset({0, 0, 0}, 1), 2 * kVoxel);
  EXPECT_EQ(body.offset({0, 0, 0}, 0), 0);
  EXPECT_EQ(holds.anchored.size(), 2u);
}

TEST(PropertyBallLimits, OnlyBricksThatMoveAreStored) {
  Body body = body_of(homogeneous({40, 40, 1}, 1.5, 0.6, 0));
  drag_ball(body, {{Vec3i(0, 0, 0), by_voxels(-1, 0, 0)}}, {});
  EXPECT_EQ(body.q[0].stored_bricks(), 1u);
  EXPECT_EQ(body.q[2].stored_bricks(), 0u);
}

TEST(PropertyBallLimits, CutPiecesStayBehind) {
  Block block = homogeneous({8, 1, 1}, 1.2, 0.8, 0);
  block.cut.assign(8, 0);
  block.cut[3] = 1;
  Body body = body_of(block);
  drag_ball(body, {{Vec3i(7, 0, 0), by_voxels(9, 0, 0)}}, {});
  EXPECT_GT(body.offset({4, 0, 0}, 0), 5 * kVoxel);
  EXPECT_EQ(body.offset({3, 0, 0}, 0), 0);
}

TEST(PropertyBallLimits, TheNextDragWithBoxLimitsProjects) {
  Body body = body_of(homogeneous({12, 12, 1}, 1.1, 0.9, 0.05));
  drag_ball(body, {{Vec3i(11, 11, 0), by_voxels(0, 9, 0)}}, {});
  EXPECT_GT(check_links(body).violated, 0);
  const EcmReport report = drag(body, {{Vec3i(0, 0, 0), by_voxels(1, 0, 0)}}, {});
  EXPECT_GT(report.projected_links, 0);
  EXPECT_EQ(check_links(body).violated, 0);
}

TEST(ExtremesBallLimits, HandlesThatTearAChainEndByTheCapAndAreReported) {
  Body body = body_of(homogeneous({10, 1, 1}, 1.1, 0.9, 0));
  const BallReport report =
      drag_ball(body, {{Vec3i(9, 0, 0), by_voxels(20, 0, 0)}}, {Region(Vec3i(0, 0, 0))});
  EXPECT_TRUE(report.capped);
  EXPECT_LE(report.moves, 100 * 10);
  EXPECT_GT(report.violated, 0);
  // 29 voxels over 9 links: at least one is 29/9 long.
  EXPECT_GE(report.worst_excess_voxels, 29.0 / 9 - 1.1 - 1e-6);
}

TEST(ExtremesBallLimits, CoincidentNodesMoveApartAlongTheLinkAtRest) {
  Body body = body_of(homogeneous({3, 1, 1}, 1.25, 0.75, 0));
  drag_ball(body, {{Vec3i(2, 0, 0), by_voxels(-1, 0, 0)}}, {});  // onto its neighbour
  EXPECT_TRUE(lengths_of(body).finite);
  EXPECT_EQ(body.offset({1, 0, 0}, 0), -0.75 * kVoxel);
  EXPECT_EQ(body.offset({0, 0, 0}, 0), -0.5 * kVoxel);
}

TEST(ExtremesBallLimits, TwoHandlesInOnePlaceAreReportedNotMoved) {
  Body body = body_of(homogeneous({2, 1, 1}, 1.25, 0.75, 0));
  const BallReport report = drag_ball(
      body, {{Vec3i(0, 0, 0), by_voxels(0.5, 0, 0)}, {Vec3i(1, 0, 0), by_voxels(-0.5, 0, 0)}}, {});
  EXPECT_EQ(report.violated, 1);
  EXPECT_NEAR(report.worst_excess_voxels, 0.75, 1e-9);
  EXPECT_EQ(report.moves, 0);
}

TEST(ExtremesBallLimits, ARigidBodyFollowsATranslationOfThousandsOfVoxels) {
  Body body = body_of(homogeneous({6, 5, 4}, 1, 1, 0));
  const auto by = by_voxels(10000, 0, 0);
  const BallReport report = drag_ball(body, {{Region(Vec3i(0, 0, 0), Vec3i(0, 4, 3)), by}}, {});
  EXPECT_EQ(report.violated, 0) << report.worst_excess_voxels;
  EXPECT_TRUE(lengths_of(body).finite);
}

TEST(FaultBallLimits, AnErrorOrCancelLeavesTheBodyAsItWas) {
  class Stop final : public Progress {
    void stage(std::string_view) override {}
    void update(double) override {}
    bool cancelled() const override { return true; }
  } stop;
  Body body = body_of(homogeneous({9, 9, 1}, 1.2, 0.8, 0.2));
  drag(body, {{Vec3i(8, 8, 0), by_voxels(2, 1, 0)}}, {});
  const Body before = body;
  const Handle handle(Vec3i(0, 0, 0), by_voxels(-9, 0, 0));
  EXPECT_THROW(drag_ball(body, {handle}, {}, BallParams(), &stop), Cancelled);
  EXPECT_TRUE(same_offsets(body, before));
  EXPECT_TRUE(body.links_known_valid);
  const Handle push(Vec3i(0, 0, 0), by_voxels(1, 0, 0), HandleKind::push);
  EXPECT_NE(input_error([&] { drag_ball(body, {push}, {}); }).find("two-sided"), std::string::npos);
  Holds holds;
  drag(body, {push}, {}, holds);
  const Handle elsewhere(Vec3i(8, 8, 0), by_voxels(-1, 0, 0));
  EXPECT_NE(input_error([&] { drag_ball(body, {elsewhere}, {}, holds, {}); }).find("release"),
            std::string::npos);
  BallParams loose;
  loose.tolerance = 0;
  EXPECT_NE(input_error([&] { drag_ball(body, {handle}, {}, loose); }).find("tolerance"),
            std::string::npos);
}
