// XPBD solves its springs to a stated error, or says that it does not.
#include <cmath>

#include <gtest/gtest.h>

#include "lib/springs/implicit_euler.h"
#include "lib/springs/lattice_springs.h"
#include "lib/springs/xpbd.h"
#include "tests/lib/spring_fixtures.h"
#include "tests/lib/test_bodies.h"

using namespace supple;
using namespace supple::test;

namespace {

/// Voxels of soft tissue (lib/material/presets.h) that stand on a held layer, and their weight.
SpringSystem soft_cube(int size) {
  MaterialTable table = constant_table(1.5, 0.6, 0.29);
  table.stiffness = Curve{{{0, 3.25}}};
  table.mass_density = Curve{{{0, 1060}}};
  table.rayleigh_beta_ms = Curve{{{0, 10}}};
  const Body body =
      body_of(full_block({size, size, size}, table, [](int, int, int) { return 200.0; }));
  LatticeSprings springs = make_springs(body, material_springs(body));
  for (int n = 0; n < size * size; ++n) {
    Slot slot = 0;
    EXPECT_TRUE(slot_of(body.elements, {n % size, n / size, 0}, slot));
    hold(springs.system, springs.node_of(slot));
  }
  springs.system.gravity_m_s2 = {0, 0, -9.81};
  return springs.system;
}

double largest_move(const SpringSystem& now, const SpringSystem& before) {
  double largest = 0;
  for (std::size_t n = 0; n < now.node_count(); ++n) {
    largest = std::max(largest, (now.pos_mm[n] - before.pos_mm[n]).length());
  }
  return largest;
}

}  // namespace

TEST(ConvergenceXpbd, ASoftCubeSinksAsFarAsImplicitEulerSays) {
  const SpringSystem rest = soft_cube(6);
  SpringSystem cube = rest, exact = rest, too_soft = rest;
  ImplicitEuler implicit(exact);
  run_steps(implicit, 1e-3, 200);
  const double sag = largest_move(exact, rest);
  EXPECT_GT(sag, 0.03);
  Xpbd xpbd(cube);
  const SpringStepReport report = run_steps(xpbd, 5e-3, 20);
  EXPECT_GT(report.substeps, 20 * 100);
  EXPECT_NEAR(largest_move(cube, rest), sag, 0.03 * sag);
  Xpbd fixed(too_soft, {8, 4});
  EXPECT_EQ(run_steps(fixed, 5e-3, 20).substeps, 20 * 8);
  EXPECT_GT(largest_move(too_soft, rest), 2 * sag);
}

TEST(FaultXpbd, TooFewSubstepsAreRefusedWithTheStepThatWouldDo) {
  SpringSystem cube = soft_cube(4);
  Xpbd xpbd(cube, {0, 4, 100});
  const double most_s = 100 * xpbd.longest_substep_s();
  EXPECT_EQ(xpbd.step(0.999 * most_s).substeps, 100);
  const SpringSystem before = cube;
  const std::string line = input_error([&] { xpbd.step(1.001 * most_s); });
  EXPECT_NE(line.find("at most " + number_text(most_s) + " s"), std::string::npos) << line;
  EXPECT_EQ(cube.pos_mm, before.pos_mm);
}

TEST(UnitXpbd, TheForceOnAHolderIsTheMeanOverTheSubsteps) {
  // A still spring of 300 N/m, drawn out by 2 mm and relaxing: the mean of the substeps' forces,
  // neither the first nor the last.
  SpringSystem whole = oscillator(0.02, 300, 0.4, 10, 2), parts = whole;
  Xpbd one(whole, {4, 4});
  one.step(0.02);
  Xpbd each(parts, {1, 4});
  std::vector<double> pulls;
  double sum = 0;
  for (int n = 0; n < 4; ++n) {
    each.step(0.005);
    pulls.push_back(each.reactions_n()[0].x);
    sum += pulls.back() / 4;
  }
  EXPECT_GT(std::abs(pulls.front() - sum), 0.02);
  EXPECT_GT(std::abs(pulls.back() - sum), 0.02);
  EXPECT_NEAR(one.reactions_n()[0].x, sum, 1e-9);
}

TEST(UnitXpbd, TheDeepestPenetrationOfAStepIsTold) {
  // Nodes fly through two boxes each that overlap by 0.4, 1 and 0.4 mm and are 6 mm long: only the
  // second of four substeps ends in both, where there is no way out.
  SpringSystem system = oscillator(1e-3, 0, 0, 5, 0);
  system.springs.clear();
  system.mass_kg.assign(4, 1e-3);
  system.pos_mm = {{0, 200, 0}, {-12, 100, 0}, {-12, 0, 0}, {-12, -100, 0}};
  system.velocity_mm_s.assign(4, {2400, 0, 0});
  system.held[0].target_mm = system.pos_mm[0];
  const auto add_box = [&](double y, double z) {
    const std::array<Vec3d, 3> half_axes = {Vec3d(3, 0, 0), Vec3d(0, 40, 0), Vec3d(0, 0, 10)};
    system.colliders.push_back({BoxShape{{0, y, z}, half_axes}});
  };
  for (const double y : {100.0, 0.0, -100.0}) {
    for (const double side : {-1.0, 1.0}) add_box(y, side * (y == 0 ? 9.5 : 9.8));
  }
  Xpbd xpbd(system, {4, 4});
  const SpringStepReport report = xpbd.step(0.01);
  EXPECT_NEAR(report.penetration_mm, 1, 1e-9);
  EXPECT_EQ(report.contacts, 3);
}
