// Static relaxation of spring systems, and the factorisation under it.
#include <cmath>

#include <gtest/gtest.h>

#include "lib/springs/block_ldlt.h"
#include "lib/springs/lattice_springs.h"
#include "lib/springs/mesh_springs.h"
#include "lib/springs/minimise.h"
#include "lib/springs/spring_matrix.h"
#include "tests/lib/spring_fixtures.h"
#include "tests/lib/test_bodies.h"
#include "volumes/base/parallel.h"

using namespace supple;
using namespace supple::test;

namespace {

/// a of the catenary z = a cosh(x / a) with that length between supports at that distance.
double catenary_parameter(double length, double distance) {
  double lo = distance / 100, hi = distance * 100;
  for (int n = 0; n < 200; ++n) {
    const double a = (lo + hi) / 2;
    (2 * a * std::sinh(distance / (2 * a)) > length ? lo : hi) = a;
  }
  return (lo + hi) / 2;
}

/// A random symmetric matrix, positive definite by its diagonal.
struct RandomBlocks {
  RandomBlocks(int rows, std::mt19937& random) : diagonal(rows, {9, 9, 9, 1, 2, -1}) {
    for (int a = 0; a < rows; ++a) {
      for (int b = a + 1; b < std::min(rows, a + 25); ++b) {
        if (random() % 4 != 0) continue;
        couplings.push_back(random() % 2 == 0 ? std::array<int, 2>{a, b}
                                              : std::array<int, 2>{b, a});
        SymmetricBlock block;
        for (double& value : block) value = double(random() % 1000) / 4000 - 0.125;
        coupling.push_back(block);
      }
    }
  }
  std::vector<Vec3d> operator*(const std::vector<Vec3d>& x) const {
    std::vector<Vec3d> product(x.size());
    for (std::size_t n = 0; n < x.size(); ++n) product[n] = times(diagonal[n], x[n]);
    for (std::size_t n = 0; n < couplings.size(); ++n) {
      const auto [a, b] = couplings[n];
      product[a] += times(coupling[n], x[b]);
      product[b] += times(coupling[n], x[a]);
    }
    return product;
  }

  std::vector<SymmetricBlock> diagonal, coupling;
  std::vector<std::array<int, 2>> couplings;
};

std::vector<Vec3d> random_vectors(int count, std::mt19937& random) {
  std::vector<Vec3d> vectors(count);
  for (Vec3d& v : vectors) v = Vec3d(double(random() % 100), double(random() % 100), -7);
  return vectors;
}

double distance(const std::vector<Vec3d>& a, const std::vector<Vec3d>& b) {
  double sum = 0;
  for (std::size_t n = 0; n < a.size(); ++n) sum += (a[n] - b[n]).length2();
  return std::sqrt(sum);
}

/// A cube of lattice springs whose ends are 1.2 times as far apart; its factors would fill up.
SpringSystem stretched_cube() {
  constexpr int kDim = 16;
  LatticeSprings springs =
      make_springs(body_of(soft_block({kDim, kDim, kDim})), LatticeSpringParams());
  for (std::size_t n = 0; n < springs.system.node_count(); ++n) {
    const double x = springs.system.pos_mm[n].x;
    if (x == 0 || x == kDim - 1) hold(springs.system, int(n));
    if (x == kDim - 1) drive(springs.system, int(n), springs.system.pos_mm[n] * Vec3d(1.2, 1, 1));
  }
  return springs.system;
}

}  // namespace

TEST(UnitBlockLdlt, ItsSolutionSatisfiesTheEquations) {
  std::mt19937 random(2);
  for (int run = 0; run < 30; ++run) {
    const int rows = 1 + int(random() % 25);
    RandomBlocks matrix(rows, random);
    BlockLdlt factors(rows, matrix.couplings);
    ASSERT_TRUE(factors.factorise(matrix.diagonal, matrix.coupling));
    const std::vector<Vec3d> right = random_vectors(rows, random);
    std::vector<Vec3d> x = right;
    factors.solve(x);
    ASSERT_LT(distance(matrix * x, right), 1e-8);
    // The factors say so if an eigenvalue is negative.
    matrix.diagonal[rows / 2][run % 3] = -1;
    EXPECT_FALSE(factors.factorise(matrix.diagonal, matrix.coupling));
  }
}

TEST(UnitBlockGradients, ItsSolutionIsAsNearAsAskedForWithAnyNumberOfThreads) {
  std::mt19937 random(3);
  for (const int rows : {1, 25, 20000}) {
    RandomBlocks matrix(rows, random);
    BlockGradients gradients(rows, matrix.couplings);
    ASSERT_TRUE(gradients.prepare(matrix.diagonal, matrix.coupling));
    const std::vector<Vec3d> right = random_vectors(rows, random);
    const double size = distance(right, std::vector<Vec3d>(right.size(), Vec3d(0.0)));
    double last = 1;
    for (const double tolerance : {1e-1, 1e-10}) {
      std::vector<Vec3d> x = right, alone = right;
      gradients.solve(x, tolerance, nullptr);
      const double rest = distance(matrix * x, right) / size;
      EXPECT_LE(rest, tolerance * 1.01);
      EXPECT_LE(rest, last);
      last = rest;
      const ThreadLimit limit(1);
      gradients.solve(alone, tolerance, nullptr);
      EXPECT_EQ(x, alone);
    }
    matrix.diagonal[rows / 2][1] = -1;
    EXPECT_FALSE(gradients.prepare(matrix.diagonal, matrix.coupling));
  }
}

