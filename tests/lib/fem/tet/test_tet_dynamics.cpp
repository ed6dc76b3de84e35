// Modes and motion of tetrahedra and sheets against formulas and laws.
#include <cmath>

#include <gtest/gtest.h>

#include "lib/fem/dynamics/modes.h"
#include "lib/fem/dynamics/newmark.h"
#include "tests/lib/fem/tet/tet_fixtures.h"
#include "volumes/base/units.h"

using namespace supple;
using namespace supple::test;

namespace {

constexpr double kDensity = 1040;  // kg/m³

MassDensities all_of(double density) {
  MassDensities out;
  out.fill(density);
  return out;
}

/// What lets a bar move along x alone, with its end at x = 0 held.
TetLoads bar_in_its_walls(const TetModel& model) {
  TetLoads loads;
  loads.held.push_back(held_where(model, [](const Vec3d& x) { return x.x == 0; }));
  loads.held.push_back(held_where(model, [](const Vec3d&) { return true; }));
  loads.held.back().components = 6;
  return loads;
}

}  // namespace

// f = c / 4 L with c^2 = (lambda + 2 mu) / rho; kPa / (kg / m^3) is 1e9 mm^2 / s^2.
TEST(UnitTetDynamics, ABarHasTheModesOfAWaveInIt) {
  for (const TetElement element : kTetElements) {
    SolidMesh mesh = tet_block(Vec3i(12, 1, 1), Vec3d(60, 5, 5));
    set_material(mesh, 6, 0.3);
    const TetModel model(mesh, element);
    const TetModuli& moduli = model.moduli()[0];
    const double speed = std::sqrt((moduli.lambda_kpa() + 2 * moduli.shear_kpa) / kDensity * 1e9);
    ModeParams params;
    params.count = 2;
    const VibrationModes found = lowest_modes(
        model, all_of(kDensity), model.nodal_loads(bar_in_its_walls(model)).held, params);
    const double allowed = element == TetElement::quadratic ? 1e-4 : 0.02;
    EXPECT_NEAR(found.modes[0].frequency_hz / (speed / 240), 1, allowed / 2);
    EXPECT_NEAR(found.modes[1].frequency_hz / (speed / 80), 1, 2 * allowed);
    EXPECT_NEAR(found.report.mass_kg, kDensity * 60 * 5 * 5 * 1e-9, 1e-15);
  }
}

TEST(PropertyTetDynamics, AFreeBodyWithSheetsHasSixRigidMotionsAndTheSameModesWhereverItLies) {
  const ElasticSheet dura{"z+", SheetKind::both, 900, 0.48, 0.6};
  std::vector<double> before;
  for (const double turned : {0.0, 0.7}) {
    SolidMesh mesh = tet_block(Vec3i(3, 2, 2), Vec3d(30, 20, 18), 0.2);
    for (Vec3d& x : mesh.nodes_lps_mm) {
      x = Vec3d(std::cos(turned) * x.x - std::sin(turned) * x.y + 40 * turned,
                std::sin(turned) * x.x + std::cos(turned) * x.y, x.z - 5);
    }
    const TetModel model(mesh, TetElement::nodal_pressure, {dura});
    ASSERT_NE(model.shells().edges().size() % 3, 0u);  // a node has components that are nothing
    const VibrationModes found = lowest_modes(model, all_of(kDensity), model.nodal_loads({}).held);
    EXPECT_EQ(found.report.rigid_modes, 6);
    EXPECT_LE(found.report.orthogonality, 1e-6);
    // Mass of the block, and of 0.6 mm on its top.
    const double volume_mm3 = 30 * 20 * 18 + 0.6 * model.area_of_faces("z+");
    EXPECT_NEAR(found.report.mass_kg, kDensity * volume_mm3 * 1e-9, 1e-12);
    for (std::size_t m = 0; m < found.modes.size(); ++m) {
      EXPECT_LE(found.modes[m].effective_mass_kg().length(), 1e-9 * found.report.mass_kg);
      if (turned > 0) {
        EXPECT_NEAR(found.modes[m].frequency_hz / before[m], 1, 1e-6);
      }
      before.push_back(found.modes[m].frequency_hz);
    }
  }
}

