// Tetrahedra and sheets at finite strain against differences of their own energy, formulas of
// homogeneous deformations, and laws.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "lib/body/rigid_pieces.h"
#include "lib/fem/tet/finite_tets.h"
#include "tests/lib/fem/tet/tet_fixtures.h"
#include "tests/lib/fem_fixtures.h"
#include "tests/lib/test_bodies.h"
#include "tests/support/sanitized.h"

using namespace supple;
using namespace supple::test;

namespace {

const ElasticSheet kDura{"z+", SheetKind::both, 900, 0.48, 0.6};
const ElasticSheet kMembrane{"x+", SheetKind::stretch, 400, 0.3, 0.4};

TetParams by_newton(double tolerance) {
  TetParams params;
  params.strain = StrainTheory::finite;
  params.tolerance = tolerance;
  return params;
}

/// A box of two materials, one of which has a lambda below 0.
SolidMesh mixed_block() {
  SolidMesh mesh = tet_block(Vec3i(3, 2, 2), Vec3d(30, 20, 18), 0.2);
  mesh.materials = {{"soft", 6, 0.45}, {"cork", 9, -0.1}};
  for (std::size_t e = 0; e < mesh.tets.size(); ++e) mesh.material_of.push_back(e % 3 == 0);
  return mesh;
}

double largest_value(const std::vector<double>& values) {
  double most = 0;
  for (const double value : values) most = std::max(most, std::abs(value));
  return most;
}

double inner(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t n = 0; n < a.size(); ++n) sum += a[n] * b[n];
  return sum;
}

/// u + factor d.
std::vector<double> gone(std::vector<double> u, double factor, const std::vector<double>& d) {
  for (std::size_t n = 0; n < u.size(); ++n) u[n] += factor * d[n];
  return u;
}

std::vector<double> field_at_nodes(const TetModel& model,
                                   const std::function<Vec3d(const Vec3d&)>& field) {
  std::vector<double> u;
  for (const Vec3d& x : model.node_positions()) {
    const Vec3d of = field(x);
    u.insert(u.end(), {of.x, of.y, of.z});
  }
  return u;
}

/// Cauchy stresses of a stretch along the axes.
Vec3d stress_of(const TetModuli& moduli, const Vec3d& stretch) {
  const double J = stretch.x * stretch.y * stretch.z, mean = stretch.dot(stretch) / 3;
  Vec3d stress;
  for (int a = 0; a < 3; ++a) {
    stress[a] = moduli.shear_kpa * std::pow(J, -5.0 / 3) * (stretch[a] * stretch[a] - mean) +
                moduli.bulk_kpa * (J - 1);
  }
  return stress;
}

/// The stretch along x with that across it which leaves no stress there, by bisection.
Vec3d bar_stretch(const TetModuli& moduli, double along) {
  double lo = 0.2, hi = 3;
  for (int n = 0; n < 200; ++n) {
    const double middle = (lo + hi) / 2;
    (stress_of(moduli, Vec3d(along, middle, middle)).z > 0 ? hi : lo) = middle;
  }
  return Vec3d(along, lo, lo);
}

/// Planes through the origin on which a box slides; nothing else is held.
std::vector<TetHeld> sliding_planes(const TetModel& model) {
  std::vector<TetHeld> out;
  for (int a = 0; a < 3; ++a) {
    out.push_back(held_where(model, [a](const Vec3d& x) { return x[a] == 0; }));
    out.back().components = std::uint8_t(1 << a);
  }
  return out;
}

}  // namespace

