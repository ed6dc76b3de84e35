// Tightening limits (thesis section 4.2.4, second suggestion): the rule by hand, and what holds for
// every body and state.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "lib/chainmail/tighten.h"
#include "lib/relax/cell_volume.h"
#include "tests/lib/relaxed_bodies.h"
#include "tests/lib/test_bodies.h"
#include "tests/support/sanitized.h"
#include "volumes/base/parallel.h"

using namespace supple;
using namespace supple::test;

namespace {

/// Links along i get that length.
void stretch_along_i(Body& body, double length) {
  body.q[0].resize(body.elements.brick_count());
  for_each_element(body.elements, [&](Slot slot) {
    body.q[0].set(slot, std::int32_t(voxel_of(body.elements, slot).x * (length - 1) * kVoxel));
  });
}

Slot slot_at(const Body& body, const Vec3i& voxel) {
  Slot slot = 0;
  EXPECT_TRUE(slot_of(body.elements, voxel, slot));
  return slot;
}

TightRange range_at(const Body& body, int axis, const Vec3i& low) {
  Vec3i high = low;
  ++high[axis];
  return tight_range(body, body.q, axis, slot_at(body, low), slot_at(body, high));
}

/// Every link's excess by the words of tight_limits.h, in voxels.
struct Excess {
  std::int64_t tightened = 0, violated = 0;
  double worst = 0, sum = 0;  // sum: root of that of the squares
};
Excess excess_by_definition(const Body& body) {
  Excess result;
  const auto length = [&](int axis, Slot low, Slot high) {
    return 1 +
           double(body.q[std::size_t(axis)].at(high) - body.q[std::size_t(axis)].at(low)) / kVoxel;
  };
  const auto mean = [&](int axis, Slot a, Slot b) {
    double sum = 0;
    int count = 0;
    for (const Slot end : {a, b}) {
      Slot other;
      if (neighbour_slot(body.elements, body.cuts, end, axis, true, other)) {
        sum += length(axis, end, other);
        ++count;
      }
      if (neighbour_slot(body.elements, body.cuts, end, axis, false, other)) {
        sum += length(axis, other, end);
        ++count;
      }
    }
    return count == 0 ? 1 : sum / count;
  };
  for (std::size_t b = 0; b < body.elements.brick_count(); ++b) {
    for_each_link(body.elements, body.cuts, b, [&](int axis, Slot low, Slot high) {
      const double along = length(axis, low, high);
      const double p = mean((axis + 1) % 3, low, high), q = mean((axis + 2) % 3, low, high);
      const double driving = std::abs(std::log(p)) > std::abs(std::log(q)) ? p : q;
      const LinkSlack slack = body.slacks.slack(axis, body.classes[low], body.classes[high]);
      double least = 1 - slack.lower[std::size_t(axis)] / kFixedOne;
      double most = 1 + slack.upper[std::size_t(axis)] / kFixedOne;
      const double wanted = std::clamp(1 / std::sqrt(driving), least, most);
      if (std::abs(std::log(driving)) <= std::abs(std::log(along))) return;
      result.tightened += wanted != (driving > 1 ? most : least);
      (driving > 1 ? most : least) = wanted;
      const double excess = std::max({0.0, along - most, least - along});
      result.violated += excess > TightenParams().tolerance;
      result.worst = std::max(result.worst, excess);
      result.sum += excess * excess;
    });
  }
  result.sum = std::sqrt(result.sum);
  return result;
}

/// A bar along i with one end fixed and the other pulled.
Dragged pulled_bar(double part) {
  Dragged bar{body_of(homogeneous({30, 10, 10}, 1.5, 0.6, 0.6)), {}, {}};
  bar.anchors.push_back(Region({0, 0, 0}, {0, 9, 9}));
  const Region end({29, 0, 0}, {29, 9, 9});
  drag(bar.body, {{end, {std::int32_t(part * 29 * kVoxel), 0, 0}}}, bar.anchors, bar.holds);
  return bar;
}

}  // namespace

TEST(UnitTighten, AcrossAStretchedLinkTheLongestLengthFallsWithItsSquareRoot) {
  Body body = body_of(homogeneous({9, 3, 2}, 1.6, 0.5, 1));
  stretch_along_i(body, 1.25);
  for (const int axis : {1, 2}) {
    const TightRange range = range_at(body, axis, {4, 1, 0});
    EXPECT_TRUE(range.is_tightened);
    EXPECT_EQ(range.most, std::lround((1 / std::sqrt(1.25) - 1) * kVoxel));
    EXPECT_EQ(range.least, -kVoxel / 2);
  }
  // The stretched ones keep the material's.
  const TightRange along = range_at(body, 0, {4, 1, 0});
  EXPECT_FALSE(along.is_tightened);
  EXPECT_EQ(along.most, std::int32_t(0.6 * kVoxel));
}

