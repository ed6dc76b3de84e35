// Voxel finite elements at finite strain against differences of their own energy, formulas of
// homogeneous deformations, and laws.
#include <cmath>

#include <gtest/gtest.h>

#include "lib/body/rigid_pieces.h"
#include "lib/fem/voxel/fem_loads.h"
#include "lib/fem/voxel/fem_results.h"
#include "lib/fem/voxel/finite_strain.h"
#include "tests/lib/fem_fixtures.h"
#include "tests/support/sanitized.h"
#include "volumes/base/parallel.h"

using namespace supple;
using namespace supple::test;

namespace {

FemParams by_newton_to(double tolerance) {
  FemParams params;
  params.strain = StrainTheory::finite;
  params.tolerance = tolerance;
  return params;
}

double largest_of_all(const std::vector<double>& values) {
  double most = 0;
  for (const double value : values) most = std::max(most, std::abs(value));
  return most;
}

double product_of(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t n = 0; n < a.size(); ++n) sum += a[n] * b[n];
  return sum;
}

/// u + factor d.
std::vector<double> moved(const std::vector<double>& u, double factor,
                          const std::vector<double>& d) {
  std::vector<double> out = u;
  for (std::size_t n = 0; n < u.size(); ++n) out[n] += factor * d[n];
  return out;
}

std::vector<double> forces_at(const FiniteStrain& strain, const std::vector<double>& u,
                              StrainEnergy* energy = nullptr) {
  std::vector<double> force(u.size());
  const StrainEnergy found = strain.add_forces(u.data(), force.data());
  if (energy != nullptr) *energy = found;
  return force;
}

/// A bar of 6 x 6 x 18 voxels of 1 mm whose lower end is held and whose upper end is moved.
Body bar() {
  return fem_body(18, [](const Vec3i& v) { return v.x < 6 && v.y < 6 ? 0 : -1; });
}
FemLoads moved_end(const Body& body, std::function<Vec3d(const Vec3d&)> displacement_mm) {
  FemLoads loads;
  loads.held.push_back(hold_where(
      body, [](const Vec3d& x) { return x.z > 17.4; }, std::move(displacement_mm)));
  loads.held.push_back(hold_where(body, [](const Vec3d& x) { return x.z < -0.4; }));
  return loads;
}
/// The upper end is turned about an axis through a point.
FemLoads turned_end(const Body& body, const Vec3d& axis, const Vec3d& about, double angle_deg,
                    const Vec3d& shift = Vec3d(0)) {
  const Turn turn = turn_about(axis, angle_deg);
  return moved_end(body, [=](const Vec3d& x) { return turn.way_of(x - about) + shift; });
}

/// Cauchy stresses of a stretch along the axes.
Vec3d cauchy_kpa(const ElasticModuli& moduli, const Vec3d& stretch) {
  const double J = stretch.x * stretch.y * stretch.z;
  const double mean = stretch.dot(stretch) / 3;
  Vec3d stress;
  for (int a = 0; a < 3; ++a) {
    stress[a] = moduli.shear_kpa * std::pow(J, -5.0 / 3) * (stretch[a] * stretch[a] - mean) +
                moduli.bulk_kpa * (J - 1);
  }
  return stress;
}

/// The stretch along the axes from `first` on that leaves no stress there, by bisection.
Vec3d with_free_sides(const ElasticModuli& moduli, Vec3d stretch, int first) {
  double lo = 0.2, hi = 3;
  for (int n = 0; n < 200; ++n) {
    const double middle = (lo + hi) / 2;
    for (int a = first; a < 3; ++a) stretch[a] = middle;
    (cauchy_kpa(moduli, stretch)[2] > 0 ? hi : lo) = middle;
  }
  return stretch;
}

