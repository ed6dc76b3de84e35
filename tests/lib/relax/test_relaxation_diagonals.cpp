// Relaxation of bodies with diagonal links: valid and downhill after every pass, and the same in
// all directions.
#include <cmath>

#include <gtest/gtest.h>

#include "lib/body/slot_set.h"
#include "lib/chainmail/ecm.h"
#include "lib/relax/link_table.h"
#include "lib/relax/reaction.h"
#include "tests/lib/brute_force.h"
#include "tests/lib/relaxed_bodies.h"
#include "tests/support/sanitized.h"

using namespace supple;
using namespace supple::test;

namespace {

constexpr RelaxMethod kMethodsOfAllLinks[] = {RelaxMethod::jacobi, RelaxMethod::red_black,
                                              RelaxMethod::accelerated};

RelaxParams passes_of(RelaxMethod method, int passes) {
  RelaxParams params;
  params.method = method;
  params.passes = passes;
  return params;
}

/// A cube of one tissue with hardly any limits.
Block free_cube(int size, int links) {
  Block block = homogeneous({size, size, size}, 100, 0.001, 100);
  block.table.links = links;
  return block;
}

/// Offset of a voxel in coordinate i, in voxels.
double at(const Body& body, const Vec3i& voxel) {
  return body.offset(voxel, 0) / kFixedOne;
}

}  // namespace

TEST(PropertyRelaxation, WithDiagonalsEveryPassLeavesAValidBodyOfNoMoreEnergy) {
  LEFT_OUT_WHEN_SANITIZED();
  std::mt19937 random(3);
  std::int64_t moved = 0;
  for (int n = 0; n < cases(24); ++n) {
    const Dragged before = dragged(random, {19, 11, 9}, n % 2 ? 26 : 18);
    for (const RelaxMethod method : kMethodsOfAllLinks) {
      Dragged start = before;
      const int passes = method == RelaxMethod::accelerated ? 50 : 10;
      Relaxation relaxation = relaxation_of(start, passes_of(method, passes));
      double energy = HUGE_VAL;
      for (int pass = 0; pass < passes; ++pass) {
        const double exact = pass % 5 == 0 ? relaxation.energy() : -1;
        moved += relaxation.pass() > 0;
        ASSERT_LE(relaxation.energy_before_pass(), energy * (1 + 1e-12)) << name_of(method);
        energy = relaxation.energy_before_pass();
        // A pass counts every link once, before either end steps.
        if (exact >= 0) {
          ASSERT_NEAR(energy, exact, 1e-9 * exact) << name_of(method);
        }
        relaxation.store();
        ASSERT_EQ(check_links(start.body).violated, 0) << name_of(method) << " pass " << pass;
      }
      EXPECT_LE(relaxation.energy(), energy * (1 + 1e-12)) << name_of(method);
      EXPECT_NEAR(relaxation.energy(), spring_energy(start.body),
                  1e-3 * spring_energy(before.body) + 1e-9);
    }
  }
  EXPECT_GT(moved, cases(500));
}

TEST(PropertyRelaxation, WithDiagonalsWhatIsHeldStays) {
  LEFT_OUT_WHEN_SANITIZED();
  std::mt19937 random(5);
  int at_bound = 0;
  for (int n = 0; n < cases(40); ++n) {
    const Dragged start = dragged(random, {9, 9, 7}, n % 2 ? 26 : 18);
    for (const RelaxMethod method : {RelaxMethod::plain, RelaxMethod::jacobi,
                                     RelaxMethod::red_black, RelaxMethod::accelerated}) {
      at_bound += expect_held_through(start, passes_of(method, 15));
    }
  }
  EXPECT_GT(at_bound, cases(12));
}

TEST(PropertyRelaxation, WithDiagonalsTheResultDoesNotDependOnTheNumberOfThreads) {
  LEFT_OUT_WHEN_SANITIZED();
  std::mt19937 random(7);
  for (int n = 0; n < 4; ++n) {
    const Dragged start = dragged(random, {30, 28, 26}, n % 2 ? 26 : 18);
    for (const RelaxMethod method : kMethodsOfAllLinks) {
      expect_same_on_any_threads(start, passes_of(method, 25));
    }
  }
}

