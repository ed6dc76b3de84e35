// Forces on handles: springs in series and parallel by hand, and the slope of the energy.
#include <cmath>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "lib/body/lattice.h"
#include "lib/relax/reaction.h"
#include "tests/lib/relaxed_bodies.h"

using namespace supple;
using namespace supple::test;

namespace {

constexpr std::int32_t kVoxel = 65536;
const Vec3d kSpacing(0.5, 1.25, 2);

/// Limits so wide that they do not matter; Young's modulus 1 to 21 kPa.
MaterialTable wide_table() {
  MaterialTable table = linear_table(3, 0.1, 2);
  table.max_length.keys = {{0, 3}};
  table.min_length.keys = {{0, 0.1}};
  table.shear1.keys = table.shear2.keys = {{0, 2}};
  table.stiffness = Curve{{{0, 1}, {255, 21}}};
  return table;
}

Block wide_block(const Vec3i& dims, const std::function<double(int, int, int)>& density) {
  Block block = full_block(dims, wide_table(), density);
  block.spacing_mm = kSpacing;
  return block;
}

/// N/m of a link along `axis` at that mean density of a wide block.
double stiffness(int axis, double density) {
  const Vec3d& h = kSpacing;
  return (1 + 20 * density / 255) * h[(axis + 1) % 3] * h[(axis + 2) % 3] / h[axis];
}

RelaxParams to_rest(double kpa = 0) {
  RelaxParams params;
  params.passes = 20000;
  params.tolerance_voxels = 1e-9;
  params.volume_stiffness_kpa = kpa;
  return params;
}

SlotSet slots_of(const Body& body, const Vec3i& lo, const Vec3i& hi) {
  return slots_in_box(body.elements, {lo, hi});
}
SlotSet slots_of(const Body& body, const Vec3i& voxel) {
  return slots_of(body, voxel, voxel);
}

/// A row along i from 0, its first element fixed and its last one pulled.
struct Row {
  Row(Body row, int count, const std::array<std::int32_t, 3>& by)
      : body(std::move(row)), last(count - 1, 0, 0) {
    drag(body, {{last, by}}, fixed, holds);
  }
  RelaxReport relax_fully() { return relax(body, fixed, holds, to_rest()); }
  /// At the last element and at the first.
  std::vector<Reaction> ends() const {
    return reactions(body, {slots_of(body, last), slots_of(body, {0, 0, 0})},
                     slots_of(body, {0, 0, 0}), holds);
  }

  Body body;
  Vec3i last;
  std::vector<Region> fixed = {Region({0, 0, 0})};
  Holds holds;
};

/// mN per grid coordinate of a grid along L, P, S.
double force_mn(const Reaction& reaction, int c) {
  return reaction.force_n[c] * 1000;
}

bool any_taut(const Reaction& reaction) {
  return reaction.taut[0] || reaction.taut[1] || reaction.taut[2];
}

/// Whether a link is nearly at its limit, where one step more or less makes a difference.
bool has_nearly_tight(const Body& body) {
  bool found = false;
  for (std::size_t b = 0; b < body.elements.brick_count(); ++b) {
    for_each_link(body.elements, body.cuts, b, [&](int axis, Slot low, Slot high) {
      for (int c = 0; c < 3; ++c) {
        const std::uint8_t first = body.classes[low], second = body.classes[high];
        const std::int64_t apart =
            std::int64_t(body.q[std::size_t(c)].at(high)) - body.q[std::size_t(c)].at(low);
        for (const std::int64_t slack : {body.slacks.upper(axis, c, first, second) - apart,
                                         body.slacks.lower(axis, c, first, second) + apart}) {
          found = found || (slack > 0 && slack <= 64);
        }
      }
    });
  }
  return found;
}

}  // namespace

TEST(UnitReaction, AChainPullsAsItsSpringsInSeries) {
  for (int axis = 0; axis < 3; ++axis) {
    for (int c = 0; c < 3; ++c) {
      Vec3i dims(1, 1, 1), last(0, 0, 0);
      dims[axis] = 12;
      last[axis] = 11;
      const auto density = [](int n) { return double(n * 83 % 256); };
      Body body =
          body_of(wide_block(dims, [&](int i, int j, int k) { return density(i + j + k); }));
      std::array<std::int32_t, 3> by{};
      by[std::size_t(c)] = 2 * kVoxel;
      Holds holds;
      drag(body, {{last, by}}, {Region({0, 0, 0})}, holds);
      relax(body, {Region({0, 0, 0})}, holds, to_rest());

      double compliance = 0;
      for (int n = 0; n < 11; ++n) {
        compliance += 1 / stiffness(axis, (density(n) + density(n + 1)) / 2);
      }
      const double expected = 2 * kSpacing[c] / compliance / 1000;  // N
      const SlotSet first = slots_of(body, {0, 0, 0});
      const auto found = reactions(body, {slots_of(body, last), first}, first, holds);
      ASSERT_EQ(found.size(), 2u);
      for (int d = 0; d < 3; ++d) {
        EXPECT_NEAR(found[0].force_n[d], d == c ? -expected : 0, 1e-3 * expected);
        EXPECT_NEAR(found[1].force_n[d], d == c ? expected : 0, 1e-3 * expected);
      }
      EXPECT_FALSE(any_taut(found[0]) || any_taut(found[1]));
    }
  }
}

