// Elastic relaxation: valid and downhill after every pass, and to the right place.
#include <cmath>

#include <gtest/gtest.h>

#include "lib/body/slot_set.h"
#include "lib/model/relax_model.h"
#include "lib/relax/sweep_kernel.h"
#include "tests/lib/brute_force.h"
#include "tests/lib/relaxed_bodies.h"
#include "tests/support/sanitized.h"

using namespace supple;
using namespace supple::test;

namespace {

constexpr RelaxMethod kValidMethods[] = {RelaxMethod::jacobi, RelaxMethod::red_black,
                                         RelaxMethod::accelerated};
constexpr RelaxMethod kAllMethods[] = {RelaxMethod::plain, RelaxMethod::jacobi,
                                       RelaxMethod::red_black, RelaxMethod::accelerated};

RelaxParams params_of(RelaxMethod method, int passes) {
  RelaxParams params;
  params.method = method;
  params.passes = passes;
  return params;
}

Body soft_body(const Vec3i& dims, const std::function<double(int, int, int)>& density) {
  return body_of(full_block(dims, linear_table(1.5, 0.6, 0.7), density));
}

/// Asks to stop after so many passes.
class StopAfter : public Progress {
 public:
  explicit StopAfter(int passes) : m_left(passes) {}
  void stage(std::string_view) override {}
  void update(double) override { --m_left; }
  bool cancelled() const override { return m_left <= 0; }

 private:
  int m_left;
};

}  // namespace

TEST(PropertyRelaxation, EveryPassLeavesAValidBodyOfNoMoreEnergy) {
  LEFT_OUT_WHEN_SANITIZED();
  std::mt19937 random(3);
  std::int64_t moved = 0;
  for (int n = 0; n < cases(30); ++n) {
    Dragged start = dragged(random, {13, 11, 9});
    const Dragged before = start;
    for (const RelaxMethod method : kValidMethods) {
      start = before;
      // The accelerated method looks for elements that block each other every 24th pass.
      const int passes = method == RelaxMethod::accelerated ? 50 : 10;
      Relaxation relaxation = relaxation_of(start, params_of(method, passes));
      double energy = HUGE_VAL;
      for (int pass = 0; pass < passes; ++pass) {
        moved += relaxation.pass() > 0;
        ASSERT_LE(relaxation.energy_before_pass(), energy * (1 + 1e-12)) << name_of(method);
        energy = relaxation.energy_before_pass();
        relaxation.store();
        ASSERT_EQ(check_links(start.body).violated, 0) << name_of(method) << " pass " << pass;
      }
      EXPECT_LE(relaxation.energy(), energy * (1 + 1e-12)) << name_of(method);
      EXPECT_NEAR(relaxation.energy(), spring_energy(start.body),
                  1e-3 * spring_energy(before.body) + 1e-9);
    }
  }
  EXPECT_GT(moved, cases(800));
}

TEST(PropertyRelaxation, ASweepEndsAtWholeNumbers) {
  // No inequality may be lost to rounding, however many sweeps follow each other.
  std::mt19937 random(13);
  const Dragged start = dragged(random, {8, 8, 8});
  const LinkTable table(start.body, 0, RigidLinks::absent);
  for (std::size_t b = 0; b < start.body.elements.brick_count(); ++b) {
    PaddedBrick<double> offsets;
    pad_brick(
        start.body.elements, b, 0.0,
        [&](std::size_t) { return [&](int) { return double(random() % 99999); }; }, offsets);
    BrickSprings links;
    find_links(start.body, b, table.missing(), links);
    for (const double relaxation : {0.7, 1.0, 1.9}) {
      double moved[kBrickVoxels];
      SweepRule rule;
      rule.relaxation = relaxation;
      const SweepOutcome outcome =
          sweep_brick(offsets, links, nullptr, table, start.body.elements.mask(b), rule, moved);
      EXPECT_GT(outcome.largest_step, 0);
      for (const double value : moved) ASSERT_EQ(value, std::floor(value));
    }
  }
}