TEST(UnitTighten, AcrossAPressedLinkTheShortestLengthGrows) {
  Body body = body_of(homogeneous({9, 3, 1}, 1.6, 0.5, 1));
  stretch_along_i(body, 0.64);
  EXPECT_NEAR(range_at(body, 1, {4, 1, 0}).least, kVoxel / 4, 2);
  EXPECT_EQ(range_at(body, 1, {4, 1, 0}).most, std::int32_t(0.6 * kVoxel));
}

TEST(UnitTighten, TheMaterialBoundsWhatIsTightened) {
  Body body = body_of(homogeneous({9, 3, 1}, 1.6, 0.9375, 1));
  stretch_along_i(body, 1.5);
  EXPECT_EQ(range_at(body, 1, {4, 1, 0}).most, -kVoxel / 16);
  EXPECT_EQ(range_at(body, 1, {4, 1, 0}).least, -kVoxel / 16);
}

TEST(UnitTighten, ALinkThatIsItselfFurtherFromRestKeepsItsLimits) {
  Body body = body_of(homogeneous({9, 3, 1}, 2, 0.5, 1));
  stretch_along_i(body, 1.25);
  body.q[1].resize(body.elements.brick_count());
  // 0.875 is nearer to 1 than 1.25, 0.75 is further away.
  body.q[1].set(slot_at(body, {4, 1, 0}), -kVoxel / 8);
  EXPECT_TRUE(range_at(body, 1, {4, 0, 0}).is_tightened);
  body.q[1].set(slot_at(body, {4, 1, 0}), -kVoxel / 4);
  EXPECT_FALSE(range_at(body, 1, {4, 0, 0}).is_tightened);
}

TEST(UnitTighten, TheMeanOfTheLinksAtBothEndsCounts) {
  Block block = homogeneous({3, 2, 1}, 2, 0.5, 1);
  Body body = body_of(block);
  body.q[0].resize(body.elements.brick_count());
  // One of the four links across is 1.5 long.
  body.q[0].set(slot_at(body, {2, 0, 0}), kVoxel / 2);
  EXPECT_EQ(range_at(body, 1, {1, 0, 0}).most, std::lround((1 / std::sqrt(1.125) - 1) * kVoxel));
  // There are three links without the one beside it.
  block.cut.assign(6, 0);
  block.cut[0] = 1;
  Body cut = body_of(block);
  cut.q = body.q;
  EXPECT_EQ(range_at(cut, 1, {1, 0, 0}).most,
            std::lround((1 / std::sqrt(1 + 0.5 / 3) - 1) * kVoxel));
}

TEST(UnitTighten, TheCheckReachesLinksDiagonallyAcrossBricks) {
  Body body = body_of(homogeneous({16, 16, 1}, 2, 0.5, 1));
  body.q[0].resize(body.elements.brick_count());
  // Only the brick of (8, 8) is stored; the link of (7, 7) lies in the brick across its corner.
  body.q[0].set(slot_at(body, {8, 8, 0}), kVoxel / 2);
  LinkOffsets missing;
  const TightCheck check = check_tight(body, body.q, 1e-3, missing);
  for (int j = 7; j < 9; ++j) {
    EXPECT_EQ(missing[1].at(slot_at(body, {7, j, 0})), range_at(body, 1, {7, j, 0}).most) << j;
    EXPECT_LT(missing[1].at(slot_at(body, {7, j, 0})), 0) << j;
  }
  EXPECT_EQ(check.links, excess_by_definition(body).tightened);
}

TEST(UnitTighten, AFreeBarGetsThinnerAboutItsMiddle) {
  Body body = body_of(homogeneous({17, 6, 5}, 1.6, 0.5, 1));
  stretch_along_i(body, 1.25);
  const TightenReport report = tighten(body, {}, {});
  const double thinner = std::round((1 / std::sqrt(1.25) - 1) * kVoxel);
  for_each_element(body.elements, [&](Slot slot) {
    const Vec3i voxel = voxel_of(body.elements, slot);
    EXPECT_NEAR(body.offset(voxel, 1), thinner * (voxel.y - 2.5), 1);
    EXPECT_EQ(body.offset(voxel, 2), thinner * (voxel.z - 2));
    EXPECT_EQ(body.offset(voxel, 0), voxel.x * kVoxel / 4);
  });
  EXPECT_NEAR(cell_volumes(body).ratio(), 1, 1e-4);
  EXPECT_EQ(report.iterations, 1);
  EXPECT_TRUE(report.settled);
  EXPECT_EQ(report.links, 17 * (5 * 5 + 6 * 4));
  EXPECT_EQ(report.violated, 0);
  EXPECT_EQ(report.excess_voxels, 0);
  EXPECT_NEAR(report.excess_before_voxels, std::sqrt(double(report.links)) * -thinner / kVoxel,
              1e-2);
  EXPECT_EQ(report.moved, 17 * 6 * 5);
}