/// A block of n^3 voxels of 1 mm on three planes without friction, whose opposite faces along the
/// first `axes` axes are moved.
FemLoads stretched_block(const Body& body, int n, const Vec3d& stretch, int axes) {
  FemLoads loads;
  for (int a = 0; a < 3; ++a) {
    loads.held.push_back(hold_where(body, [a](const Vec3d& x) { return x[a] < -0.49; }));
    loads.held.back().axes = {a == 0, a == 1, a == 2};
  }
  for (int a = 0; a < axes; ++a) {
    Vec3d way(0);
    way[a] = (stretch[a] - 1) * n;
    loads.held.push_back(hold_where(
        body, [=](const Vec3d& x) { return x[a] > n - 0.51; }, [=](const Vec3d&) { return way; }));
    loads.held.back().axes = {a == 0, a == 1, a == 2};
  }
  return loads;
}

}  // namespace

TEST(PropertyFemFinite, ForcesAreSlopesOfTheEnergyAndTheTangentIsThatOfTheForces) {
  std::mt19937 random(31);
  for (int round = 0; round < 6; ++round) {
    const Body body = random_fem_body(random, Vec3i(6, 7, 10));
    const Dilatation dilatation = round % 2 == 0 ? Dilatation::mean : Dilatation::pointwise;
    const FemModel model(body, random_elastic(random), dilatation);
    std::vector<double> swelling;
    if (round > 2) swelling = random_values(random, std::size_t(model.mesh().element_count()));
    const FiniteStrain strain(model.mesh(), model.material(), swelling);
    const std::size_t count = 3 * std::size_t(model.mesh().node_count());
    std::vector<double> u = random_values(random, count);
    for (double& value : u) value *= 0.04;
    const std::vector<double> d = random_values(random, count), e = random_values(random, count);

    StrainEnergy at, ahead, behind;
    const std::vector<double> force = forces_at(strain, u, &at);
    ASSERT_GT(at.smallest_j, 0.1);
    const double h = 1e-5;
    const std::vector<double> force_ahead = forces_at(strain, moved(u, h, d), &ahead);
    const std::vector<double> force_behind = forces_at(strain, moved(u, -h, d), &behind);
    const double slope = (ahead.energy_uj - behind.energy_uj) / (2 * h);
    EXPECT_NEAR(slope, product_of(force, d), 1e-6 * (std::abs(slope) + at.energy_uj));

    std::vector<double> tangent(count);
    strain.add_tangent(u.data(), d.data(), tangent.data());
    const double scale = largest_of_all(tangent);
    for (std::size_t n = 0; n < count; ++n) {
      EXPECT_NEAR((force_ahead[n] - force_behind[n]) / (2 * h), tangent[n], 1e-6 * scale);
    }
    std::vector<double> other(count);
    strain.subtract_tangent(u.data(), e.data(), other.data());
    EXPECT_NEAR(product_of(tangent, e), -product_of(other, d), 1e-11 * scale * double(count));
  }
}

TEST(PropertyFemFinite, AtRestTheTangentIsTheLinearStiffness) {
  std::mt19937 random(32);
  const Body body = random_fem_body(random, Vec3i(9, 7, 10));
  for (const Dilatation dilatation : {Dilatation::mean, Dilatation::pointwise}) {
    const FemModel model(body, random_elastic(random), dilatation);
    const FiniteStrain strain(model.mesh(), model.material());
    const std::vector<double> d = random_values(random, 3 * std::size_t(model.mesh().node_count()));
    const std::vector<double> rest(d.size());
    std::vector<double> linear, tangent(d.size());
    model.apply(d, linear);
    strain.add_tangent(rest.data(), d.data(), tangent.data());
    const double scale = largest_of_all(linear);
    for (std::size_t n = 0; n < d.size(); ++n) EXPECT_NEAR(tangent[n], linear[n], 1e-12 * scale);
  }
}

TEST(PropertyFemFinite, ATurnByAnyAngleNeedsNoForce) {
  std::mt19937 random(33);
  const Body body = random_fem_body(random, Vec3i(8, 7, 9));
  const FemModel model(body, ElasticTable::uniform(5, 0.4));
  const FiniteStrain strain(model.mesh(), model.material());
  const std::vector<Vec3d> positions = node_positions(model.mesh());
  for (const double angle_deg : {1e-3, 10.0, 90.0, 180.0, 260.0}) {
    const Turn turn = turn_about(Vec3d(pick(random, -1, 1), 0.3, pick(random, -1, 1)), angle_deg);
    std::vector<double> u;
    for (const Vec3d& x : positions) {
      const Vec3d way = turn.way_of(x - positions[0]) + Vec3d(3, -2, 1);
      u.insert(u.end(), {way.x, way.y, way.z});
    }
    StrainEnergy energy;
    const std::vector<double> force = forces_at(strain, u, &energy);
    EXPECT_LT(largest_of_all(force), 1e-11) << angle_deg;
    EXPECT_LT(std::abs(energy.energy_uj), 1e-11) << angle_deg;
    EXPECT_NEAR(energy.smallest_j, 1, 1e-12);
  }
}

