// Laws of the engine that need no second solver.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "lib/chainmail/ecm.h"
#include "lib/chainmail/propagate.h"
#include "lib/relax/relaxation.h"
#include "tests/lib/brute_force.h"
#include "tests/lib/relaxed_bodies.h"
#include "tests/support/sanitized.h"

using namespace supple;
using namespace supple::test;

namespace {

/// A body with random, mostly invalid offsets.
Body scrambled(std::mt19937& random, const Block& block, BruteForce& brute, int reach) {
  Body body = body_of(block);
  body.links_known_valid = false;
  for (int c = 0; c < 3; ++c) {
    body.q[c].resize(body.elements.brick_count());
    for (int n = 0; n < block.size(); ++n) {
      if (!block.element[n]) continue;
      const Vec3i voxel = block.voxel(n);
      const std::int32_t value = std::int32_t(random() % unsigned(2 * reach)) - reach;
      brute.q[c][n] = value;
      body.q[c].touch(std::size_t(body.elements.find(voxel)))[brick_offset(voxel)] = value;
    }
  }
  return body;
}

/// Half the largest excess over all pairs, rounded up: no valid configuration is nearer.
Wide least_possible_move(const Block& block, const BruteForce& brute) {
  Wide worst = 0;
  for (int c = 0; c < 3; ++c) {
    for (int a = 0; a < block.size(); ++a) {
      if (!block.element[a]) continue;
      const std::vector<Wide> distance = brute.distances_from(c, a);
      for (int b = 0; b < block.size(); ++b) {
        if (block.element[b] && distance[b] < kNoPath) {
          worst = std::max(worst, brute.q[c][a] - brute.q[c][b] - distance[b]);
        }
      }
    }
  }
  return (worst + 1) / 2;
}

}  // namespace

TEST(PropertyEcm, CoordinatesThatNeverMoveStayWithoutMemory) {
  Body body = body_of(t_shape(20));
  drag(body, {{{19, 10, 0}, {0, 5 * kVoxel, 0}}}, {});
  EXPECT_TRUE(body.q[0].empty());
  EXPECT_FALSE(body.q[1].empty());
  EXPECT_TRUE(body.q[2].empty());
  // A drag that an anchor stops at once moves nothing: rigid T, its bar fixed, its stem pulled.
  Body rigid = body_of(t_shape(20));
  const EcmReport report = drag(rigid, {{{6, 9, 0}, {0, 0, kVoxel}}}, {{{13, 5, 0}, {13, 5, 0}}});
  EXPECT_EQ(report.fraction_numerator, 0);
  EXPECT_EQ(report.fraction_denominator, 1);
  EXPECT_EQ(report.moved, 0);
  EXPECT_TRUE(rigid.q[2].empty());
}

TEST(PropertyEcm, OnlyBricksThatADragReachesHaveMemory) {
  // A pull by 4 voxels is followed over 8 nodes (0.5 per link), a push over 10 (0.4): 192 to 199
  // lie in one of 25 bricks, 93 to 109 in three.
  const Body rest = soft_row(200);
  Body body = rest;
  drag(body, {{{199, 0, 0}, {4 * kVoxel, 0, 0}}}, {});
  EXPECT_EQ(body.q[0].stored_bricks(), 1u);
  drag(body, {{{100, 0, 0}, {4 * kVoxel, 0, 0}}}, {});
  EXPECT_EQ(body.q[0].stored_bricks(), 4u);
  EXPECT_LE(body.bytes() - rest.bytes(), 25 * (2048 + 64));
  // Two handles in conflict far away: all is as before, also what the attempt had stored.
  const auto before = body.q;
  EXPECT_NE(input_error([&] {
              drag(body, {{{9, 0, 0}, {0, 0, 0}}, {{10, 0, 0}, {kVoxel, 0, 0}}}, {});
            }),
            "");
  EXPECT_EQ(body.q, before);
  EXPECT_EQ(body.q[0].stored_bricks(), 4u);
}

TEST(PropertyProjection, BricksThatItDoesNotReachStayWithoutMemory) {
  Body body = soft_row(200);
  // One voxel at a brick's end, 3 voxels up: half of the excess on both sides, in two bricks.
  body.q[0].resize(body.elements.brick_count());
  body.q[0].set(std::size_t(body.elements.find({103, 0, 0})) * kBrickVoxels +
                    std::size_t(brick_offset({103, 0, 0})),
                3 * kVoxel);
  body.links_known_valid = false;
  EXPECT_EQ(project(body).violated_links, 2);
  EXPECT_EQ(check_links(body).violated, 0);
  EXPECT_GT(body.offset({104, 0, 0}, 0), 0);
  EXPECT_EQ(body.q[0].stored_bricks(), 2u);
}