TEST(PropertyTetFinite, ForcesAreSlopesOfTheEnergyAndTheTangentIsThatOfTheForces) {
  std::mt19937 random(53);
  for (const TetElement element : kTetElements) {
    const TetModel model(mixed_block(), element, {kDura, kMembrane});
    const std::size_t count = 3 * std::size_t(model.node_count());
    const HeldBits held(std::size_t(model.node_count()), 0);
    const FiniteTets system(model, held, random_values(random, model.volumes().element_count()));
    std::vector<double> u = random_values(random, count);
    for (double& value : u) value *= 0.5;
    const std::vector<double> d = random_values(random, count);
    const double h = 1e-5, part = 0.7;
    std::vector<double> force(count), ahead(count), behind(count);
    const StrainEnergy at = system.add_forces(u.data(), force.data(), part);
    ASSERT_GT(at.smallest_j, 0.3);
    ASSERT_LT(at.smallest_j, 0.95);
    const double energy_ahead =
        system.add_forces(gone(u, h, d).data(), ahead.data(), part).energy_uj;
    const double energy_behind =
        system.add_forces(gone(u, -h, d).data(), behind.data(), part).energy_uj;
    const double slope = (energy_ahead - energy_behind) / (2 * h);
    EXPECT_NEAR(slope, inner(force, d), 1e-7 * (std::abs(slope) + at.energy_uj));
    const BlockCsr tangent = system.tangent(u, part);
    std::vector<double> product(count);
    tangent.add(d.data(), product.data());
    const double scale = largest_value(product);
    for (std::size_t n = 0; n < count; ++n) {
      EXPECT_NEAR((ahead[n] - behind[n]) / (2 * h), product[n], 1e-6 * scale);
    }
  }
}

TEST(PropertyTetFinite, AtRestTheTangentIsTheLinearStiffness) {
  for (const TetElement element : kTetElements) {
    const TetModel model(mixed_block(), element, {kDura, kMembrane});
    const HeldBits held(std::size_t(model.node_count()), 0);
    const FiniteTets system(model, held, {});
    const BlockCsr tangent =
        system.tangent(std::vector<double>(3 * std::size_t(model.node_count())), 1);
    double most = 0, off = 0;
    for (std::size_t n = 0; n < tangent.blocks().size(); ++n) {
      for (std::size_t m = 0; m < 9; ++m) {
        most = std::max(most, std::abs(model.stiffness().blocks()[n][m]));
        off = std::max(off, std::abs(model.stiffness().blocks()[n][m] - tangent.blocks()[n][m]));
      }
    }
    EXPECT_LE(off, kRounding * most);
  }
}

TEST(PropertyTetFinite, ATurnByAnyAngleNeedsNoForce) {
  for (const TetElement element : kTetElements) {
    const TetModel model(mixed_block(), element, {kMembrane});
    const HeldBits held(std::size_t(model.node_count()), 0);
    const FiniteTets system(model, held, {});
    for (const double angle_deg : {1e-3, 40.0, 180.0, 260.0}) {
      const Turn turn = turn_about(Vec3d(0.4, 0.3, -0.7), angle_deg);
      const std::vector<double> u = field_at_nodes(
          model, [&](const Vec3d& x) { return turn.way_of(x - Vec3d(3, 1, 2)) + Vec3d(3, -2, 1); });
      std::vector<double> force(u.size());
      const StrainEnergy energy = system.add_forces(u.data(), force.data(), 1);
      // Of forces of some 1e4 mN per mm.
      EXPECT_LT(largest_value(force), 1e-9) << angle_deg;
      EXPECT_LT(std::abs(energy.energy_uj), 1e-9) << angle_deg;
      EXPECT_NEAR(energy.smallest_j, 1, 1e-12);
    }
  }
}