TEST(UnitReaction, ABarPullsAsItsChainsTogether) {
  Body body = body_of(wide_block({11, 9, 3}, [](int, int, int) { return 51.0; }));
  const Region near({0, 0, 0}, {0, 8, 2}), far({10, 0, 0}, {10, 8, 2});
  Holds holds;
  drag(body, {{far, {kVoxel, 0, -kVoxel / 2}}}, {near}, holds);
  relax(body, {near}, holds, to_rest());
  const SlotSet start = slots_of(body, {0, 0, 0}, {0, 8, 2});
  const auto found = reactions(body, {slots_of(body, {10, 0, 0}, {10, 8, 2}), start}, start, holds);
  const double chains = 27 * stiffness(0, 51) / 10;
  EXPECT_NEAR(force_mn(found[0], 0), -chains * kSpacing.x, 1e-3 * chains);
  EXPECT_NEAR(force_mn(found[0], 2), chains * kSpacing.z / 2, 1e-3 * chains);
  EXPECT_NEAR(force_mn(found[1], 0), chains * kSpacing.x, 1e-3 * chains);
}

TEST(UnitReaction, WhatALinkAtItsLimitCarriesCounts) {
  // The soft last link ends at 1.2 lengths; the stiff others must take the rest.
  MaterialTable table = wide_table();
  table.max_length.keys = {{0, 1.2}, {127, 1.2}, {128, 3}, {255, 3}};
  table.stiffness = Curve{{{0, 1}, {127, 1}, {128, 40}, {255, 40}}};
  Block block = full_block({11, 1, 1}, table, [](int i, int, int) { return i == 10 ? 0 : 255.0; });
  Row row(body_of(block), 11, {3 * kVoxel, 0, 0});
  row.relax_fully();
  // 2.8 mm over 9 links of 40 N/m and the mean density's one, which counts as soft.
  const double expected = 2.8 * 40 / 9;
  EXPECT_NEAR(row.body.offset({9, 0, 0}, 0) / kFixedOne, 2.8, 1e-3);
  EXPECT_NEAR(force_mn(row.ends()[0], 0), -expected, 1e-3 * expected);
  EXPECT_NEAR(force_mn(row.ends()[1], 0), expected, 1e-3 * expected);
  EXPECT_FALSE(any_taut(row.ends()[0]));
}

TEST(PropertyReaction, AfterADragAloneItIsTheSlopeOfTheEnergyAlongTheDrag) {
  std::mt19937 random(11);
  int compared = 0, transmitted = 0;
  for (int n = 0; n < 1500; ++n) {
    Block block = random_block(random, {10, 9, 8});
    if (n % 3 == 0) cut_randomly(random, block);
    if (n % 2 == 0)
      block.table.stiffness = Curve{{{block.table.domain_lo, 1}, {block.table.domain_hi, 30}}};
    Body body = body_of(block);
    const Vec3i voxel = block.voxel(random_element(random, block));
    const auto c = std::size_t(random() % 3);
    std::array<std::int32_t, 3> by{}, further{};
    by[c] = std::int32_t(random() % (6u * kVoxel)) - 3 * kVoxel;
    further[c] = by[c] < 0 ? -8 : 8;
    Holds holds;
    drag(body, {{voxel, by}}, {}, holds);
    if (has_nearly_tight(body)) continue;
    const Reaction found = reactions(body, {slots_of(body, voxel)}, {}, holds)[0];
    const double before = spring_energy(body);
    drag(body, {{voxel, further}}, {});
    const double way = further[c] / kFixedOne * block.spacing_mm[int(c)];
    const double slope = (spring_energy(body) - before) / way;
    EXPECT_NEAR(force_mn(found, int(c)), -slope, 1e-3 * std::abs(slope) + 1e-5) << n;
    EXPECT_FALSE(any_taut(found));
    ++compared;
    transmitted += body.q[c].stored_bricks() > 0 && slope != 0;
  }
  EXPECT_GT(compared, 500);
  EXPECT_GT(transmitted, 300);
}