TEST(PropertyEcm, TheResultDependsNeitherOnTheEngineNorOnTheProcessingOrder) {
  std::mt19937 random(11);
  for (int n = 0; n < 60; ++n) {
    const Block block = random_block(random, {14, 14, 6});
    const Body body = body_of(block);
    const Vec3i voxel = block.voxel(random_element(random, block));
    const Slot slot = Slot(body.elements.find(voxel)) * kBrickVoxels + Slot(brick_offset(voxel));
    const std::int32_t by = std::int32_t(random() % (40u * kVoxel));
    BrickValues first;
    for (const Engine engine : {Engine::flat, Engine::block}) {
      for (const int shift : {-1, 0, 3, 9, 14, 20, 31}) {
        BrickValues values(body.elements.brick_count());
        Propagator propagator(body, engine, shift);
        propagator.run({n % 3, Direction::raise, values}, {{slot, by}});
        propagator.run({n % 3, Direction::lower, values}, {{slot, -by}});
        if (first.empty()) first = values;
        ASSERT_EQ(values, first) << "engine " << int(engine) << " bucket shift " << shift;
      }
    }
  }
}

TEST(PropertyEcm, ADragOfManyVoxelsAsOneMovesThemAsOne) {
  Body body = body_of(t_shape(30));
  std::vector<Handle> handles;
  for (int j = 10; j < 20; ++j) handles.push_back({{29, j, 0}, {20 * kVoxel, -kVoxel, kVoxel / 3}});
  const EcmReport report = drag(body, handles, {});
  EXPECT_EQ(report.fraction(), 1);
  for (int j = 10; j < 20; ++j) {
    EXPECT_EQ(body.offset({29, j, 0}, 0), 20 * kVoxel);
    EXPECT_EQ(body.offset({29, j, 0}, 2), kVoxel / 3);
  }
  EXPECT_EQ(check_links(body).violated, 0);
}

TEST(PropertyEcm, AnAnchoredDragStopsAtTheLargestAdmissibleFractionAndKeepsItsDirection) {
  // Ten soft voxels in a row, the first held: 9 links give 9 * 0.5 voxel along the row and
  // 9 * 0.7 (45875 units each) across.
  Body body = soft_row(10);
  const EcmReport report =
      drag(body, {{{9, 0, 0}, {9 * kVoxel, 18 * kVoxel, 1}}}, {{{0, 0, 0}, {0, 0, 0}}});
  // Along j: 9 * 45875 of 18 * 65536 units; along i: half. The smaller one counts for both.
  EXPECT_EQ(report.fraction_numerator, 45875);
  EXPECT_EQ(report.fraction_denominator, 131072);
  EXPECT_EQ(body.offset({9, 0, 0}, 1), 9 * 45875);
  EXPECT_EQ(body.offset({9, 0, 0}, 0), 9 * 45875 / 2);
  EXPECT_TRUE(body.q[2].empty());
  EXPECT_EQ(body.offset({0, 0, 0}, 1), 0);
  EXPECT_EQ(check_links(body).violated, 0);
}

TEST(PropertyEcm, MovedCountsTheElementsWhoseOffsetChanged) {
  Body body = soft_row(12);
  // 1.2 voxels at one end: the links give 0.5 each (shortening 0.4), so 1.2, 0.7, 0.2 are left.
  EXPECT_EQ(drag(body, {{{0, 0, 0}, {-kVoxel * 6 / 5, 0, 0}}}, {}).moved, 3);
  // Back again, and sideways at the other end: 1.0 and 0.3 across.
  EXPECT_EQ(drag(body, {{{11, 0, 0}, {0, kVoxel, 0}}}, {}).moved, 2);
}

TEST(PropertyProjection, AnInvalidStartIsProjectedWithTheSmallestPossibleLargestMove) {
  LEFT_OUT_WHEN_SANITIZED();
  std::mt19937 random(23);
  int invalid = 0;
  for (int n = 0; n < 150; ++n) {
    const Block block = random_block(random, {5, 4, 3});
    BruteForce brute(block);
    Body body = scrambled(random, block, brute, 1 + int(random() % 200000));
    const LinkCheck before = check_links(body);
    const Wide least = least_possible_move(block, brute);
    const ProjectionReport report = project(body);
    EXPECT_EQ(report.violated_links, before.violated);
    EXPECT_EQ(report.max_move_voxels, double(least) / kFixedOne);
    EXPECT_EQ(check_links(body).violated, 0);
    EXPECT_TRUE(body.links_known_valid);
    invalid += before.violated > 0;
  }
  EXPECT_GE(invalid, 80);
}

