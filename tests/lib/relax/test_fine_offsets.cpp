// Fractions of offsets beyond 2^-16 voxel, which relaxation keeps from one run to the next.
#include <random>

#include <gtest/gtest.h>

#include "lib/body/slot_set.h"
#include "lib/chainmail/ecm.h"
#include "lib/model/relax_model.h"
#include "lib/relax/brick_springs.h"
#include "lib/relax/fine_offsets.h"
#include "tests/lib/relaxed_bodies.h"
#include "tests/support/sanitized.h"

using namespace supple;
using namespace supple::test;

namespace {

RelaxParams jacobi(int passes) {
  RelaxParams params;
  params.method = RelaxMethod::jacobi;
  params.passes = passes;
  return params;
}

/// Fractions as any other model may leave them.
void scatter_fractions(std::mt19937& random, Body& body) {
  std::uniform_int_distribution<int> any(-32768, 32767);
  for (auto& fractions : body.fraction) {
    fractions.resize(body.elements.brick_count());
    for_each_element(body.elements,
                     [&](Slot slot) { fractions.set(slot, std::int16_t(any(random))); });
  }
}

/// Links of the coordinate that the offsets break, and bounds.
int broken(const Body& body, const LinkTable& table, const Holds& held,
           const BrickArray<double>& fine) {
  const std::size_t c = std::size_t(table.coordinate());
  int count = 0;
  for (std::size_t b = 0; b < body.elements.brick_count(); ++b) {
    for_each_link(body.elements, body.cuts, b, [&](int axis, Slot low, Slot high) {
      const std::uint8_t low_class = body.classes[low], high_class = body.classes[high];
      const std::int32_t upper = body.slacks.upper(axis, table.coordinate(), low_class, high_class);
      const std::int32_t lower = body.slacks.lower(axis, table.coordinate(), low_class, high_class);
      const double stretch = fine.at(high) - fine.at(low);
      count += stretch > upper * kFinePerUnit || -stretch > lower * kFinePerUnit;
    });
  }
  for (const Bound& bound : held.at_least[c]) {
    count += fine.at(bound.slot) < bound.value * kFinePerUnit;
  }
  for (const Bound& bound : held.at_most[c]) {
    count += fine.at(bound.slot) > bound.value * kFinePerUnit;
  }
  return count;
}

}  // namespace

TEST(PropertyFineOffsets, TwoRunsAreOneOfAsManyPasses) {
  LEFT_OUT_WHEN_SANITIZED();
  std::mt19937 random(21);
  int with_fractions = 0;
  for (int n = 0; n < 20; ++n) {
    Dragged start = dragged(random, {13, 11, 9});
    Body whole = start.body, parts = start.body;
    relax(whole, start.anchors, start.holds, jacobi(20));
    relax(parts, start.anchors, start.holds, jacobi(7));
    with_fractions += !parts.fraction[0].empty();
    relax(parts, start.anchors, start.holds, jacobi(13));
    EXPECT_EQ(parts.q, whole.q);
    EXPECT_TRUE(parts.fraction == whole.fraction);
  }
  EXPECT_GT(with_fractions, 5);
}

TEST(PropertyFineOffsets, FractionsThatBreakALinkOrABoundAreDroppedAndNoOthers) {
  std::mt19937 random(22);
  int dropped = 0, kept = 0, bounds = 0;
  for (int n = 0; n < 40; ++n) {
    Dragged start = dragged(random, {13, 11, 9});
    scatter_fractions(random, start.body);
    for (int c = 0; c < 3; ++c) {
      const LinkTable table(start.body, c, RigidLinks::absent);
      const BrickArray<double> fine = fine_offsets(start.body, table, start.holds);
      EXPECT_EQ(broken(start.body, table, start.holds, fine), 0);
      bounds += int(start.holds.at_least[std::size_t(c)].size());
      for_each_element(start.body.elements, [&](Slot slot) {
        const double whole = start.body.q[std::size_t(c)].at(slot) * kFinePerUnit;
        const double part = start.body.fraction[std::size_t(c)].at(slot);
        const double found = fine.at(slot) - whole;
        EXPECT_TRUE(found == 0 || found == part);
        (found == part ? kept : dropped) += part != 0;
      });
    }
  }
  EXPECT_GT(dropped, 1000);
  EXPECT_GT(kept, 1000);
  EXPECT_GT(bounds, 0);
}

TEST(PropertyFineOffsets, ADragDropsTheFractionsOfWhatItMovesOnly) {
  std::mt19937 random(23);
  Body body = body_of(soft_block({30, 9, 9}));
  scatter_fractions(random, body);
  const Body before = body;
  drag(body, {{{4, 4, 4}, {2 * 65536, 0, 0}}}, {});
  int moved = 0, stayed = 0;
  for_each_element(body.elements, [&](Slot slot) {
    for (std::size_t c = 0; c < 3; ++c) {
      const bool has_moved = body.q[c].at(slot) != before.q[c].at(slot);
      EXPECT_EQ(body.fraction[c].at(slot), has_moved ? 0 : before.fraction[c].at(slot));
      (has_moved ? moved : stayed) += 1;
    }
  });
  EXPECT_GT(moved, 50);
  EXPECT_GT(stayed, 100);
}

TEST(PropertyFineOffsets, ProjectionDropsThemToo) {
  Body body = soft_row(8);
  Slot end;
  ASSERT_TRUE(slot_of(body.elements, {7, 0, 0}, end));
  body.q[0].resize(body.elements.brick_count());
  body.q[0].set(end, 5 * 65536);
  body.fraction[0].resize(body.elements.brick_count());
  body.fraction[0].set(end, 99);
  body.fraction[0].set(end - 7 * 64, 98);
  project(body);
  EXPECT_EQ(body.fraction[0].at(end), 0);
  EXPECT_EQ(body.fraction[0].at(end - 7 * 64), body.offset({0, 0, 0}, 0) == 0 ? 98 : 0);
}

TEST(PropertyFineOffsets, ABodyWithoutFractionsHasNoMemoryForThem) {
  Body body = body_of(soft_block({20, 8, 8}));
  drag(body, {{{4, 4, 4}, {65536, 0, 0}}}, {});
  for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(body.fraction[c].bytes(), 0u);
  relax(body, {}, {}, jacobi(3));
  EXPECT_FALSE(body.fraction[0].empty());
  EXPECT_EQ(body.fraction[1].bytes(), 0u);
}
