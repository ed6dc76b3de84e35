// The guard of symplectic Euler against energy from nothing.
#include <cmath>

#include <gtest/gtest.h>

#include "lib/springs/lattice_springs.h"
#include "lib/springs/mesh_springs.h"
#include "lib/springs/symplectic_euler.h"
#include "tests/lib/spring_fixtures.h"
#include "tests/lib/test_bodies.h"
#include "tests/support/sanitized.h"

using namespace supple;
using namespace supple::test;

namespace {

SymplecticEuler::Params gaining_at_most(double part) {
  SymplecticEuler::Params params;
  params.most_gain = part;
  return params;
}

/// 6^3 voxels of 0.5 mm and 10 kPa, a face held, one corner drawn away by 4 voxels.
SpringSystem cube_with_a_drawn_corner() {
  MaterialTable table = linear_table(1.5, 0.6, 0.7);
  table.stiffness = Curve{{{0, 10}}};
  Block block = full_block({6, 6, 6}, table, [](int, int, int) { return 255.0; });
  block.spacing_mm = {0.5, 0.5, 0.5};
  const Body body = body_of(block);
  LatticeSprings springs = make_springs(body, material_springs(body));
  springs.system.barrier = {};  // which stops some of it before
  const auto node = [&](const Vec3i& voxel) {
    Slot slot = 0;
    EXPECT_TRUE(slot_of(body.elements, voxel, slot));
    return springs.node_of(slot);
  };
  for (int n = 0; n < 36; ++n) hold(springs.system, node({0, n / 6, n % 6}));
  springs.system.pos_mm[node({5, 5, 5})] += Vec3d(2, 1, 0);
  return springs.system;
}

struct Motion {
  double energy_ratio = 0;
  SpringStepReport report;
};

Motion let_go(const SymplecticEuler::Params& params, int steps) {
  SpringSystem system = cube_with_a_drawn_corner();
  const double start = energy(system).total_j();
  SymplecticEuler integrator(system, params);
  Motion motion;
  motion.report = run_steps(integrator, 0.01, steps);
  motion.energy_ratio = energy(system).total_j() / start;
  return motion;
}

/// Ten masses on a line, which is a linear system as long as none passes another.
SpringSystem line() {
  SpringSystem system = chain(10, 1e-3, 50, 4);
  hold(system, 0);
  system.gravity_m_s2 = {3, 0, 0};
  for (int n = 1; n < 10; ++n) system.velocity_mm_s[n].x = n % 2 == 0 ? 9 : -5;
  return system;
}

}  // namespace

TEST(ExtremesEnergyGuard, ACubeLetGoFromAFarDrawnCornerDoesNotBlowUp) {
  LEFT_OUT_WHEN_SANITIZED();
  const Motion unguarded = let_go(gaining_at_most(HUGE_VAL), 300);
  EXPECT_GT(unguarded.energy_ratio, 50);
  EXPECT_EQ(unguarded.report.halvings, 0);
  const Motion guarded = let_go({}, 300);
  EXPECT_GT(guarded.report.halvings, 0);
  EXPECT_GT(guarded.report.substeps, unguarded.report.substeps);
  EXPECT_NEAR(guarded.energy_ratio, 1, 0.25);
}

TEST(PropertyEnergyGuard, WorkOfHoldersAndShapesIsNoEnergyFromNothing) {
  // Exact for a linear system, right up to the limit of stability: no gain but rounding.
  for (const double damping : {0.0, 0.01}) {
    SpringSystem system = line();
    for (Spring& s : system.springs) s.damping_n_s_m = damping;
    system.mass_damping_per_s = 20 * damping;
    system.colliders = {{PlaneShape{{37, 0, 0}, {-1, 0, 0}}}};
    SymplecticEuler integrator(system, gaining_at_most(1e-9));
    SpringStepReport report;
    for (int n = 0; n < 100; ++n) {
      drive(system, 0, {2 * std::sin(0.2 * n), 0, 0});
      system.colliders[0].shape = PlaneShape{{37 - 0.02 * n, 0, 0}, {-1, 0, 0}};
      system.colliders[0].velocity_mm_s = {-0.02 / 0.02, 0, 0};
      report += integrator.step(0.02);
    }
    EXPECT_EQ(report.halvings, 0) << damping;
    EXPECT_GT(report.contacts, 20);
    EXPECT_GE(report.substeps, 500);
  }
}

TEST(PropertyEnergyGuard, ASheetThatFallsSwingsAndIsDampedKeepsItsSubstep) {
  for (const double damping : {0.0, 1e-4}) {
    MeshSpringParams params;
    params.bending_n_m = 5;
    params.damping_n_s_m = damping;
    SpringSystem system = make_springs(make_mesh_body(sheet(9, 9, 1)), params);
    system.gravity_m_s2 = {0, 0, -9.81};
    hold(system, 0);
    hold(system, 8);
    SymplecticEuler integrator(system);
    const SpringStepReport report = run_steps(integrator, 0.01, 30);
    EXPECT_EQ(report.halvings, 0) << damping;
  }
}

TEST(PropertyEnergyGuard, ABodyAtRestStaysSo) {
  Block block =
      full_block({6, 6, 6}, linear_table(1.5, 0.6, 0.7), [](int, int, int) { return 9.; });
  block.origin = {1000, 1000, 1000};
  block.spacing_mm = {0.7, 0.7, 0.7};
  SpringSystem system = make_springs(body_of(block), LatticeSpringParams()).system;
  hold(system, 0);
  SymplecticEuler integrator(system);
  const SpringStepReport report = run_steps(integrator, 0.01, 20);
  EXPECT_EQ(report.halvings, 0);
}

TEST(FaultEnergyGuard, WithoutShorterSubstepsItStopsWithItsOwnLineAndTheLastState) {
  SymplecticEuler::Params params;
  params.max_substeps = 150;
  SpringSystem system = cube_with_a_drawn_corner();
  SymplecticEuler integrator(system, params);
  std::vector<Vec3d> pos, velocity;
  std::string line;
  for (int n = 0; n < 300 && line.empty(); ++n) {
    pos = system.pos_mm;
    velocity = system.velocity_mm_s;
    try {
      integrator.step(0.01);
    } catch (const InputError& error) {
      FAIL() << error.what();
    } catch (const Error& error) {
      line = error.what();
    }
  }
  EXPECT_NE(line.find("found energy that grows from nothing"), std::string::npos) << line;
  EXPECT_EQ(system.pos_mm, pos);
  EXPECT_EQ(system.velocity_mm_s, velocity);
}