// Simply supported: 2 pi f = (1 + 1) (pi / a)^2 sqrt(D / (rho h)).
TEST(UnitTetDynamics, APlateOfSheetsHasTheModeOfKirchhoffsTheory) {
  const double side_mm = 100, thickness_mm = 1, young_kpa = 2500, poisson = 0.3;
  const SolidMesh mesh = sheet_mesh(tet_block({16, 16, 1}, {side_mm, side_mm, 1}), {"z-"});
  const TetModel model(mesh, TetElement::linear,
                       {{"sheet", SheetKind::both, young_kpa, poisson, thickness_mm}});
  TetLoads loads;
  const auto on_rim = [&](const Vec3d& x) {
    return x.x == 0 || x.y == 0 || x.x == side_mm || x.y == side_mm;
  };
  loads.held.push_back(held_where(model, on_rim));
  ModeParams params;
  params.count = 1;
  const VibrationModes found =
      lowest_modes(model, all_of(kDensity), model.nodal_loads(loads).held, params);
  const double rigidity = young_kpa * std::pow(thickness_mm, 3) / (12 * (1 - poisson * poisson));
  const double hz =
      kPi / (side_mm * side_mm) * std::sqrt(rigidity / (kDensity * 1e-9 * thickness_mm));
  EXPECT_NEAR(found.modes[0].frequency_hz / hz, 1, 0.02);
}

// It swings as its mode does, with what Rayleigh's damping takes: thesis eq. 3.9.
TEST(UnitTetDynamics, ABarSwingsInItsModeAndIsDamped) {
  for (const TetElement element : kTetElements) {
    SolidMesh mesh = tet_block(Vec3i(12, 1, 1), Vec3d(60, 5, 5));
    set_material(mesh, 6, 0.3);
    const TetModel model(mesh, element);
    const NodalLoads loads = model.nodal_loads(bar_in_its_walls(model));
    ModeParams mode_params;
    mode_params.count = 1;
    const VibrationMode mode =
        lowest_modes(model, all_of(kDensity), loads.held, mode_params).modes[0];
    const double omega = std::sqrt(mode.eigenvalue_per_s2), period_s = 2 * kPi / omega;
    RayleighDamping damping;
    damping.mass_per_s = 0.04 * omega;
    damping.stiffness_s[0] = 0.06 / omega;
    NewmarkParams params;
    params.step_s = period_s / 400;
    Newmark motion(model, all_of(kDensity), damping, loads, params);
    motion.start(mode.shape, std::vector<double>(mode.shape.size(), 0.0));
    const MotionEnergy first = motion.energy();
    for (int step = 0; step < 400; ++step) motion.step({});
    // alpha + beta omega^2 = 2 zeta omega with zeta = 0.05: after one period of the free swing.
    const double zeta = 0.05, damped = omega * std::sqrt(1 - zeta * zeta);
    const double wanted =
        std::exp(-zeta * omega * period_s) *
        (std::cos(damped * period_s) + zeta * omega / damped * std::sin(damped * period_s));
    double largest = 0;
    std::size_t at = 0;
    for (std::size_t n = 0; n < mode.shape.size(); ++n) {
      if (std::abs(mode.shape[n]) > largest) largest = std::abs(mode.shape[at = n]);
    }
    EXPECT_NEAR(motion.u_mm()[at] / mode.shape[at], wanted, 1e-3);
    const MotionEnergy last = motion.energy();
    EXPECT_NEAR(last.elastic_mj + last.kinetic_mj + last.dissipated_mj, first.elastic_mj,
                1e-5 * first.elastic_mj);
    EXPECT_GT(last.dissipated_mj, 0.3 * first.elastic_mj);
  }
}

TEST(PropertyTetDynamics, ABodyInSheetsMovesWithoutLossOfEnergy) {
  const ElasticSheet dura{"surface", SheetKind::both, 900, 0.48, 0.6};
  const TetModel model(tet_block(Vec3i(3, 2, 2), Vec3d(30, 20, 18), 0.2),
                       TetElement::nodal_pressure, {dura});
  TetLoads loads;
  loads.held.push_back({model.nodes_of_faces("x-")});
  loads.pressures.push_back({"z+", 0.2});
  const NodalLoads nodal = model.nodal_loads(loads);
  Newmark motion(model, all_of(kDensity), {}, nodal, {});
  motion.start(nodal.u_mm, nodal.u_mm);
  double most_mj = 0;
  for (int step = 0; step < 20; ++step) {
    motion.step({});
    const MotionEnergy energy = motion.energy();
    most_mj = std::max(most_mj, energy.elastic_mj + energy.kinetic_mj);
    EXPECT_NEAR(energy.elastic_mj + energy.kinetic_mj, energy.work_mj, 1e-5 * most_mj);
  }
  EXPECT_GT(most_mj, 0);
}