TEST(PropertyRelaxation, WhatIsHeldStays) {
  LEFT_OUT_WHEN_SANITIZED();
  std::mt19937 random(5);
  int at_bound = 0;
  for (int n = 0; n < cases(60); ++n) {
    const Dragged start = dragged(random, {9, 9, 7});
    for (const RelaxMethod method : kAllMethods) {
      at_bound += expect_held_through(start, params_of(method, 15));
    }
  }
  EXPECT_GT(at_bound, cases(20));
}

TEST(PropertyRelaxation, TheResultDoesNotDependOnTheNumberOfThreads) {
  LEFT_OUT_WHEN_SANITIZED();
  std::mt19937 random(7);
  for (int n = 0; n < 6; ++n) {
    const Dragged start = dragged(random, {30, 28, 26});
    for (const RelaxMethod method : kValidMethods) {
      expect_same_on_any_threads(start, params_of(method, 25));
    }
  }
}

TEST(PropertyRelaxation, ThePlainPassOfTheThesisBreaksLimits) {
  const auto noise = [](int i, int j, int k) { return double((i * 37 + j * 91 + k * 53) % 256); };
  Body body = soft_body({24, 24, 24}, noise);
  Holds holds;
  drag(body, {{{12, 12, 12}, {6 * kVoxel, 0, 0}}}, {}, holds);
  Body valid = body;
  RelaxParams params;
  params.passes = 1;
  params.method = RelaxMethod::plain;
  const RelaxReport report = relax(body, {}, holds, params);
  const LinkCheck check = check_links(body);
  EXPECT_GT(check.violated, check.links / 200);
  EXPECT_FALSE(body.links_known_valid);
  // Whole steps go further down, which is what breaks them.
  params.method = RelaxMethod::jacobi;
  EXPECT_GT(relax(valid, {}, holds, params).energy_after, report.energy_after);
}

TEST(PropertyRelaxation, AChainComesToRestWhereItsSpringsBalance) {
  LEFT_OUT_WHEN_SANITIZED();
  // Soft and hard links in turn: 1 and 4 kPa at densities 0 and 255, 2.5 between.
  MaterialTable table = linear_table(3, 0.1, 2);
  table.max_length.keys = {{0, 3}};
  table.min_length.keys = {{0, 0.1}};
  table.stiffness = Curve{{{0, 1}, {255, 4}}};
  Block block = full_block({41, 1, 1}, table, [](int i, int, int) { return i < 20 ? 0.0 : 255.0; });
  block.spacing_mm = {0.5, 2, 3};
  for (const RelaxMethod method : kValidMethods) {
    Body body = body_of(block);
    Holds holds;
    drag(body, {{{40, 0, 0}, {10 * kVoxel, 0, 0}}}, {Region({0, 0, 0})}, holds);
    RelaxParams params;
    params.method = method;
    params.passes = 20000;
    params.tolerance_voxels = 1e-9;
    const RelaxReport report = relax(body, {Region({0, 0, 0})}, holds, params);
    EXPECT_TRUE(report.converged) << name_of(method);
    // 19 soft links, one between, 20 hard ones in series.
    const double compliance = 19 / 1.0 + 1 / 2.5 + 20 / 4.0;
    EXPECT_NEAR(body.offset({19, 0, 0}, 0) / kFixedOne, 10 * 19 / compliance, 1e-3);
    EXPECT_NEAR(body.offset({20, 0, 0}, 0) / kFixedOne, 10 * (19 + 1 / 2.5) / compliance, 1e-3);
    // Springs of k = E * 2 mm * 3 mm / 0.5 mm over 10 voxels of 0.5 mm.
    EXPECT_NEAR(report.energy_after, 0.5 * (12 / compliance) * 25, 1e-3);
  }
}