TEST(PropertyFemFinite, ABlockIsStretchedAsTheFormulaSays) {
  const int n = 3;
  const Body body = fem_cube(n);
  for (const double poisson : {0.0, 0.3, 0.49}) {
    const ElasticModuli moduli = elastic_moduli(12, poisson);
    const FemModel model(body, ElasticTable::uniform(12, poisson));
    for (const int axes : {1, 2}) {
      for (const double along : {0.6, 1.5}) {
        const Vec3d stretch = with_free_sides(moduli, Vec3d(along, 1.2, 0), axes);
        const FemSolution solution =
            model.solve(stretched_block(body, n, stretch, axes), by_newton_to(1e-9));
        const std::vector<Vec3d> positions = node_positions(model.mesh());
        for (std::size_t m = 0; m < positions.size(); ++m) {
          const Vec3d want = (positions[m] + Vec3d(0.5)) * (stretch - Vec3d(1));
          for (int a = 0; a < 3; ++a)
            EXPECT_NEAR(solution.u_mm[3 * m + std::size_t(a)], want[a], 1e-6);
        }
        const Vec3d stress = cauchy_kpa(moduli, stretch);
        const double J = stretch.x * stretch.y * stretch.z;
        // The body pulls back at the end of x: nominal stress times the area at rest.
        const double pull_n = stress.x * J / stretch.x * n * n * 1e-3;
        EXPECT_NEAR(solution.reactions[3].force_n.x, -pull_n, 1e-6 * std::abs(pull_n));
        EXPECT_NEAR(solution.report.newton->smallest_j, J, 1e-6);

        const ElementState state =
            element_state(model.mesh(), model.material(), solution.u_mm, 5, StrainTheory::finite);
        for (int a = 0; a < 3; ++a) {
          EXPECT_NEAR(state.stress_kpa[std::size_t(a)], stress[a], 1e-5);
          EXPECT_NEAR(state.strain[std::size_t(a)], stretch[a] - 1, 1e-6);
        }
        EXPECT_NEAR(state.volume_strain, J - 1, 1e-6);
        EXPECT_NEAR(state.energy_density_kpa * n * n * n, solution.report.energy_mj * 1e3, 1e-5);
      }
    }
  }
}

TEST(PropertyFemFinite, ABlockIsShearedAsTheFormulaSays) {
  const int n = 4;
  const double gamma = 0.8, shear = elastic_moduli(12, 0.4).shear_kpa;
  const Body body = fem_cube(n);
  const auto on_top = [](const Vec3d& x) { return x.z > n - 0.51; };
  const auto outside = [](const Vec3d& x) {
    return std::min({x.x, x.y, x.z}) < -0.49 || std::max({x.x, x.y, x.z}) > n - 0.51;
  };
  const auto sheared = [=](const Vec3d& x) { return Vec3d(gamma * (x.z + 0.5), 0, 0); };
  FemLoads loads;
  loads.held.push_back(hold_where(body, on_top, sheared));
  loads.held.push_back(hold_where(body, outside, sheared));
  const FemModel model(body, ElasticTable::uniform(12, 0.4));
  const FemSolution solution = model.solve(loads, by_newton_to(1e-9));
  const std::vector<Vec3d> positions = node_positions(model.mesh());
  for (std::size_t m = 0; m < positions.size(); ++m) {
    const Vec3d want = sheared(positions[m]);
    for (int a = 0; a < 3; ++a) EXPECT_NEAR(solution.u_mm[3 * m + std::size_t(a)], want[a], 1e-6);
  }
  const ElementState state =
      element_state(model.mesh(), model.material(), solution.u_mm, 21, StrainTheory::finite);
  // J = 1, F F^T = 1 + gamma^2 xx + gamma (xz + zx).
  const SymmetricTensor want{shear * gamma * gamma * 2 / 3,
                             -shear * gamma * gamma / 3,
                             -shear * gamma * gamma / 3,
                             0,
                             0,
                             shear * gamma};
  for (std::size_t m = 0; m < 6; ++m) EXPECT_NEAR(state.stress_kpa[m], want[m], 1e-5);
  EXPECT_NEAR(state.energy_density_kpa, shear * gamma * gamma / 2, 1e-6);
  EXPECT_NEAR(state.rotation_rad.y, std::atan(gamma / 2), 1e-6);
}