TEST(UnitRelaxation, SpringsOfAllKindsTogetherAreTheContinuum) {
  for (const int links : {6, 18, 26}) {
    for (const Vec3d& h : {Vec3d(1, 1, 1), Vec3d(0.5, 2, 3), Vec3d(1, 1, 40)}) {
      const auto shares = spring_shares(h, links);
      for (int a = 0; a < 3; ++a) {
        for (int b = 0; b < 3; ++b) {
          double sum = 0;
          for (int kind = 0; kind < links / 2; ++kind) {
            const LinkStep step = step_of_direction(kDirectionOfKind[std::size_t(kind)]);
            EXPECT_GT(shares[std::size_t(kind)], 0) << links << " kind " << kind;
            sum += shares[std::size_t(kind)] * step[std::size_t(a)] * h[a] * step[std::size_t(b)] *
                   h[b];
          }
          EXPECT_NEAR(sum, a == b ? h.x * h.y * h.z : 0, 1e-12 * h.x * h.y * h.z) << links;
        }
      }
    }
  }
}

TEST(PropertyRelaxation, ABarWithDiagonalsPullsAsOneThatIsAThirdOfAVoxelThinner) {
  for (const int n : {1, 2, 5}) {
    Block block = homogeneous({13, n, n}, 3, 0.2, 1);
    block.table.links = 26;
    Body body = body_of(block);
    const Region low({0, 0, 0}, {0, n - 1, n - 1}), high({12, 0, 0}, {12, n - 1, n - 1});
    Holds holds;
    drag(body, {{high, {6 * kVoxel, 0, 0}}}, {low}, holds);
    const RelaxReport report = relax(body, {low}, holds, to_rest());
    EXPECT_TRUE(report.converged);
    const double area = (n - 1 / 3.0) * (n - 1 / 3.0);
    EXPECT_NEAR(report.energy_after, 0.5 * area / 12 * 36, 1e-3 * area) << n;
    for (int i = 0; i < 13; ++i) EXPECT_NEAR(at(body, {i, n / 2, 0}), i / 2.0, 1e-3);
  }
}

TEST(PropertyRelaxation, WithDiagonalsAnAffineShapeIsAtRestInside) {
  for (const int links : {18, 26}) {
    Block block = free_cube(11, links);
    block.spacing_mm = {0.7, 1, 2.5};
    Body body = body_of(block);
    const auto affine = [](const Vec3i& v) {
      return std::int32_t((0.125 * v.x - 0.25 * v.y + 0.5 * v.z) * kVoxel);
    };
    std::vector<Slot> rim;
    body.q[0].resize(body.elements.brick_count());
    for_each_element(body.elements, [&](Slot slot) {
      const Vec3i v = voxel_of(body.elements, slot);
      bool inside = true;
      for (int c = 0; c < 3; ++c) inside = inside && v[c] > 0 && v[c] < 10;
      if (!inside) rim.push_back(slot);
      // Inside, far from it.
      body.q[0].set(slot,
                    affine(v) + (inside ? (v.x * 7 + v.y * 5 + v.z * 3) % 5 * kVoxel / 4 : 0));
    });
    Holds holds;
    holds.anchored = SlotSet(std::move(rim));
    EXPECT_TRUE(relax(body, {}, holds, to_rest()).converged);
    for_each_element(body.elements, [&](Slot slot) {
      const Vec3i v = voxel_of(body.elements, slot);
      ASSERT_NEAR(body.q[0].at(slot), affine(v), kVoxel / 1000.0) << links;
    });
  }
}

namespace {

/// Difference of the relaxed offsets two and three voxels beside a single voxel that is held from
/// those of a sphere, 1/r - 1/R: the spread of offset * r over directions, relative to the mean.
double anisotropy(int links) {
  constexpr int kAcross = 33, kCentre = 16;
  Body body = body_of(free_cube(kAcross, links));
  std::vector<Slot> rim;
  for_each_element(body.elements, [&](Slot slot) {
    const Vec3d d(voxel_of(body.elements, slot) - Vec3i(kCentre));
    if (d.length() > 15.5) rim.push_back(slot);
  });
  Holds holds;
  holds.anchored = SlotSet(std::move(rim));
  drag(body, {{Vec3i(kCentre), {kVoxel, 0, 0}}}, {}, holds);
  relax(body, {}, holds, to_rest());
  double least = HUGE_VAL, most = 0;
  for (const Vec3i& d : {Vec3i(3, 0, 0), Vec3i(2, 2, 1), Vec3i(0, 0, -3), Vec3i(-1, 2, 2)}) {
    const double here = at(body, d + Vec3i(kCentre));
    least = std::min(least, here);
    most = std::max(most, here);
  }
  return most / least - 1;
}

}  // namespace