TEST(PropertyRelaxation, ALimitedLinkStopsAtItsLimit) {
  // Nine links may grow by 0.2 and one by 1.5: pulled by 2.4, they take 0.2 each and 0.6.
  MaterialTable table = linear_table(2.5, 0.5, 1);
  table.max_length.keys = {{0, 1.2}, {126, 1.2}, {127, 2.5}};
  table.stiffness = Curve{{{0, 1}, {126, 1}, {127, 100}}};
  Body body = body_of(full_block({11, 1, 1}, table,
                                 [](int i, int, int) { return i == 5 || i == 6 ? 127.0 : 0.0; }));
  Holds holds;
  drag(body, {{{10, 0, 0}, {kVoxel * 24 / 10, 0, 0}}}, {Region({0, 0, 0})}, holds);
  RelaxParams params;
  params.passes = 5000;
  params.tolerance_voxels = 1e-9;
  relax(body, {Region({0, 0, 0})}, holds, params);
  EXPECT_NEAR((body.offset({6, 0, 0}, 0) - body.offset({5, 0, 0}, 0)) / kFixedOne, 0.6, 1e-3);
  EXPECT_EQ(check_links(body).violated, 0);
}

TEST(PropertyRelaxation, AnElasticBodyWithRigidPartsReturnsToItsShape) {
  LEFT_OUT_WHEN_SANITIZED();
  // A rigid T in soft tissue, its far side fixed.
  const Block block = t_shape(24);
  const Region rim({0, 0, 0}, {0, 23, 0});
  for (const RelaxMethod method : {RelaxMethod::red_black, RelaxMethod::accelerated}) {
    Body body = body_of(block);
    drag(body, {{{23, 12, 0}, {5 * kVoxel, 4 * kVoxel, kVoxel}}}, {rim});
    const std::int32_t bar = body.offset({14, 12, 0}, 0);
    EXPECT_GT(bar, kVoxel);
    RelaxParams params;
    params.method = method;
    params.passes = 8000;
    params.tolerance_voxels = 1e-8;
    const RelaxReport report = relax(body, {rim}, {}, params);
    EXPECT_TRUE(report.converged);
    EXPECT_LT(report.energy_after, 1e-6 * report.energy_before);
    for (int n = 0; n < block.size(); ++n) {
      for (int c = 0; c < 3; ++c) {
        EXPECT_LE(std::abs(body.offset(block.voxel(n), c)), kVoxel / 1000) << name_of(method);
      }
    }
  }
}

TEST(PropertyRelaxation, ARigidPartMovesAsOne) {
  const Block block = t_shape(24);
  Body body = body_of(block);
  Holds holds;
  drag(body, {{{23, 12, 0}, {5 * kVoxel, 0, 0}}}, {}, holds);
  const Body before = body;
  RelaxParams params;
  params.passes = 40;
  relax(body, {}, holds, params);
  const Vec3i part{15, 8, 0};
  ASSERT_EQ(block.density[std::size_t(block.index(15, 8, 0))], 0);
  EXPECT_NE(body.offset(part, 0), before.offset(part, 0));
  for (int n = 0; n < block.size(); ++n) {
    if (block.density[std::size_t(n)] == 0) {
      EXPECT_EQ(body.offset(block.voxel(n), 0), body.offset(part, 0));
    }
  }
}

TEST(PropertyRelaxation, OnlyBricksThatItReachesHaveMemory) {
  Body body = soft_row(400);
  Holds holds;
  drag(body, {{{399, 0, 0}, {4 * kVoxel, 0, 0}}}, {}, holds);
  EXPECT_EQ(body.q[0].stored_bricks(), 1u);
  RelaxParams params;
  params.method = RelaxMethod::jacobi;
  params.passes = 10;
  relax(body, {}, holds, params);
  EXPECT_LE(body.q[0].stored_bricks(), 3u);
  EXPECT_TRUE(body.q[1].empty());
}