TEST(UnitTighten, AChainMovesAboutWhatItHoldsOnTo) {
  Body body = body_of(homogeneous({9, 6, 1}, 1.6, 0.5, 1));
  stretch_along_i(body, 1.25);
  Holds held;
  const Region side({0, 1, 0}, {8, 1, 0});
  tighten(body, {side}, held);
  const double thinner = std::round((1 / std::sqrt(1.25) - 1) * kVoxel);
  for (int j = 0; j < 6; ++j) EXPECT_EQ(body.offset({4, j, 0}, 1), thinner * (j - 1)) << j;
}

TEST(UnitTighten, AChainMovesAboutWhatAPushHandleHolds) {
  Body body = body_of(homogeneous({9, 6, 1}, 1.6, 0.5, 1));
  stretch_along_i(body, 1.25);
  for (const bool is_below : {true, false}) {
    Holds held;
    for (int i = 0; i < 9; ++i) {
      (is_below ? held.at_least : held.at_most)[1].push_back({slot_at(body, {i, 1, 0}), 0});
    }
    auto& bounds = (is_below ? held.at_least : held.at_most)[1];
    std::sort(bounds.begin(), bounds.end(),
              [](const Bound& a, const Bound& b) { return a.slot < b.slot; });
    Body tightened = body;
    tighten(tightened, {}, held);
    const double thinner = std::round((1 / std::sqrt(1.25) - 1) * kVoxel);
    for (int j = 0; j < 6; ++j) EXPECT_EQ(tightened.offset({4, j, 0}, 1), thinner * (j - 1)) << j;
  }
}

TEST(UnitTighten, WhatLiesBetweenTwoHeldElementsStaysAndIsCounted) {
  Body body = body_of(homogeneous({9, 6, 1}, 1.6, 0.5, 1));
  stretch_along_i(body, 1.25);
  const TightenReport report =
      tighten(body, {Region({0, 1, 0}, {8, 1, 0}), Region({0, 4, 0}, {8, 4, 0})}, {});
  const double thinner = std::round((1 / std::sqrt(1.25) - 1) * kVoxel);
  const double expected[6] = {-thinner, 0, 0, 0, 0, thinner};
  for (int j = 0; j < 6; ++j) EXPECT_EQ(body.offset({4, j, 0}, 1), expected[j]) << j;
  EXPECT_EQ(report.violated, 9 * 3);
  EXPECT_NEAR(report.worst_excess_voxels, -thinner / kVoxel, 1e-9);
  EXPECT_TRUE(report.settled);
}

TEST(UnitTighten, OfAChainThatIsStretchedAtOneEndTheRestStays) {
  Body body = body_of(homogeneous({4, 20, 1}, 1.6, 0.5, 1));
  body.q[0].resize(body.elements.brick_count());
  for (int j = 0; j < 4; ++j) {
    for (int i = 0; i < 4; ++i) body.q[0].set(slot_at(body, {i, j, 0}), i * kVoxel / 4);
  }
  TightenParams params;
  params.iterations = 1;
  tighten(body, {}, {}, params);
  EXPECT_GT(body.offset({2, 0, 0}, 1), kVoxel / 4);
  for (int j = 5; j < 20; ++j) EXPECT_EQ(body.offset({2, j, 0}, 1), 0) << j;
}