TEST(PropertyProjection, ADragFromAnInvalidStartReportsTheProjectionAndIsValidAfterwards) {
  std::mt19937 random(29);
  for (int n = 0; n < 40; ++n) {
    const Block block = random_block(random, {9, 9, 4});
    BruteForce brute(block);
    Body body = scrambled(random, block, brute, 3 * kVoxel);
    Body projected = body;
    const ProjectionReport projection = project(projected);
    const Vec3i voxel = block.voxel(random_element(random, block));
    const std::int32_t start = projected.offset(voxel, 0);
    const EcmReport report = drag(body, {{voxel, {2 * kVoxel, 0, 0}}}, {});
    EXPECT_EQ(report.projected_links, projection.violated_links);
    EXPECT_EQ(report.projected_max_voxels, projection.max_move_voxels);
    EXPECT_EQ(body.offset(voxel, 0), start + 2 * kVoxel);
    EXPECT_EQ(check_links(body).violated, 0);
  }
}

TEST(PropertyProjection, AFailedDragFromAnInvalidStartLeavesItInvalid) {
  std::mt19937 random(31);
  const Block block = t_shape(12);
  BruteForce brute(block);
  Body body = scrambled(random, block, brute, 3 * kVoxel);
  const auto before = body.q;
  EXPECT_NE(input_error([&] { drag(body, {{{50, 0, 0}, {1, 0, 0}}}, {}); }), "");
  EXPECT_EQ(body.q, before);
  EXPECT_FALSE(body.links_known_valid);
}

TEST(PropertyProjection, WhatIsHeldKeepsItsPlaceWhereTheLinksAllowIt) {
  // A valid body whose free elements are then scattered: the held ones fit together.
  std::mt19937 random(37);
  int invalid = 0, pushed = 0;
  for (int n = 0; n < 60; ++n) {
    Dragged start = dragged(random, {9, 8, 7});
    Body& body = start.body;
    const SlotSet fixed = anchored_elements(body, start.anchors, {});
    SlotSet held = fixed;
    held.add(start.holds.anchored);
    for (std::size_t c = 0; c < 3; ++c) {
      for (const auto* bounds : {&start.holds.at_least[c], &start.holds.at_most[c]}) {
        std::vector<Slot> slots;
        for (const Bound& bound : *bounds) slots.push_back(bound.slot);
        held.add(SlotSet(std::move(slots)));
      }
      body.q[c].resize(body.elements.brick_count());
      for_each_element(body.elements, [&](Slot slot) {
        const std::int32_t by = std::int32_t(random() % (2 * kVoxel)) - kVoxel;
        if (!held.contains(slot)) body.q[c].set(slot, body.q[c].at(slot) + by);
      });
    }
    const Body before = body;
    const ProjectionReport report = project(body, fixed, start.holds);
    invalid += report.violated_links > 0;
    EXPECT_EQ(check_links(body).violated, 0);
    EXPECT_EQ(report.held_moved, 0);
    for (std::size_t c = 0; c < 3; ++c) {
      for (const SlotSet* anchored : {&fixed, static_cast<const SlotSet*>(&start.holds.anchored)}) {
        anchored->for_each([&](Slot at) { EXPECT_EQ(body.q[c].at(at), before.q[c].at(at)); });
      }
      for (const Bound& bound : start.holds.at_least[c]) {
        EXPECT_GE(body.q[c].at(bound.slot), bound.value);
        ++pushed;
      }
      for (const Bound& bound : start.holds.at_most[c]) {
        EXPECT_LE(body.q[c].at(bound.slot), bound.value);
      }
    }
  }
  EXPECT_GT(invalid, 30);
  EXPECT_GT(pushed, 10);
}

TEST(PropertyProjection, WhatIsHeldTooFarApartMovesAndIsCounted) {
  Body body = body_of(soft_block({5, 2, 1}));
  Slot ends[2];
  ASSERT_TRUE(slot_of(body.elements, {0, 0, 0}, ends[0]));
  ASSERT_TRUE(slot_of(body.elements, {4, 0, 0}, ends[1]));
  body.q[0].resize(body.elements.brick_count());
  body.q[0].set(ends[1], 4 * kVoxel);
  Body free = body;
  project(free);
  const ProjectionReport report = project(body, SlotSet(std::vector<Slot>(ends, ends + 2)));
  // The ends are 4 apart, and four links give way by 0.5 each; so all move, half of the 3.5 that
  // the last link has too much.
  EXPECT_EQ(report.held_moved, 2);
  EXPECT_EQ(report.max_move_voxels, 1.75);
  EXPECT_EQ(body.q, free.q);
  EXPECT_EQ(check_links(body).violated, 0);
}

TEST(PropertyProjection, AValidConfigurationIsItsOwnProjection) {
  Body body = body_of(t_shape(16));
  drag(body, {{{15, 8, 0}, {9 * kVoxel, 2 * kVoxel, kVoxel}}}, {});
  const auto before = body.q;
  body.links_known_valid = false;
  EXPECT_EQ(project(body).violated_links, 0);
  EXPECT_EQ(body.q, before);
}