TEST(ConvergenceFemFinite, SmallLoadsMoveABodyAsLinearTheorySaysToSecondOrder) {
  LEFT_OUT_WHEN_SANITIZED();
  const Body body = bar();
  const FemModel model(body, ElasticTable::uniform(10, 0.4));
  double before = 0;
  for (const double way_mm : {0.4, 0.2, 0.1}) {
    const FemLoads loads =
        moved_end(body, [=](const Vec3d&) { return Vec3d(way_mm, 0, way_mm / 2); });
    FemParams linear;
    linear.tolerance = 1e-9;
    const std::vector<double> by_line = model.solve(loads, linear).u_mm;
    const std::vector<double> by_newton = model.solve(loads, by_newton_to(1e-9)).u_mm;
    const double apart = largest_of_all(moved(by_line, -1, by_newton));
    EXPECT_LT(apart, 0.1 * way_mm);
    if (before > 0) {
      EXPECT_NEAR(std::log2(before / apart), 2, 0.15);
    }
    before = apart;
  }
}

TEST(ConvergenceFemFinite, NewtonsMethodConvergesQuadratically) {
  LEFT_OUT_WHEN_SANITIZED();
  const Body body = bar();
  const FemModel model(body, ElasticTable::uniform(10, 0.45));
  const FemSolution solution =
      model.solve(turned_end(body, Vec3d(0, 0, 1), Vec3d(2.5, 2.5, 0), 40), by_newton_to(1e-10));
  const std::vector<double>& r = solution.report.newton->residuals_mn;
  ASSERT_GE(r.size(), 4u);
  // While systems are solved as well as the residual is small, and not as well as the tolerance
  // needs: relative residuals from 0.1 on, squared each time but for a factor.
  const double scale = solution.report.largest_force_n * 1e3;
  int squared = 0;
  for (std::size_t n = 1; n < r.size(); ++n) {
    const double before = r[n - 1] / scale;
    if (before > 0.1 || before < 1e-5) continue;
    EXPECT_LT(r[n] / scale, 3 * before * before) << before;
    ++squared;
  }
  EXPECT_GE(squared, 2);
}

TEST(PropertyFemFinite, ATwistOfNinetyDegreesConvergesAndItsEnergyIsTheWork) {
  const Body body = bar();
  const FemModel model(body, ElasticTable::uniform(10, 0.45));
  const auto twisted = [&](double angle_deg) {
    return model.solve(turned_end(body, Vec3d(0, 0, 1), Vec3d(2.5, 2.5, 0), angle_deg),
                       by_newton_to(1e-7));
  };
  const FemSolution less = twisted(89), exactly = twisted(90), more = twisted(91);
  // The end holds against the body's moment.
  const double work_mj = (more.report.energy_mj - less.report.energy_mj) / (2 * kPi / 180);
  EXPECT_NEAR(-exactly.reactions[0].moment_nmm.z, work_mj, 2e-4 * work_mj);
  EXPECT_GT(exactly.report.newton->smallest_j, 0.5);
  EXPECT_LT(exactly.report.force_balance, 1e-6);
  EXPECT_LT(exactly.report.energy_identity, 1e-6);
  for (int a = 0; a < 3; ++a) {
    EXPECT_NEAR(exactly.reactions[0].force_n[a], -exactly.reactions[1].force_n[a], 1e-7);
  }
}