TEST(PropertyRelaxation, AnInterruptedOneIsWhatItsPassesMade) {
  MaterialTable table = linear_table(1.5, 0.6, 0.7);
  table.yield_strain = Curve{{{0, 0.1}}};
  Body rest = body_of(full_block({60, 1, 1}, table, [](int, int, int) { return 255.0; }));
  const std::vector<Region> fixed = {Region({0, 0, 0})};
  Holds holds;
  drag(rest, {{{59, 0, 0}, {9 * kVoxel, 0, 0}}}, fixed, holds);
  for (const RelaxMethod method : kAllMethods) {
    Body whole = rest, interrupted = rest;
    relax(whole, fixed, holds, params_of(method, 7));
    StopAfter seven(7);
    EXPECT_THROW(relax(interrupted, fixed, holds, params_of(method, 100), &seven), Cancelled);
    EXPECT_EQ(interrupted.q, whole.q) << name_of(method);
    EXPECT_FALSE(interrupted.rest[0][0].empty());
    EXPECT_TRUE(interrupted.rest == whole.rest) << name_of(method);
    EXPECT_EQ(interrupted.links_known_valid, method != RelaxMethod::plain);
    if (method == RelaxMethod::plain) continue;
    EXPECT_EQ(check_links(interrupted).violated, 0);
  }
}

TEST(ExtremesRelaxation, OffsetsStayWithinTheirRange) {
  // Both ends of a row at the end of the range, its middle at rest: long steps aim beyond.
  MaterialTable table = linear_table(1e6, 0.5, 0.5);
  table.max_length.keys = {{0, 1e6}};
  table.min_length.keys = {{0, 1e-6}};
  Body body = body_of(full_block({9, 1, 1}, table, [](int, int, int) { return 255.0; }));
  body.q[1].resize(body.elements.brick_count());
  body.slacks = SlackTable(linear_table(1e6, 0.5, 1e6), body.geometry.spacing_mm());
  Slot ends[2];
  ASSERT_TRUE(slot_of(body.elements, {0, 0, 0}, ends[0]));
  ASSERT_TRUE(slot_of(body.elements, {8, 0, 0}, ends[1]));
  for (const Slot end : ends) body.q[1].set(end, kMaxOffset);
  const SlotSet fixed(std::vector<Slot>(ends, ends + 2));
  const Holds none;
  Relaxation relaxation(body, fixed, none, params_of(RelaxMethod::accelerated, 0));
  for (int pass = 0; pass < 60; ++pass) {
    relaxation.pass();
    relaxation.store();
    for (int i = 0; i < 9; ++i) {
      EXPECT_GE(body.offset({i, 0, 0}, 1), 0);
      EXPECT_LE(body.offset({i, 0, 0}, 1), kMaxOffset);
    }
    ASSERT_EQ(check_links(body).violated, 0);
  }
  EXPECT_NEAR(body.offset({4, 0, 0}, 1), kMaxOffset, 1e-3 * kMaxOffset);
}

TEST(PropertyRelaxation, ABadRegionLeavesTheBodyAsItWas) {
  Body body = soft_row(20);
  body.q[0].resize(body.elements.brick_count());
  Slot slot;
  ASSERT_TRUE(slot_of(body.elements, {10, 0, 0}, slot));
  body.q[0].set(slot, 3 * kVoxel);
  body.links_known_valid = false;
  const auto before = body.q;
  EXPECT_NE(input_error([&] { relax(body, {Region({90, 0, 0})}, {}, {}); }), "");
  EXPECT_EQ(body.q, before);
}

TEST(PropertyRelaxation, AnInvalidStartIsProjectedFirst) {
  Body body = soft_row(20);
  body.q[0].resize(body.elements.brick_count());
  Slot slot;
  ASSERT_TRUE(slot_of(body.elements, {10, 0, 0}, slot));
  body.q[0].set(slot, 3 * kVoxel);
  body.links_known_valid = false;
  RelaxParams params;
  params.passes = 1;
  const RelaxReport report = relax(body, {}, {}, params);
  EXPECT_EQ(report.projected_links, 2);
  EXPECT_GT(report.projected_max_voxels, 0);
  EXPECT_EQ(check_links(body).violated, 0);
}

TEST(PropertyRelaxation, BadParametersAreErrors) {
  Body body = soft_row(3);
  RelaxParams params;
  params.passes = -1;
  EXPECT_NE(input_error([&] { relax(body, {}, {}, params); }).find("passes: found -1"),
            std::string::npos);
  params.passes = 1;
  params.tolerance_voxels = -0.5;
  EXPECT_NE(input_error([&] { relax(body, {}, {}, params); }).find("tolerance"), std::string::npos);
}