TEST(PropertyTetFinite, ABlockIsStretchedAsTheFormulaSays) {
  for (const TetElement element : kTetElements) {
    // Pressed to half its length at nu near 0 the law has states of less energy, which ten nodes
    // find.
    const double pressed = element == TetElement::quadratic ? 0.7 : 0.5;
    for (const double poisson : {0.0, 0.3, 0.47}) {
      SolidMesh mesh = tet_block(Vec3i(3, 2, 2), Vec3d(30, 20, 18), 0.2);
      set_material(mesh, 6, poisson);
      const TetModel model(mesh, element);
      const TetModuli& moduli = model.moduli()[0];
      for (const double along : {pressed, 1.5}) {
        const Vec3d stretch = bar_stretch(moduli, along);
        TetLoads loads;
        loads.held = sliding_planes(model);
        loads.held.push_back(held_where(
            model, [](const Vec3d& x) { return x.x == 30; },
            [&](const Vec3d&) { return Vec3d(30 * (along - 1), 0, 0); }));
        loads.held.back().components = 1;
        const TetSolution solution = model.solve(loads, by_newton(1e-10));
        const auto wanted = [&](const Vec3d& x) { return x * (stretch - Vec3d(1)); };
        EXPECT_LE(largest_difference(model, solution, wanted), 1e-8);
        const Vec3d stress = stress_of(moduli, stretch);
        const double J = stretch.x * stretch.y * stretch.z;
        const double pull_n = stress.x * J / stretch.x * 20 * 18 * 1e-3;
        EXPECT_NEAR(solution.reactions[3].force_n.x, -pull_n, 1e-7 * std::abs(pull_n));
        EXPECT_NEAR(solution.least_det_f, J, 1e-8);
        EXPECT_NEAR(solution.report.newton->smallest_j, J, 1e-8);
        for (const ElementState& state : model.states(solution, loads)) {
          for (int a = 0; a < 3; ++a) {
            EXPECT_NEAR(state.stress_kpa[std::size_t(a)], stress[a], 1e-6);
            EXPECT_NEAR(state.strain[std::size_t(a)], stretch[a] - 1, 1e-8);
          }
          EXPECT_NEAR(state.volume_strain, J - 1, 1e-8);
          EXPECT_NEAR(state.energy_density_kpa * 30 * 20 * 18, solution.report.energy_mj * 1e3,
                      1e-6 * solution.report.energy_mj * 1e3);
        }
      }
    }
  }
}

// 80 mmHg, at nu = 0.47: by a third of the volume, with kappa (J - 1) = p.
TEST(PropertyTetFinite, AFreeBodySwellsUntilItsBulkHoldsThePressureWithoutStress) {
  const double pressure_kpa = 80 * 0.1333224;
  for (const TetElement element : kTetElements) {
    SolidMesh mesh = tet_block(Vec3i(3, 2, 2), Vec3d(30, 20, 18), 0.2);
    set_material(mesh, 6, 0.47);
    const TetModel model(mesh, element);
    TetLoads loads;
    loads.held = sliding_planes(model);
    loads.swelling_kpa.assign(model.volumes().element_count(), pressure_kpa);
    const TetSolution solution = model.solve(loads, by_newton(1e-10));
    const double J = 1 + pressure_kpa / model.moduli()[0].bulk_kpa;
    const double stretch = std::cbrt(J);
    EXPECT_GT(J, 1.3);
    EXPECT_LE(
        largest_difference(model, solution, [&](const Vec3d& x) { return x * (stretch - 1); }),
        1e-8);
    EXPECT_NEAR(model.volumes().displaced_volume_mm3(solution.u_mm), J * 30 * 20 * 18, 1e-4);
    EXPECT_NEAR(solution.least_det_f, J, 1e-8);
    EXPECT_LE(solution.report.force_balance, 1e-8);
    for (const ElementState& state : model.states(solution, loads)) {
      for (const double of : state.stress_kpa) EXPECT_NEAR(of, 0, 1e-6);
    }
  }
}

TEST(PropertyTetFinite, AMembraneHasTheEnergyOfGreensStrain) {
  SolidMesh mesh = tet_block(Vec3i(3, 2, 2), Vec3d(30, 20, 18), 0.2);
  set_material(mesh, 6, 0.3);
  // z+ is stretched along x and y and sheared, and turned by what moves z.
  const Matrix9 f{1.4, 0.3, 0, 0, 0.9, 0, 0.5, -0.2, 1};
  const auto field = [&](const Vec3d& x) { return times(f, x) - x; };
  double energy[2];
  for (const bool has_sheet : {false, true}) {
    std::vector<ElasticSheet> sheets;
    if (has_sheet) sheets.push_back({"z+", SheetKind::stretch, 900, 0.4, 0.6});
    const TetModel model(mesh, TetElement::linear, sheets);
    const HeldBits held(std::size_t(model.node_count()), 0);
    const std::vector<double> u = field_at_nodes(model, field);
    std::vector<double> force(u.size());
    energy[has_sheet] = FiniteTets(model, held, {}).add_forces(u.data(), force.data(), 1).energy_uj;
  }
  const double xx = (1.4 * 1.4 + 0.5 * 0.5 - 1) / 2, yy = (0.3 * 0.3 + 0.81 + 0.04 - 1) / 2,
               xy = (1.4 * 0.3 - 0.5 * 0.2) / 2;
  const double lambda = 900 * 0.4 / (1 - 0.16), mu = 900 / 2.8;
  const double density =
      lambda / 2 * (xx + yy) * (xx + yy) + mu * (xx * xx + yy * yy + 2 * xy * xy);
  EXPECT_NEAR(energy[1] - energy[0], density * 0.6 * 30 * 20, 1e-8 * energy[1]);
}