TEST(PropertyFemFinite, TheCycleIsTurnedWithTheBody) {
  // Bent by 90 degrees, and moved to where a circle would end.
  const Body body = bar();
  const FemModel model(body, ElasticTable::uniform(10, 0.3));
  const double radius = 18 / (kPi / 2);
  const FemLoads loads =
      turned_end(body, Vec3d(0, 1, 0), Vec3d(2.5, 2.5, 17.5), 90, Vec3d(radius, 0, radius - 18));
  const NewtonReport report = *model.solve(loads, by_newton_to(1e-6)).report.newton;
  // 4 iterations for each of 18 systems; 13 without the turns.
  const int systems = report.newton_iterations + report.load_steps + report.rejected_steps;
  EXPECT_LT(report.cg_iterations, 7 * systems);
  EXPECT_LT(systems, 25);
}

TEST(PropertyFemFinite, SolutionsHaveTheSameBitsOnAnyNumberOfThreads) {
  std::mt19937 random(34);
  const Body body = random_fem_body(random, Vec3i(14, 14, 18));
  const FemModel model(body, ElasticTable::uniform(3, 0.4));
  const std::vector<Vec3d> positions = node_positions(model.mesh());
  double middle = 0;
  for (const Vec3d& x : positions) middle += x.z / double(positions.size());
  FemLoads loads;
  loads.held.push_back(hold_where(body, [=](const Vec3d& x) { return x.z < middle; }));
  loads.body_force = [](const Vec3d&) { return Vec3d(0.01, 0.002, 0.03); };
  const auto solve = [&] { return model.solve(loads, by_newton_to(1e-6)).u_mm; };
  const std::vector<double> one = on_threads(1, solve);
  EXPECT_GT(largest_of_all(one), 0.05);
  EXPECT_EQ(on_threads(3, solve), one);
}

TEST(UnitFemFinite, WhatIsHeldGoesAlongItsRigidMotion) {
  const Body body = bar();
  const FemModel model(body, ElasticTable::uniform(1, 0.3));
  const Vec3d middle(2.5, 2.5, 17.5);
  const NodalLoads loads = nodal_loads(model.mesh(), model.material(),
                                       turned_end(body, Vec3d(0, 0, 1), middle, 90, Vec3d(0, 0, 4)),
                                       StrainTheory::finite);
  const LoadPath path(model, loads);
  std::vector<double> u(loads.u_mm.size());
  path.prescribe(0.5, u);
  const Turn half = turn_about(Vec3d(0, 0, 1), 45);
  const std::vector<Vec3d> positions = node_positions(model.mesh());
  for (const NodeIndex node : loads.nodes_of[0]) {
    const Vec3d want = half.way_of(positions[std::size_t(node)] - middle) + Vec3d(0, 0, 2);
    for (int a = 0; a < 3; ++a) {
      EXPECT_NEAR(u[3 * std::size_t(node) + std::size_t(a)], want[a], 1e-9);
    }
  }
  path.prescribe(1, u);
  EXPECT_EQ(u, loads.u_mm);
}

TEST(UnitFemFinite, WhatTurnsABodyInsideOutIsAnErrorWithNumbers) {
  const int n = 4;
  const Body body = fem_cube(n);
  const FemModel model(body, ElasticTable::uniform(1, 0.3));
  // The upper face is pushed through the lower one.
  FemLoads loads;
  loads.held.push_back(hold_where(
      body, [](const Vec3d& x) { return x.z > n - 0.6; },
      [](const Vec3d&) { return Vec3d(0, 0, -n - 1); }));
  loads.held.push_back(hold_where(body, [](const Vec3d& x) { return x.z < -0.4; }));
  try {
    model.solve(loads, by_newton_to(1e-6));
    ADD_FAILURE() << "a body inside out";
  } catch (const NotConverged& error) {
    const NewtonReport& report = *error.report().newton;
    EXPECT_GT(report.load_part, 0.1);
    EXPECT_LT(report.load_part, 0.9);
    EXPECT_GT(report.smallest_j, 0);
    EXPECT_GT(report.rejected_steps, 0);
    EXPECT_NE(std::string(error.what()).find("% of the load ("), std::string::npos);
  }
}