TEST(PropertyTighten, TheResultIsValidHoldsWhatIsHeldAndNeverMissesMoreThanTheStart) {
  LEFT_OUT_WHEN_SANITIZED();
  std::mt19937 random(11);
  int improved = 0, left = 0;
  for (int n = 0; n < 60; ++n) {
    Dragged start = dragged(random, {14, 11, 9});
    const Body before = start.body;
    const TightenReport report = tighten(start.body, start.anchors, start.holds);
    EXPECT_EQ(check_links(start.body).violated, 0) << n;
    EXPECT_TRUE(start.body.links_known_valid);
    anchored_elements(start.body, start.anchors, start.holds).for_each([&](Slot slot) {
      for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_EQ(start.body.q[c].at(slot), before.q[c].at(slot)) << n;
      }
    });
    for (std::size_t c = 0; c < 3; ++c) {
      for (const Bound& bound : start.holds.at_least[c]) {
        EXPECT_GE(start.body.q[c].at(bound.slot), bound.value) << n;
      }
      for (const Bound& bound : start.holds.at_most[c]) {
        EXPECT_LE(start.body.q[c].at(bound.slot), bound.value) << n;
      }
    }
    std::int64_t moved = 0;
    for_each_element(before.elements, [&](Slot slot) {
      bool changed = false;
      for (std::size_t c = 0; c < 3; ++c) {
        changed |= start.body.q[c].at(slot) != before.q[c].at(slot);
      }
      moved += changed;
    });
    EXPECT_EQ(report.moved, moved) << n;
    EXPECT_LE(report.excess_voxels, report.excess_before_voxels) << n;
    improved += report.excess_voxels < 0.5 * report.excess_before_voxels;
    left += report.violated > 0;
  }
  EXPECT_GE(improved, 10);
  EXPECT_GE(left, 10);
}

TEST(PropertyTighten, TheReportCountsByTheDefinition) {
  std::mt19937 random(12);
  for (int n = 0; n < 40; ++n) {
    Dragged start = dragged(random, {20, 11, 9});
    const Excess before = excess_by_definition(start.body);
    const TightenReport report = tighten(start.body, start.anchors, start.holds);
    const Excess after = excess_by_definition(start.body);
    // Excesses are rounded to 2^-12 voxel before they are squared.
    const auto rounding = [](const Excess& of) {
      return std::sqrt(double(of.tightened + 1)) / 8192;
    };
    EXPECT_NEAR(report.excess_before_voxels, before.sum, rounding(before)) << n;
    EXPECT_NEAR(report.excess_voxels, after.sum, rounding(after)) << n;
    EXPECT_NEAR(report.worst_excess_voxels, after.worst, 1.0 / kVoxel) << n;
    EXPECT_NEAR(double(report.links), double(after.tightened), 0.01 * double(after.tightened)) << n;
    EXPECT_NEAR(double(report.violated), double(after.violated), 2) << n;
  }
}

TEST(PropertyTighten, ASettledStateStays) {
  LEFT_OUT_WHEN_SANITIZED();
  std::mt19937 random(13);
  int settled = 0;
  for (int n = 0; n < 20; ++n) {
    Dragged start = dragged(random, {12, 9, 6});
    if (!tighten(start.body, start.anchors, start.holds).settled) continue;
    ++settled;
    const Body once = start.body;
    const TightenReport again = tighten(start.body, start.anchors, start.holds);
    EXPECT_TRUE(same_offsets(start.body, once)) << n;
    EXPECT_EQ(again.iterations, 0);
    EXPECT_EQ(again.moved, 0);
  }
  EXPECT_GE(settled, 15);
}

TEST(PropertyTighten, TheResultIsTheSameBitsWhateverTheThreads) {
  std::mt19937 random(14);
  const Dragged start = dragged(random, {40, 30, 20});
  std::vector<Body> bodies;
  for (const int threads : {1, 2, 3, 8}) {
    bodies.push_back(start.body);
    on_threads(threads, [&] { tighten(bodies.back(), start.anchors, start.holds); });
    EXPECT_TRUE(same_offsets(bodies.back(), bodies.front())) << threads;
  }
  EXPECT_FALSE(same_offsets(bodies.front(), start.body));
}

TEST(PropertyTighten, WhereTheBodyIsDoesNotMatter) {
  Dragged here = pulled_bar(0.2);
  Dragged there = here;
  for (BrickValues& values : there.body.q) {
    values.resize(there.body.elements.brick_count());
    for_each_element(there.body.elements,
                     [&](Slot slot) { values.set(slot, values.at(slot) + 16000 * kVoxel); });
  }
  tighten(here.body, here.anchors, here.holds);
  tighten(there.body, there.anchors, there.holds);
  for (std::size_t c = 0; c < 3; ++c) {
    for_each_element(here.body.elements, [&](Slot slot) {
      EXPECT_EQ(there.body.q[c].at(slot) - here.body.q[c].at(slot), 16000 * kVoxel);
    });
  }
}

