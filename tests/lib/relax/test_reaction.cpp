// Forces on handles: springs in series and parallel by hand, and the slope of the energy.
#include <cmath>
#include <optional>

#include <gtest/gtest.h>

#include "lib/body/slot_set.h"
#include "lib/chainmail/ecm.h"
#include "lib/relax/reaction.h"
#include "tests/lib/quadratic_program.h"
#include "tests/lib/relaxed_bodies.h"
#include "tests/support/sanitized.h"
#include "volumes/base/parallel.h"

using namespace supple;
using namespace supple::test;

namespace {

const Vec3d kSpacing(0.5, 1.25, 2);

/// Limits so wide that they do not matter; Young's modulus 1 to 21 kPa.
MaterialTable wide_table() {
  MaterialTable table = constant_table(3, 0.1, 2);
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
  /// Reactions at the last element and at the first.
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

/// True if a link is nearly at its limit, where one step more or less makes a difference.
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
  table.max_length.keys = {{0, 1.2}, {128, 1.2}, {129, 3}, {255, 3}};
  table.stiffness = Curve{{{0, 1}, {128, 1}, {129, 40}, {255, 40}}};
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

TEST(UnitReaction, ALinkIsAtItsLimitFromA4096thVoxelOn) {
  MaterialTable table = wide_table();
  table.stiffness.reset();
  table.max_length.keys = {{0, 1.5}};
  table.min_length.keys = {{0, 0.5}};
  Body body = body_of(full_block({3, 1, 1}, table, [](int, int, int) { return 9.0; }));
  const SlotSet last = slots_of(body, {2, 0, 0}), middle = slots_of(body, {1, 0, 0});
  body.q[0].resize(body.elements.brick_count());
  for (const int side : {-1, 1}) {
    for (const int short_of : {16, 17}) {
      const int inner = 3 * kVoxel / 10, outer = inner + kVoxel / 2 - short_of;
      middle.for_each([&](Slot slot) { body.q[0].set(slot, side * inner); });
      last.for_each([&](Slot slot) { body.q[0].set(slot, side * outer); });
      const auto found = reactions(body, {last}, slots_of(body, {0, 0, 0}), {last, {}, {}});
      // 1 N/m each: the inner link's 0.3 mN, or the outer one's 0.5 mN.
      EXPECT_NEAR(force_mn(found[0], 0), -side * (short_of == 16 ? 0.3 : 0.5), 1e-3);
    }
  }
}

TEST(PropertyReaction, AfterADragAloneItIsTheSlopeOfTheEnergyAlongTheDrag) {
  LEFT_OUT_WHEN_SANITIZED();
  std::mt19937 random(11);
  int compared = 0, pulling = 0;
  for (int n = 0; n < cases(900); ++n) {
    Block block = random_block(random, {10, 9, 8});
    if (n % 3 == 0) cut_randomly(random, block);
    if (n % 2 == 0)
      block.table.stiffness = Curve{{{block.table.domain_lo, 1}, {block.table.domain_hi, 30}}};
    Body body = body_of(block);
    const Vec3i voxel = block.voxel(random_element(random, block));
    const auto c = std::size_t(random() % 3);
    const auto random_way = [&] {
      std::array<std::int32_t, 3> by{};
      by[c] = std::int32_t(random() % (6u * kVoxel)) - 3 * kVoxel;
      return by;
    };
    // Earlier drags of the same element or another leave links at the other limit.
    for (int earlier = n % 4; earlier > 0; --earlier) {
      const Vec3i other = block.voxel(random_element(random, block));
      drag(body, {{earlier % 2 == 0 ? voxel : other, random_way()}}, {});
    }
    const std::array<std::int32_t, 3> by = random_way();
    std::array<std::int32_t, 3> further{};
    further[c] = by[c] < 0 ? -8 : 8;
    Holds holds;
    drag(body, {{voxel, by}}, {}, holds);
    if (has_nearly_tight(body)) continue;
    const Reaction found = reactions(body, {slots_of(body, voxel)}, {}, holds)[0];
    double energies[3];
    for (double& energy : energies) {
      energy = spring_energy(body);
      drag(body, {{voxel, further}}, {});
    }
    // While the same elements come along, the energy is a parabola.
    const double way = further[c] / kFixedOne * block.spacing_mm[int(c)];
    const double slope = (4 * energies[1] - energies[2] - 3 * energies[0]) / (2 * way);
    EXPECT_NEAR(force_mn(found, int(c)), -slope, 1e-5 * std::abs(slope) + 1e-5) << n;
    EXPECT_FALSE(any_taut(found));
    ++compared;
    pulling += slope != 0;
  }
  EXPECT_GT(compared, cases(400));
  EXPECT_GT(pulling, cases(225));
}

TEST(PropertyReaction, AtTheMinimumItIsTheSlopeOfTheLeastEnergy) {
  LEFT_OUT_WHEN_SANITIZED();
  std::mt19937 random(23);
  int compared = 0, leaning = 0, taut = 0;
  for (int n = 0; n < cases(45); ++n) {
    Block block = random_block(random, {12, 9, 5});
    block.table.stiffness = Curve{{{block.table.domain_lo, 1}, {block.table.domain_hi, 5}}};
    Body body = body_of(block);
    std::array<SlotSet, 2> holders;
    Holds holds;
    for (SlotSet& holder : holders) {
      const Vec3i voxel = block.voxel(random_element(random, block));
      const auto by = std::int32_t(random() % (2u * kVoxel)) - kVoxel;
      drag(body, {{voxel, {by, 0, 0}}}, {}, holds);
      holder = slots_of(body, voxel);
    }
    if (body.q[0].empty() || holds.anchored.size() != 2) continue;
    QuadraticProgram program(body, 0, holds.anchored);
    double excess, excess_below, excess_above;
    program.minimise(1500, excess);
    ASSERT_LT(excess, 1e-5);
    QuadraticProgram below = program, above = program;
    Slot slot = 0;
    holders[0].for_each([&](Slot element) { slot = element; });
    below.shift(slot, -1.0 / 256);
    above.shift(slot, 1.0 / 256);
    const double slope =
        -(below.minimise(1500, excess_below) - above.minimise(1500, excess_above)) * 128 *
        block.spacing_mm.x;

    for_each_element(body.elements, [&](Slot element) {
      const double offset = program.offsets()[element] * kVoxel;
      body.q[0].set(element, std::int32_t(std::lround(offset)));
    });
    const auto found = reactions(body, {holders[0], holders[1]}, {}, holds);
    const double force = force_mn(found[0], 0);
    EXPECT_NEAR(force_mn(found[1], 0), -force, 1e-3 * std::abs(force) + 1e-3) << n;
    if (std::max(excess_below, excess_above) > 1e-5) {
      // There is no room in one direction.
      EXPECT_TRUE(found[0].taut[0] && found[1].taut[0]);
      ++taut;
      continue;
    }
    EXPECT_FALSE(any_taut(found[0]) || any_taut(found[1]));
    EXPECT_NEAR(force, -slope, 1e-3 * std::abs(slope) + 1e-3) << n;
    if (std::abs(slope) < 1e-2) continue;
    ++compared;
    // Counts cases where the handle's own springs alone would be far from that.
    body.q[0].set(slot, body.q[0].at(slot) + 1);
    const double further = spring_energy(body);
    body.q[0].set(slot, body.q[0].at(slot) - 2);
    const double own = (further - spring_energy(body)) / 2 * kVoxel / block.spacing_mm.x;
    leaning += std::abs(own - slope) > 0.05 * std::abs(slope);
  }
  EXPECT_GE(compared, cases(15));
  EXPECT_GE(leaning, cases(8));
  EXPECT_GE(taut, cases(8));
}

TEST(PropertyReaction, AfterRelaxationTheForcesOfAllHoldersBalance) {
  const auto noise = [](int i, int j, int k) { return double((i * 37 + j * 91 + k * 53) % 256); };
  for (const double kpa : {0.0, 10.0}) {
    // Cells keep their volume where limits leave them room.
    Block block = kpa > 0 ? wide_block({14, 10, 9}, noise)
                          : full_block({14, 10, 9}, linear_table(1.5, 0.6, 0.7), noise);
    Body body = body_of(block);
    const Region wall({0, 0, 0}, {0, 9, 8});
    const SlotSet all_of_wall = slots_of(body, {0, 0, 0}, {0, 9, 8});
    const std::vector<SlotSet> holders = {slots_of(body, {11, 5, 4}), all_of_wall};
    Holds holds;
    drag(body, {{{11, 5, 4}, {kVoxel, -kVoxel / 2, 0}}}, {wall}, holds);
    const auto dragged_only = reactions(body, holders, all_of_wall, holds, {kpa, {}});
    relax(body, {wall}, holds, to_rest(kpa));
    const auto found = reactions(body, holders, all_of_wall, holds, {kpa, {}});
    for (int c = 0; c < 2; ++c) {
      const double force = force_mn(found[0], c);
      // Nothing had come to the wall before.
      EXPECT_NEAR(force_mn(dragged_only[1], c), 0, 1e-9);
      EXPECT_LT(std::abs(force), std::abs(force_mn(dragged_only[0], c)));
      EXPECT_GT(std::abs(force), 0.1);
      EXPECT_NEAR(force_mn(found[1], c), -force, 1e-2 * std::abs(force)) << kpa;
    }
    EXPECT_FALSE(any_taut(found[0]));
  }
}

TEST(PropertyReaction, OfSpringsAndCellsItIsTheSlopeOfTheirEnergy) {
  // Limits so wide that nothing leans; springs yield and rest elsewhere, links are cut.
  std::mt19937 random(29);
  const auto within = [&](std::int32_t most) {
    return std::int32_t(random() % unsigned(2 * most)) - most;
  };
  for (int n = 0; n < cases(60); ++n) {
    Block block =
        wide_block({4 + n % 9, 5, 12}, [&](int, int, int) { return double(random() % 256); });
    if (n % 2 == 0) cut_randomly(random, block);
    if (n % 3 == 0) block.table.yield_strain = Curve{{{0, 0.1}}};
    block.table.stiffness = Curve{{{0, 1}, {255, 6}}};
    block.table.poisson = Curve{{{0, 0.49}, {255, 0.1}}};
    Body body = body_of(block);
    // Bulk moduli: none, after the material, or the same for all.
    std::optional<double> kpa = 0;
    if (n % 4 != 0) kpa = n % 4 == 2 ? std::nullopt : std::optional<double>(40);
    const CellModuli moduli = kpa ? CellModuli{*kpa, {}} : moduli_by_poisson(body);
    for_each_element(body.elements, [&](Slot slot) {
      // Not all coordinates move in all bodies, and not all bricks.
      if (n % 4 == 1 && voxel_of(body.elements, slot).z < 8) return;
      for (std::size_t c = 0; c < 3; ++c) {
        if (n >> c & 1 || n % 5 == 0) {
          body.q[c].resize(body.elements.brick_count());
          body.q[c].set(slot, within(kVoxel / 20));
        }
        if (n % 3 != 0) continue;
        for (auto& axis : body.rest) {
          axis[c].resize(body.elements.brick_count());
          axis[c].set(slot, within(kVoxel / 10));
        }
      }
    });
    // An oblique, sheared grid of the same spacing.
    std::array<Vec3d, 3> axes = {Vec3d(0.8, 0.6, 0), Vec3d(0.1, 1, 0.2), Vec3d(-0.3, 0.2, -1)};
    for (int c = 0; c < 3; ++c) axes[std::size_t(c)] *= kSpacing[c] / axes[std::size_t(c)].length();
    body.geometry = Geometry(body.geometry.dims(), Vec3d(0), axes);

    const Vec3i lo = block.voxel(random_element(random, block));
    const SlotSet handle = slots_of(body, lo, lo + Vec3i(2, 1, int(random() % 9)));
    const Reaction found = reactions(body, {handle}, handle, {}, moduli)[0];
    EXPECT_FALSE(any_taut(found));
    for (int c = 0; c < 3; ++c) {
      BrickValues& q = body.q[std::size_t(c)];
      q.resize(body.elements.brick_count());
      const auto energy_at = [&](std::int32_t way) {
        handle.for_each([&](Slot slot) { q.set(slot, q.at(slot) + way); });
        const double energy = spring_energy(body) + cell_energy(body, kpa);
        handle.for_each([&](Slot slot) { q.set(slot, q.at(slot) - way); });
        return energy;
      };
      const double slope = (energy_at(4) - energy_at(-4)) / 8 * kVoxel / kSpacing[c];
      const double along_axis = found.force_n.dot(axes[std::size_t(c)].normalized()) * 1000;
      EXPECT_NEAR(along_axis, -slope, 1e-5 * std::abs(slope) + 1e-4) << n << " " << c;
    }
  }
}

TEST(UnitReaction, OnAShearedGridItsWorkIsTheEnergys) {
  Row row(body_of(wide_block({6, 1, 1}, [](int, int, int) { return 51.0; })), 6, {kVoxel, 0, 0});
  row.relax_fully();
  row.body.geometry =
      Geometry({64, 64, 64}, {0, 0, 0},
               {Vec3d(kSpacing.x, 0, 0), Vec3d(0.6, 0.8, 0) * kSpacing.y, Vec3d(0, 0, kSpacing.z)});
  // Work on a way along j is none, so the force is perpendicular to j.
  const double along_i = stiffness(0, 51) / 5 * kSpacing.x / 1000;
  const Vec3d found = row.ends()[0].force_n;
  EXPECT_NEAR(found.x, -along_i, 1e-3 * along_i);
  EXPECT_NEAR(found.y, 0.75 * along_i, 1e-3 * along_i);
  EXPECT_NEAR(found.z, 0, 1e-12);
}

TEST(UnitReaction, AHandleOnARigidPartBearsAllThatPullsAtIt) {
  for (const int grabbed : {15, 17, 19}) {
    Body body = body_of(full_block({20, 1, 1}, linear_table(2, 0.3, 0.7),
                                   [](int i, int, int) { return i < 15 ? 255.0 : 0.0; }));
    const Region first({0, 0, 0});
    Holds holds;
    drag(body, {{{grabbed, 0, 0}, {2 * kVoxel, 0, 0}}}, {first}, holds);
    relax(body, {first}, holds, to_rest());
    const auto found =
        reactions(body, {slots_of(body, {grabbed, 0, 0})}, slots_of(body, {0, 0, 0}), holds);
    EXPECT_NEAR(force_mn(found[0], 0), -2.0 / 15, 1e-4);  // 15 links of 1 N/m
    EXPECT_FALSE(found[0].taut[0]);
  }
}

TEST(UnitReaction, ASpringThatYieldsPullsNoMore) {
  MaterialTable table = wide_table();
  table.stiffness.reset();
  table.yield_strain = Curve{{{0, 0.1}}};
  const Body rest = body_of(full_block({21, 1, 1}, table, [](int, int, int) { return 9.0; }));
  for (const double by : {1.0, 2.0, 3.0, 6.0}) {
    Row row(rest, 21, {std::int32_t(by * kVoxel), 0, 0});
    row.relax_fully();
    EXPECT_NEAR(force_mn(row.ends()[0], 0), -std::min(by / 20, 0.1), 1e-4) << by;
    EXPECT_NEAR(force_mn(row.ends()[1], 0), std::min(by / 20, 0.1), 1e-4) << by;
  }
}

TEST(UnitReaction, ACutTransmitsNothing) {
  for (const double density : {0.0, 255.0}) {
    Block block =
        full_block({10, 1, 1}, linear_table(2, 0.3, 0.7), [&](int, int, int) { return density; });
    block.cut.assign(10, 0);
    block.cut[4] = 1;
    Row row(body_of(block), 10, {2 * kVoxel, 0, 0});
    row.relax_fully();
    for (const Reaction& end : row.ends()) {
      EXPECT_NEAR(force_mn(end, 0), 0, 1e-4);
      EXPECT_FALSE(any_taut(end));
    }
  }
}

TEST(UnitReaction, WhatIsTautLeansOnTheNearestHolder) {
  // Four or five elements, all links at 1.5 lengths after the drag; k = 1, 2, 3, 4 N/m.
  for (const int count : {4, 5}) {
    MaterialTable table = wide_table();
    table.max_length.keys = {{0, 1.5}};
    table.stiffness = Curve{{{0, 0.5}, {4, 4.5}}};
    Row row(body_of(full_block({count, 1, 1}, table, [](int i, int, int) { return double(i); })),
            count, {3 * kVoxel, 0, 0});
    const SlotSet first = slots_of(row.body, {0, 0, 0}), last = slots_of(row.body, row.last);
    const auto at_last = reactions(row.body, {last}, first, row.holds);
    const auto forwards = reactions(row.body, {first, last}, first, row.holds);
    const auto backwards = reactions(row.body, {last, first}, first, row.holds);
    // The middle one of five goes to the first in the list, a handle before others.
    const double k_first = count == 4 ? 2 : 3, k_last = 2;
    EXPECT_NEAR(force_mn(forwards[0], 0), k_first / 2, 1e-4);
    EXPECT_NEAR(force_mn(forwards[1], 0), -k_first / 2, 1e-4);
    EXPECT_NEAR(force_mn(backwards[0], 0), -k_last / 2, 1e-4);
    EXPECT_NEAR(force_mn(backwards[1], 0), k_last / 2, 1e-4);
    EXPECT_NEAR(force_mn(at_last[0], 0), -k_last / 2, 1e-4);
    for (const auto& found : {at_last, forwards, backwards}) {
      for (const Reaction& reaction : found) {
        EXPECT_EQ(reaction.taut, (std::array<bool, 3>{true, false, false}));
      }
    }
  }
}

TEST(UnitReaction, OthersThatAreHeldBearTheirPart) {
  Body body = body_of(wide_block({13, 1, 1}, [](int, int, int) { return 51.0; }));
  const std::vector<Region> fixed = {Region({0, 0, 0})};
  Holds holds;
  drag(body, {{{4, 0, 0}, {kVoxel, 0, 0}}}, fixed, holds);
  drag(body, {{{12, 0, 0}, {3 * kVoxel, 0, 0}}}, fixed, holds);
  relax(body, fixed, holds, to_rest());
  const SlotSet first = slots_of(body, {0, 0, 0}), last = slots_of(body, {12, 0, 0});
  const auto found = reactions(body, {first, last, last}, first, holds);
  const double k = stiffness(0, 51) * kSpacing.x;
  EXPECT_NEAR(force_mn(found[0], 0), k / 4, 1e-3 * k);
  EXPECT_NEAR(force_mn(found[1], 0), -k * 2 / 8, 1e-3 * k);
  // What an earlier handle of the list has is not counted twice.
  EXPECT_EQ(found[2].force_n, Vec3d(0));
}

TEST(UnitReaction, APushHandleFeelsWhatLiesAtItsBound) {
  const Body at_rest = body_of(wide_block({13, 1, 1}, [](int, int, int) { return 51.0; }));
  const std::vector<Region> fixed = {Region({0, 0, 0})};
  const SlotSet first = slots_of(at_rest, {0, 0, 0}), tool = slots_of(at_rest, {12, 0, 0});
  const SlotSet grabbed = slots_of(at_rest, {11, 0, 0});
  const double k = stiffness(0, 51) * kSpacing.x;
  for (const int side : {-1, 1}) {
    Body body = at_rest;
    Holds holds;
    drag(body, {{{12, 0, 0}, {side * 2 * kVoxel, 0, 0}, HandleKind::push}}, fixed, holds);
    relax(body, fixed, holds, to_rest());
    const auto alone = reactions(body, {tool}, first, holds);
    EXPECT_NEAR(force_mn(alone[0], 0), -side * k * 2 / 12, 1e-3 * k);
    // Across, it asks for nothing, and its element leans on the one that is pulled; along, it asks
    // for nothing any more when that takes the element further.
    drag(body, {{{11, 0, 0}, {side * 5 * kVoxel, 3 * kVoxel, 0}}}, fixed, holds);
    ASSERT_GT(side * body.offset({12, 0, 0}, 0), 2 * kVoxel);
    ASSERT_GT(body.offset({12, 0, 0}, 1), 0);
    const auto found = reactions(body, {tool, grabbed}, first, holds);
    EXPECT_EQ(found[0].force_n, Vec3d(0));
    EXPECT_EQ(found[1].force_n, reactions(body, {grabbed}, first, holds)[0].force_n);
    EXPECT_LT(force_mn(found[1], 1), 0);
  }
}

TEST(PropertyReaction, ABodyAtRestPullsAtNothing) {
  std::mt19937 random(31);
  for (int n = 0; n < 20; ++n) {
    // There are rigid parts, too, of which nothing is taut as long as nobody pulls.
    const Block block = random_block(random, {5, 5, 5});
    const Body body = body_of(block);
    const SlotSet handle = slots_of(body, block.voxel(random_element(random, block)));
    const SlotSet anchor = slots_of(body, block.voxel(random_element(random, block)));
    for (const double kpa : {0.0, 10.0}) {
      const Reaction found = reactions(body, {handle}, anchor, {handle, {}, {}}, {kpa, {}})[0];
      EXPECT_EQ(found.force_n, Vec3d(0));
      EXPECT_FALSE(any_taut(found));
    }
  }
}

TEST(ExtremesReaction, ALinkWithoutLimitIsNeverTaut) {
  MaterialTable table = wide_table();
  table.max_length.keys = {{0, 1e6}};
  Body body = body_of(full_block({2, 1, 1}, table, [](int, int, int) { return 51.0; }));
  const SlotSet first = slots_of(body, {0, 0, 0}), last = slots_of(body, {1, 0, 0});
  body.q[0].resize(body.elements.brick_count());
  body.q[0].set(0, -kMaxOffset);
  last.for_each([&](Slot slot) { body.q[0].set(slot, kMaxOffset); });
  const auto found = reactions(body, {first, last}, first, {last, {}, {}});
  EXPECT_FALSE(any_taut(found[0]));
  // 5 kPa mm^2 / mm over almost 32768 voxels of a millimetre.
  EXPECT_NEAR(found[0].force_n.x, 5 * 32.768, 1e-2);
  EXPECT_EQ(found[1].force_n.x, -found[0].force_n.x);
}

TEST(PropertyReaction, TheResultDoesNotDependOnTheNumberOfThreads) {
  std::mt19937 random(37);
  for (int n = 0; n < cases(10); ++n) {
    const Dragged start = dragged(random, {30, 28, 26});
    std::vector<SlotSet> handles;
    start.holds.anchored.for_each(
        [&](Slot slot) { handles.push_back(SlotSet(std::vector<Slot>{slot})); });
    const SlotSet anchored = anchored_elements(start.body, start.anchors, start.holds);
    const auto found = [&] {
      return reactions(start.body, handles, anchored, start.holds, {20, {}});
    };
    const auto one = on_threads(1, found), many = on_threads(4, found);
    for (std::size_t handle = 0; handle < handles.size(); ++handle) {
      EXPECT_EQ(one[handle].force_n, many[handle].force_n);
      EXPECT_EQ(one[handle].taut, many[handle].taut);
    }
  }
}

TEST(UnitReaction, ABadBulkModulusIsAnError) {
  const Body body = body_of(wide_block({2, 1, 1}, [](int, int, int) { return 51.0; }));
  for (const double kpa : {-1.0, 2e9, std::nan("")}) {
    const std::string message = input_error([&] { reactions(body, {}, {}, {}, {kpa, {}}); });
    EXPECT_NE(message.find("bulk_modulus"), std::string::npos) << message;
  }
}
