// Forces, energies and symplectic Euler of mass-spring systems.
#include <cmath>

#include <gtest/gtest.h>

#include "lib/springs/stability.h"
#include "lib/springs/symplectic_euler.h"
#include "tests/lib/spring_fixtures.h"
#include "tests/lib/test_bodies.h"

using namespace supple;
using namespace supple::test;

namespace {

Vec3d momentum(const SpringSystem& system) {
  Vec3d sum(0.0);
  for (std::size_t n = 0; n < system.node_count(); ++n) {
    sum += system.velocity_mm_s[n] * system.mass_kg[n];
  }
  return sum;
}

}  // namespace

TEST(UnitSprings, AStretchedSpringPullsWithStiffnessTimesStretch) {
  // 100 N/m, 10 mm at rest, 13 mm long: 0.3 N towards each other. As misprinted in eq. 6.1,
  // k|x| - R, it would be 1.29 N.
  SpringSystem system = oscillator(0.002, 100, 0, 10, 3);
  std::vector<Vec3d> force;
  EXPECT_EQ(forces_mn(system, force, Damping::with), 0);
  EXPECT_NEAR(force[1].x, -300, 1e-9);
  EXPECT_NEAR(force[0].x, 300, 1e-9);
  // 1/2 100 N/m (3 mm)^2 = 0.45 mJ; at 2 m/s 2 g carry 4 mJ; 5 mm below the origin -0.0981 mJ.
  system.velocity_mm_s[1] = {0, 2000, 0};
  system.gravity_m_s2 = {9.81, 0, 0};
  system.pos_mm[0].x = -8;  // together 5 mm: gravity sees the sum of m x
  system.pos_mm[1].x = 5;
  const SpringEnergy e = energy(system);
  EXPECT_NEAR(e.spring_j, 0.45e-3, 1e-12);
  EXPECT_NEAR(e.kinetic_j, 4e-3, 1e-12);
  EXPECT_NEAR(e.gravity_j, 0.002 * 9.81 * 3e-3, 1e-12);
  EXPECT_NEAR(e.total_j(), e.spring_j + e.kinetic_j + e.gravity_j, 1e-15);
}

TEST(UnitSprings, ASpringOfLengthZeroPullsNowhereAndIsCounted) {
  const SpringSystem system = oscillator(1, 100, 1, 10, -10);
  std::vector<Vec3d> force;
  EXPECT_EQ(forces_mn(system, force, Damping::with), 1);
  EXPECT_EQ(force[1], Vec3d(0.0));
}

TEST(PropertySprings, ForcesAreTheNegativeGradientOfTheEnergy) {
  std::mt19937 random(3);
  for (int run = 0; run < 20; ++run) {
    SpringSystem system = random_system(random, 8, 20);
    system.gravity_m_s2 = {1, -9, 3};
    std::vector<Vec3d> force;
    forces_mn(system, force, Damping::without);
    const double step = 1e-5;
    for (int n = 0; n < 8; ++n) {
      for (int c = 0; c < 3; ++c) {
        SpringSystem lower = system, upper = system;
        lower.pos_mm[n][c] -= step;
        upper.pos_mm[n][c] += step;
        // J per mm are kN: 1e6 mN.
        const double slope = 1e6 * (energy(upper).total_j() - energy(lower).total_j()) / (2 * step);
        EXPECT_NEAR(force[n][c], -slope, 1e-5 * (1 + std::abs(slope)));
      }
    }
  }
}

TEST(PropertySprings, RigidMotionChangesNoEnergyAndTurnsForcesAlong) {
  std::mt19937 random(5);
  const SpringSystem system = random_system(random, 12, 40);
  // A turn by 0.7 about (2, 3, 6) / 7 (Rodrigues), then a move.
  const Vec3d axis(2 / 7.0, 3 / 7.0, 6 / 7.0);
  const auto turned = [&](const Vec3d& v) {
    return v * std::cos(0.7) + axis.cross(v) * std::sin(0.7) +
           axis * (axis.dot(v) * (1 - std::cos(0.7)));
  };
  SpringSystem moved = system;
  for (std::size_t n = 0; n < system.node_count(); ++n) {
    moved.pos_mm[n] = turned(system.pos_mm[n]) + Vec3d(30, -20, 7);
    moved.velocity_mm_s[n] = turned(system.velocity_mm_s[n]);
  }
  EXPECT_NEAR(energy(moved).total_j(), energy(system).total_j(), 1e-12);
  std::vector<Vec3d> before, after;
  forces_mn(system, before, Damping::with);
  forces_mn(moved, after, Damping::with);
  for (std::size_t n = 0; n < system.node_count(); ++n) {
    EXPECT_LT((after[n] - turned(before[n])).length(), 1e-8);
  }
  // Velocities of a rigid motion meet no damping of springs.
  for (std::size_t n = 0; n < system.node_count(); ++n) {
    moved.velocity_mm_s[n] = Vec3d(3, 4, 5) + axis.cross(moved.pos_mm[n]) * 11;
  }
  std::vector<Vec3d> undamped;
  forces_mn(moved, after, Damping::with);
  forces_mn(moved, undamped, Damping::without);
  for (std::size_t n = 0; n < system.node_count(); ++n) {
    EXPECT_LT((after[n] - undamped[n]).length(), 1e-8);
  }
}