TEST(PropertyTighten, APulledBarKeepsMoreOfItsVolumeAndMostAfterARelaxation) {
  Dragged bar = pulled_bar(0.2);
  const double pulled = cell_volumes(bar.body).ratio();
  EXPECT_NEAR(pulled, 1.2, 1e-3);  // nothing moves sideways
  Dragged relaxed = bar;
  tighten(bar.body, bar.anchors, bar.holds);
  EXPECT_NEAR(cell_volumes(bar.body).ratio(), 1, 0.03);
  RelaxParams params;
  params.passes = 100;
  relax(relaxed.body, relaxed.anchors, relaxed.holds, params);
  EXPECT_NEAR(cell_volumes(relaxed.body).ratio(), 1.2, 1e-3);
  tighten(relaxed.body, relaxed.anchors, relaxed.holds);
  EXPECT_NEAR(cell_volumes(relaxed.body).ratio(), 1, 0.015);
}

TEST(PropertyTighten, FractionsOfElementsThatMoveAreDropped) {
  Body body = body_of(homogeneous({9, 5, 1}, 1.6, 0.5, 1));
  stretch_along_i(body, 1.25);
  body.fraction[1].resize(body.elements.brick_count());
  for_each_element(body.elements, [&](Slot slot) { body.fraction[1].set(slot, 77); });
  tighten(body, {}, {});
  for_each_element(body.elements, [&](Slot slot) {
    const bool is_middle = voxel_of(body.elements, slot).y == 2;
    EXPECT_EQ(body.fraction[1].at(slot), is_middle ? 77 : 0);
  });
}

TEST(PropertyTighten, ABodyAtRestCostsNothingAndStays) {
  Body body = body_of(homogeneous({9, 9, 9}, 1.5, 0.6, 0.5));
  const TightenReport report = tighten(body, {}, {});
  EXPECT_TRUE(report.settled);
  EXPECT_EQ(report.iterations, 0);
  EXPECT_EQ(report.links, 0);
  for (const BrickValues& values : body.q) EXPECT_EQ(values.stored_bricks(), 0u);
}

TEST(PropertyTighten, BoneKeepsItsShapeAndTissueBesideItIsCounted) {
  // The middle plane of the bar is rigid.
  Block block = full_block({20, 9, 5}, linear_table(1.5, 0.6, 0.5),
                           [](int, int j, int) { return j == 4 ? 0.0 : 255.0; });
  Body body = body_of(block);
  Holds holds;
  drag(body, {{Region({19, 8, 0}, {19, 8, 4}), {4 * kVoxel, 0, 0}}}, {}, holds);
  const TightenReport report = tighten(body, {}, holds);
  EXPECT_EQ(check_links(body).violated, 0);
  EXPECT_LT(report.excess_voxels, report.excess_before_voxels);
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(body.offset({i, 4, 2}, 2), body.offset({0, 4, 2}, 2));
    EXPECT_EQ(body.offset({i, 4, 2}, 1), body.offset({0, 4, 2}, 1));
  }
}

TEST(PropertyTighten, AnInvalidStartIsProjected) {
  Dragged bar = pulled_bar(0.2);
  bar.body.q[1].resize(bar.body.elements.brick_count());
  bar.body.q[1].set(slot_at(bar.body, {15, 5, 5}), 3 * kVoxel);
  bar.body.links_known_valid = false;
  const TightenReport report = tighten(bar.body, bar.anchors, bar.holds);
  EXPECT_EQ(report.projected_links, 6);
  EXPECT_EQ(report.projected_held, 0);
  EXPECT_GT(report.projected_max_voxels, 1);
  EXPECT_EQ(check_links(bar.body).violated, 0);
  EXPECT_TRUE(bar.body.links_known_valid);
}

TEST(FaultTighten, AnErrorOrCancelLeavesTheBodyAsItWas) {
  class Stop final : public Progress {
    void stage(std::string_view) override {}
    void update(double) override {}
    bool cancelled() const override { return true; }
  } stop;
  Dragged bar = pulled_bar(0.2);
  const Body before = bar.body;
  EXPECT_THROW(tighten(bar.body, bar.anchors, bar.holds, {}, &stop), Cancelled);
  EXPECT_TRUE(same_offsets(bar.body, before));
  EXPECT_TRUE(bar.body.links_known_valid);
  EXPECT_NE(input_error([&] {
              tighten(bar.body, {Region({99, 0, 0})}, {});
            }).find("99,0,0"),
            std::string::npos);
  TightenParams params;
  params.iterations = -1;
  EXPECT_NE(input_error([&] { tighten(bar.body, {}, {}, params); }).find("iterations"),
            std::string::npos);
  params = {};
  params.tolerance = 0;
  EXPECT_NE(input_error([&] { tighten(bar.body, {}, {}, params); }).find("tolerance"),
            std::string::npos);
  EXPECT_TRUE(same_offsets(bar.body, before));
}