TEST(ConvergenceTetFinite, SmallLoadsMoveABodyAsLinearTheorySaysToSecondOrder) {
  LEFT_OUT_WHEN_SANITIZED();
  for (const TetElement element : kTetElements) {
    const TetModel model(mixed_block(), element, {kDura, kMembrane});
    double before = 0;
    for (const double pressure_kpa : {0.2, 0.1, 0.05}) {
      TetLoads loads;
      loads.held.push_back(held_where(model, [](const Vec3d& x) { return x.x == 0; }));
      loads.swelling_kpa.assign(model.volumes().element_count(), pressure_kpa);
      loads.pressures.push_back({"y+", pressure_kpa});
      const std::vector<double> linear = model.solve(loads, exact_params()).u_mm;
      const std::vector<double> finite = model.solve(loads, by_newton(1e-10)).u_mm;
      const double apart = largest_value(gone(finite, -1, linear));
      EXPECT_LT(apart, 0.3 * largest_value(linear));
      if (before > 0) {
        EXPECT_NEAR(std::log2(before / apart), 2, 0.25);
      }
      before = apart;
    }
  }
}

TEST(PropertyTetFinite, ASwollenBallIsTheSameOnAnyNumberOfThreads) {
  for (const TetElement element : {TetElement::linear, TetElement::nodal_pressure}) {
    SolidMesh mesh = tet_ball(4, 70);
    set_material(mesh, 6, 0.47);
    const ElasticSheet dura{"surface", SheetKind::both, 900, 0.48, 0.6};
    TetLoads loads;
    loads.swelling_kpa.assign(mesh.tets.size(), 6);
    std::vector<TetSolution> solutions;
    for (const int threads : {1, 2, 5}) {
      on_threads(threads, [&] {
        const TetModel model(mesh, element, {dura});
        loads.held = {held_where(model, [](const Vec3d& x) { return x.z < -40; })};
        solutions.push_back(model.solve(loads, by_newton(1e-8)));
      });
    }
    EXPECT_EQ(solutions[0].u_mm, solutions[1].u_mm);
    EXPECT_EQ(solutions[0].u_mm, solutions[2].u_mm);
    const FemReport& report = solutions[0].report;
    EXPECT_LE(report.residual_max, 1e-8);
    EXPECT_LE(report.force_balance, 1e-8);
    EXPECT_GT(report.largest_strain, 0.03);
    EXPECT_FALSE(report.beyond_linear);
    EXPECT_EQ(report.newton->load_part, 1);
    EXPECT_GT(solutions[0].least_det_f, 0.5);
  }
}

TEST(FaultTetFinite, WhatIsForSmallStrainsAloneIsRefused) {
  const TetModel model(tet_block(Vec3i(1), Vec3d(1)), TetElement::linear);
  TetLoads loads;
  loads.held.push_back({model.nodes_of_faces("z-")});
  TetParams params = by_newton(1e-8);
  EXPECT_THROW(TetSolver(model, loads, params), InputError);
  TetShellContact shell;
  shell.faces = {"z+"};
  EXPECT_THROW(solve_in_shell(model, loads, shell, params), InputError);
  params.equations = TetEquations::factor;
  EXPECT_THROW(model.solve(loads, params), InputError);
  loads.swelling_kpa.assign(model.volumes().element_count(), std::nan(""));
  EXPECT_THROW(model.solve(loads, by_newton(1e-8)), InputError);
  loads.swelling_kpa.assign(model.volumes().element_count(), 1);
  loads.held.clear();
  EXPECT_THROW(model.solve(loads, by_newton(1e-8)), InputError);
}