TEST(ConvergenceSprings, AStiffHangingChainApproachesTheCatenary) {
  // 300 mm of chain between supports 200 mm apart; links of 300 / n mm, stretched by 1e-6 at most.
  const double a = catenary_parameter(300, 200);
  std::vector<double> errors;
  for (const int links : {12, 24, 48}) {
    SpringSystem system = chain(links + 1, 0.12 / links, 1e5 * links, 300.0 / links);
    system.gravity_m_s2 = {0, 0, -9.81};
    for (int n = 0; n <= links; ++n) {
      const double part = double(n) / links;  // a V of the right length
      system.pos_mm[n] = {200 * part, 0,
                          -std::sqrt(150.0 * 150 - 100 * 100) * (1 - std::abs(2 * part - 1))};
    }
    hold(system, 0);
    hold(system, links);
    const MinimiseReport report = minimise(system);
    EXPECT_TRUE(report.converged) << report.residual_mn << " after " << report.steps;
    EXPECT_LT(report.after.total_j(), report.before.total_j());
    double worst = 0;
    for (int n = 0; n <= links; ++n) {
      const double z = a * (std::cosh((system.pos_mm[n].x - 100) / a) - std::cosh(100 / a));
      worst = std::max(worst, std::abs(system.pos_mm[n].z - z));
    }
    errors.push_back(worst);
  }
  // A polygon of masses meets the curve at order two.
  EXPECT_NEAR(std::log2(errors[0] / errors[1]), 2, 0.3);
  EXPECT_NEAR(std::log2(errors[1] / errors[2]), 2, 0.3);
  EXPECT_LT(errors[2], 0.1);
}

TEST(PropertyMinimise, ACrumpledSheetComesToRestWithLessEnergyAndNoForces) {
  std::mt19937 random(4);
  SpringSystem system = make_springs(make_mesh_body(sheet(9, 7, 2)), MeshSpringParams());
  for (int n = 0; n < 9; ++n) hold(system, n);
  for (Vec3d& p : system.pos_mm) {
    for (int c = 0; c < 3; ++c) p[c] += double(random() % 1000) / 500 - 1;
  }
  drive(system, 3, system.pos_mm[3] + Vec3d(0, 0, 1));
  const std::vector<HeldNode> held = system.held;
  const MinimiseReport report = minimise(system);
  EXPECT_TRUE(report.converged);
  EXPECT_LE(report.residual_mn, 1e-3);
  EXPECT_LT(report.after.spring_j, report.before.spring_j);
  EXPECT_NEAR(report.after.spring_j, energy(system).spring_j, 1e-15);
  for (const HeldNode& h : held) EXPECT_EQ(system.pos_mm[h.node], h.target_mm);
  std::vector<Vec3d> force;
  forces_mn(system, force, Damping::with);
  for (std::size_t n = 9; n < force.size(); ++n) EXPECT_LE(force[n].length(), 1e-3);
}

TEST(PropertyMinimise, WhatIsInterruptedHasLessEnergyThanBefore) {
  struct StopAfter final : Progress {
    void stage(std::string_view) override {}
    void update(double) override { ++updates; }
    bool cancelled() const override { return updates >= 2; }
    int updates = 0;
  } progress;
  SpringSystem system = make_springs(make_mesh_body(sheet(9, 7, 2)), MeshSpringParams());
  hold(system, 0);
  for (std::size_t n = 1; n < system.node_count(); ++n) system.pos_mm[n] *= 1.3;
  const MinimiseReport report = minimise(system, {}, &progress);
  EXPECT_EQ(report.steps, 2);
  EXPECT_FALSE(report.converged);
  EXPECT_LT(report.after.total_j(), report.before.total_j());
}

TEST(PropertyMinimise, ASolidTooLargeForFactorsComesToRest) {
  SpringSystem system = stretched_cube();
  const MinimiseReport report = minimise(system);
  EXPECT_TRUE(report.converged) << report.residual_mn << " after " << report.steps;
  EXPECT_LT(report.steps, 40);
  std::vector<Vec3d> force;
  forces_mn(system, force, Damping::without);
  std::vector<char> is_held(system.node_count(), 0);
  for (const HeldNode& held : system.held) is_held[held.node] = 1;
  for (std::size_t n = 0; n < force.size(); ++n) {
    if (is_held[n]) continue;
    ASSERT_LE(force[n].length(), 1e-3);
  }
}