TEST(PropertyRelaxation, WithDiagonalsADimpleIsRound) {
  LEFT_OUT_WHEN_SANITIZED();
  // (3, 0, 0) and (2, 2, 1) are equally far.
  const double six = anisotropy(6), eighteen = anisotropy(18), all = anisotropy(26);
  std::printf(
      "offsets 3 voxels from a handle differ by %.2f %% with 6 links, %.2f %% with 18, "
      "%.2f %% with 26\n",
      100 * six, 100 * eighteen, 100 * all);
  EXPECT_GT(six, 0.04);
  EXPECT_LT(eighteen, 0.01);
  EXPECT_LT(all, 0.01);
}

TEST(PropertyRelaxation, WhatIsStillIsLeftOutAndHardlyMatters) {
  LEFT_OUT_WHEN_SANITIZED();
  constexpr int kAcross = 72;
  const auto relaxed = [](double still_voxels, double& million) {
    Body body = body_of(free_cube(kAcross, 26));
    Holds holds;
    drag(body, {{Region({35, 35, 35}, {37, 37, 37}), {2 * kVoxel, kVoxel, 0}}}, {}, holds);
    RelaxParams params = passes_of(RelaxMethod::accelerated, 10);
    params.still_voxels = still_voxels;
    million = relax(body, {}, holds, params).looked_at_million;
    EXPECT_EQ(check_links(body).violated, 0) << still_voxels;
    return body;
  };
  double all = 0, least = 0;
  const Body exact = relaxed(0, all), loose = relaxed(1e-3, least);
  double worst = 0;
  for_each_element(exact.elements, [&](Slot slot) {
    const Vec3i v = voxel_of(exact.elements, slot);
    worst = std::max(worst, std::abs(at(exact, v) - at(loose, v)));
  });
  EXPECT_LT(least, 0.7 * all);
  EXPECT_GT(worst, 0);
  EXPECT_LT(worst, 5e-3);
}

TEST(PropertyRelaxation, ARigidPartWithDiagonalsMovesAsOne) {
  Block block = t_shape(24);
  block.table.links = 26;
  Body body = body_of(block);
  Holds holds;
  drag(body, {{{23, 12, 0}, {5 * kVoxel, 0, 0}}}, {}, holds);
  const Body before = body;
  relax(body, {}, holds, passes_of(RelaxMethod::accelerated, 40));
  const Vec3i part{15, 8, 0};
  EXPECT_NE(body.offset(part, 0), before.offset(part, 0));
  for (int n = 0; n < block.size(); ++n) {
    if (block.density[std::size_t(n)] == 0) {
      EXPECT_EQ(body.offset(block.voxel(n), 0), body.offset(part, 0));
    }
  }
  EXPECT_EQ(check_links(body).violated, 0);
}

TEST(PropertyRelaxation, WithDiagonalsAPushedHandleIsInBalanceWithItsForce) {
  // The force on a handle is the slope of the least energy, diagonals included.
  const auto pulled = [](std::int32_t by, double& energy) {
    Block block = homogeneous({14, 7, 7}, 3, 0.2, 1);
    block.table.links = 26;
    Body body = body_of(block);
    const Region low({0, 0, 0}, {0, 6, 6}), grip({12, 3, 3}, {13, 4, 4});
    Holds holds;
    drag(body, {{grip, {by, 0, 0}}}, {low}, holds);
    energy = relax(body, {low}, holds, to_rest()).energy_after;
    const SlotSet grabbed = elements_of(body, grip, "grab");
    return reactions(body, {grabbed}, elements_of(body, low, "fix"), holds)[0].force_n.x;
  };
  double below, here, above;
  pulled(2 * kVoxel - kVoxel / 16, below);
  const double force_n = pulled(2 * kVoxel, here);
  pulled(2 * kVoxel + kVoxel / 16, above);
  // uJ per mm is mN.
  EXPECT_NEAR(-1000 * force_n, (above - below) * 8, 1e-3 * 1000 * std::abs(force_n));
}

TEST(PropertyRelaxation, DiagonalsThatYieldAreRefused) {
  Block block = homogeneous({5, 5, 5}, 1.5, 0.6, 0.4);
  block.table.links = 26;
  block.table.yield_strain = Curve{{{0, 0.1}}};
  Body body = body_of(block);
  const std::string error = input_error([&] { relax(body, {}, {}, {}); });
  EXPECT_NE(error.find("26 with plastic flow"), std::string::npos) << error;
}