TEST(UnitSprings, TheStableStepIsThatOfKnownSpectra) {
  // A mass on a spring: k dt^2 / m < 4.
  EXPECT_NEAR(stable_step_s(spectral_bounds(oscillator(0.004, 90, 0, 5, 1))),
              2 * std::sqrt(0.004 / 90), 1e-12);
  // Damped: dt^2 k / m + 2 dt d / m < 4.
  const double dt = stable_step_s(spectral_bounds(oscillator(0.004, 90, 0.5, 5, 1)));
  EXPECT_NEAR(dt * dt * 90 / 0.004 + 2 * dt * 0.5 / 0.004, 4, 1e-9);
  // A chain of n masses between held ends: omega^2 = 2 k / m (1 + cos(pi / (n + 1))).
  SpringSystem row = chain(22, 0.001, 70, 1);
  hold(row, 0);
  hold(row, 21);
  const double omega2 = 2 * 70 / 0.001 * (1 + std::cos(M_PI / 21));
  EXPECT_GE(spectral_bounds(row).stiffness_1_s2, omega2);
  EXPECT_NEAR(spectral_bounds(row).stiffness_1_s2, omega2, 2e-3 * omega2);
  // A wide square lattice: k dt^2 / m < 0.5 (design.md section 6).
  SpringSystem lattice;
  const int size = 30;
  for (int n = 0; n < size * size; ++n) {
    lattice.mass_kg.push_back(0.001);
    lattice.pos_mm.push_back({double(n % size), double(n / size), 0});
    if (n % size > 0) lattice.springs.push_back({n - 1, n, 1, 70});
    if (n >= size) lattice.springs.push_back({n - size, n, 1, 70});
  }
  const double limit = stable_step_s(spectral_bounds(lattice));
  EXPECT_NEAR(70 * limit * limit / 0.001, 0.5, 0.01);
}

TEST(UnitSprings, SymplecticEulerRefusesStepsPastTheLimitOrCutsThem) {
  const double limit = 2 * std::sqrt(0.004 / 90);
  SpringSystem system = oscillator(0.004, 90, 0, 5, 1);
  SymplecticEuler refusing(system, {false, 0.9, 1});
  EXPECT_NO_THROW(refusing.step(0.999 * limit));
  const std::string line = input_error([&] { refusing.step(1.001 * limit); });
  EXPECT_NE(line.find("0.0133467"), std::string::npos) << line;  // the step
  EXPECT_NE(line.find("0.0133333"), std::string::npos) << line;  // the limit
  SymplecticEuler cutting(system);
  EXPECT_EQ(cutting.step(0.999 * limit).substeps, 1);
  EXPECT_EQ(cutting.step(1.001 * limit).substeps, 2);
  EXPECT_EQ(cutting.step(9 * limit).substeps, 10);
  SymplecticEuler limited(system, {true, 0.9, 9});
  EXPECT_NE(input_error([&] { limited.step(9 * limit); }), "");
}

TEST(PropertySprings, SymplecticEulerKeepsMomentumWithoutHeldNodes) {
  std::mt19937 random(7);
  SpringSystem system = random_system(random, 10, 30);
  const Vec3d before = momentum(system);
  SymplecticEuler integrator(system);
  run_steps(integrator, 1e-3, 200);
  EXPECT_LT((momentum(system) - before).length(), 1e-10);
}

TEST(UnitSprings, WhatIsWrongWithASystemIsNamed) {
  const SpringSystem good = oscillator(1, 1, 0, 1, 0);
  const auto line_of = [&](const std::function<void(SpringSystem&)>& spoil) {
    SpringSystem system = good;
    spoil(system);
    return input_error([&] { validate(system); });
  };
  EXPECT_EQ(line_of([](SpringSystem&) {}), "");
  EXPECT_NE(line_of([](SpringSystem& s) { s.mass_kg[1] = 0; }).find("node 1"), std::string::npos);
  EXPECT_NE(line_of([](SpringSystem& s) { s.pos_mm[1].y = NAN; }).find("node 1"),
            std::string::npos);
  EXPECT_NE(line_of([](SpringSystem& s) { s.pos_mm.pop_back(); }).find("1 positions"),
            std::string::npos);
  EXPECT_NE(line_of([](SpringSystem& s) { s.springs[0].b = 2; }).find("node 2"), std::string::npos);
  EXPECT_NE(line_of([](SpringSystem& s) { s.springs[0].b = 0; }).find("twice"), std::string::npos);
  EXPECT_NE(line_of([](SpringSystem& s) { s.springs[0].stiffness_n_m = -1; }).find("-1"),
            std::string::npos);
  EXPECT_NE(line_of([](SpringSystem& s) {
              s.held = {{1, Vec3d(0.0)}, {0, Vec3d(0.0)}};
            }).find("held node 0"),
            std::string::npos);
  EXPECT_NE(line_of([](SpringSystem& s) { s.gravity_m_s2.x = HUGE_VAL; }), "");
  EXPECT_NE(line_of([](SpringSystem& s) { s.colliders = {{SphereShape{Vec3d(0.0), 0}}}; }), "");
  SpringSystem system = good;
  EXPECT_NE(input_error([&] { hold(system, 2); }), "");
  EXPECT_NE(input_error([&] { drive(system, 1, Vec3d(0.0)); }), "");
  SymplecticEuler integrator(system);
  EXPECT_NE(input_error([&] { integrator.step(0); }), "");
  EXPECT_NE(input_error([&] { integrator.step(NAN); }), "");
}
