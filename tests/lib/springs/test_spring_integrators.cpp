// Laws that every integrator of mass-spring systems keeps.
#include <cmath>
#include <memory>

#include <gtest/gtest.h>

#include "lib/springs/implicit_euler.h"
#include "lib/springs/integrators.h"
#include "lib/springs/mesh_springs.h"
#include "lib/springs/projective.h"
#include "lib/springs/symplectic_euler.h"
#include "lib/springs/xpbd.h"
#include "tests/lib/spring_fixtures.h"
#include "tests/lib/test_bodies.h"
#include "volumes/base/parallel.h"

using namespace supple;
using namespace supple::test;

namespace {

const std::vector<std::string> kIntegrators = {"symplectic", "implicit", "xpbd", "projective"};

std::unique_ptr<SpringIntegrator> make(const std::string& name, SpringSystem& system) {
  return make_integrator(*spring_method(name), system);
}

struct Momenta {
  Vec3d linear{0, 0, 0}, angular{0, 0, 0};
};
Momenta momenta(const SpringSystem& system) {
  Momenta sum;
  for (std::size_t n = 0; n < system.node_count(); ++n) {
    const Vec3d p = system.velocity_mm_s[n] * system.mass_kg[n];
    sum.linear += p;
    sum.angular += system.pos_mm[n].cross(p);
  }
  return sum;
}

/// 90 degrees about z, exactly.
Vec3d quarter_turn(const Vec3d& v) {
  return {-v.y, v.x, v.z};
}

/// A sheet of 12 x 8 nodes, its left and right rims held, bent upwards.
SpringSystem bent_sheet(double structural_n_m) {
  MeshSpringParams params;
  params.structural_n_m = structural_n_m;
  params.bending_n_m = structural_n_m / 10;
  SpringSystem system = make_springs(make_mesh_body(sheet(12, 8, 1)), params);
  for (int n = 0; n < 96; ++n) {
    const int i = n % 12;
    system.pos_mm[n].z = 2 * std::sin(M_PI * i / 11) + 0.1 * (n % 5);
    if (i == 0 || i == 11) hold(system, n);
  }
  return system;
}

}  // namespace

TEST(UnitSpringIntegrators, OneStepOfAMassOnADrivenSpringIsTheImplicitOne) {
  // The held end goes by e in the step, the mass from stretch 1.5 with v0:
  //   m (v1 - v0) / h = -k (1.5 + h v1 - e) - d (v1 - e / h) - alpha m v1,
  // exact in one sweep, back-solve or Newton step.
  const double m = 0.02, k = 300, d = 0.4, h = 0.01, alpha = 2, v0 = 30, e = 0.2;
  const double v1 =
      (v0 - h * k / m * (1.5 - e) + d * e / m) / (1 + h * d / m + h * h * k / m + h * alpha);
  for (const std::string name : {"implicit", "xpbd", "projective"}) {
    SpringSystem system = oscillator(m, k, d, 10, 1.5);
    system.velocity_mm_s[1].x = v0;
    system.mass_damping_per_s = alpha;
    drive(system, 0, {e, 0, 0});
    std::unique_ptr<SpringIntegrator> integrator = make(name, system);
    if (name == "xpbd") integrator = std::make_unique<Xpbd>(system, Xpbd::Params{1, 2});
    integrator->step(h);
    EXPECT_NEAR(system.velocity_mm_s[1].x, v1, 1e-6 * std::abs(v1)) << name;
    EXPECT_NEAR(system.pos_mm[1].x, 11.5 + h * v1, 1e-6) << name;
    EXPECT_EQ(system.pos_mm[0], Vec3d(e, 0, 0));
    // Pull of the spring at the held end, less the damping and inertia of that end itself.
    const double pull =
        k * (1.5 + h * v1 - e) + d * (v1 - e / h) - alpha * m * e / h - m * e / (h * h);
    EXPECT_NEAR(integrator->reactions_n()[0].x, pull * 1e-3, 1e-9 * std::abs(pull)) << name;
  }
}

TEST(PropertySpringIntegrators, MomentumStaysWithoutHeldNodes) {
  for (const std::string& name : kIntegrators) {
    std::mt19937 random(11);
    SpringSystem system = random_system(random, 12, 40);
    for (Spring& s : system.springs) s.damping_n_s_m *= 0.1;
    const Momenta before = momenta(system);
    std::unique_ptr<SpringIntegrator> integrator = make(name, system);
    if (name == "implicit") {
      integrator =
          std::make_unique<ImplicitEuler>(system, ImplicitEuler::Params{50, 1, 1e-9, 1e-9});
    }
    run_steps(*integrator, 5e-4, 50);
    EXPECT_LT((momenta(system).linear - before.linear).length(), 1e-7) << name;
    // Forces along the springs at the positions at hand keep the angular one, too.
    if (name != "symplectic") continue;
    EXPECT_LT((momenta(system).angular - before.angular).length(),
              1e-9 * before.angular.length() + 1e-7);
  }
}

TEST(ExtremesSpringIntegrators, AGrainOfDustFliesOnUntouched) {
  for (const std::string& name : kIntegrators) {
    SpringSystem system = oscillator(1, 0, 0, 5, 0);
    system.springs.clear();
    system.mass_kg = {1e3, 1e-15};
    system.velocity_mm_s[1] = {1e-3, 2, 5e3};
    const std::unique_ptr<SpringIntegrator> integrator = make(name, system);
    run_steps(*integrator, 0.02, 50);
    EXPECT_LT((system.velocity_mm_s[1] - Vec3d(1e-3, 2, 5e3)).length(), 1e-6) << name;
  }
}

TEST(PropertySpringIntegrators, ATurnedAndMovedSystemMovesTheSameWay) {
  for (const std::string& name : kIntegrators) {
    SpringSystem system = bent_sheet(200);
    system.gravity_m_s2 = {1, 2, -9};
    for (Spring& s : system.springs) s.damping_n_s_m = 0.001;
    SpringSystem turned = system;
    turned.gravity_m_s2 = quarter_turn(system.gravity_m_s2);
    for (std::size_t n = 0; n < system.node_count(); ++n) {
      turned.pos_mm[n] = quarter_turn(system.pos_mm[n]) + Vec3d(40, -30, 20);
    }
    for (HeldNode& held : turned.held) held.target_mm = turned.pos_mm[held.node];
    const std::unique_ptr<SpringIntegrator> one = make(name, system), two = make(name, turned);
    run_steps(*one, 2e-3, 10);
    run_steps(*two, 2e-3, 10);
    for (std::size_t n = 0; n < system.node_count(); ++n) {
      const Vec3d expected = quarter_turn(system.pos_mm[n]) + Vec3d(40, -30, 20);
      ASSERT_LT((turned.pos_mm[n] - expected).length(), 1e-6) << name << " node " << n;
    }
    EXPECT_GT((system.pos_mm[40] - bent_sheet(200).pos_mm[40]).length(), 0.1) << name;
  }
}

TEST(ExtremesSpringIntegrators, EnergyStaysBoundedFromSoftToStiff) {
  for (const std::string name : {"implicit", "xpbd", "projective"}) {
    for (const double k : {1.0, 1e2, 1e4, 1e6}) {
      SpringSystem system = bent_sheet(k);
      const double start = energy(system).total_j();
      std::unique_ptr<SpringIntegrator> integrator = make(name, system);
      if (name == "xpbd") integrator = std::make_unique<Xpbd>(system, Xpbd::Params{8, 4});
      double largest = 0;
      for (int frame = 0; frame < 60; ++frame) {
        integrator->step(0.02);
        largest = std::max(largest, energy(system).total_j());
      }
      EXPECT_LT(largest, start) << name << " k " << k;
      EXPECT_LT(energy(system).total_j(), 0.5 * start) << name << " k " << k;
    }
  }
}

TEST(PropertySpringIntegrators, UndampedSymplecticEulerDoesNotDrift) {
  SpringSystem system = bent_sheet(200);
  const double start = energy(system).total_j();
  SymplecticEuler integrator(system);
  std::vector<double> means;
  for (int part = 0; part < 4; ++part) {
    double sum = 0;
    for (int n = 0; n < 1000; ++n) {
      integrator.step(0.3 * integrator.stable_step_s());
      sum += energy(system).total_j();
      ASSERT_NEAR(energy(system).total_j(), start, 0.1 * start);
    }
    means.push_back(sum / 1000);
  }
  for (const double mean : means) EXPECT_NEAR(mean, means.front(), 2e-3 * start);
}

TEST(PropertySpringIntegrators, TheSupportsOfAHangingChainCarryItsWeight) {
  for (const std::string& name : kIntegrators) {
    SpringSystem system = chain(9, 0.01, 500, 10);
    system.gravity_m_s2 = {0, 0, -9.81};
    system.mass_damping_per_s = 8;
    hold(system, 0);
    hold(system, 8);
    for (Spring& s : system.springs) s.damping_n_s_m = 0.2;
    const std::unique_ptr<SpringIntegrator> integrator = make(name, system);
    run_steps(*integrator, 0.005, 600);
    const std::vector<Vec3d>& reaction = integrator->reactions_n();
    ASSERT_EQ(reaction.size(), 2u);
    const double weight = 9 * 0.01 * 9.81;
    EXPECT_NEAR(reaction[0].z + reaction[1].z, -weight, 1e-3 * weight) << name;
    EXPECT_NEAR(reaction[0].z, reaction[1].z, 1e-3 * weight) << name;
    EXPECT_GT(reaction[0].x, 0.5 * weight) << name;
    EXPECT_NEAR(reaction[0].x, -reaction[1].x, 1e-3 * weight) << name;
  }
}

TEST(PropertySpringIntegrators, ADrivenNodeArrivesAndItsHandleFeelsInertia) {
  for (const std::string& name : kIntegrators) {
    SpringSystem system = oscillator(0.5, 0, 0, 10, 0);
    const std::unique_ptr<SpringIntegrator> integrator = make(name, system);
    drive(system, 0, {0, 0, 2});
    integrator->step(0.1);
    EXPECT_EQ(system.pos_mm[0], Vec3d(0, 0, 2)) << name;
    // 0.5 kg from 0 to 20 mm/s in 0.1 s: 0.1 N against the hand; the same again when it stops.
    EXPECT_NEAR(integrator->reactions_n()[0].z, -0.1, 1e-9) << name;
    integrator->step(0.1);
    EXPECT_NEAR(integrator->reactions_n()[0].z, 0.1, 1e-9) << name;
    EXPECT_EQ(system.velocity_mm_s[0], Vec3d(0.0));
  }
}

TEST(ConvergenceSpringIntegrators, SwitchingIntegratorsNeitherJumpsNorDrifts) {
  // Every ten steps another one takes the same system over; a damped sheet comes to the rest that
  // any one of them finds.
  SpringSystem system = bent_sheet(200);
  system.gravity_m_s2 = {0, 0, -9.81};
  system.mass_damping_per_s = 5;
  for (HeldNode& held : system.held) {
    if (held.node % 12 == 11) held.target_mm.x += 1;  // taut, so that there is one state of rest
  }
  SpringSystem alone = system;
  for (int turn = 0; turn < 100; ++turn) {
    const std::vector<Vec3d> pos = system.pos_mm, velocity = system.velocity_mm_s;
    const auto integrator = make(kIntegrators[turn % 4], system);
    ASSERT_EQ(system.pos_mm, pos);
    ASSERT_EQ(system.velocity_mm_s, velocity);
    run_steps(*integrator, 0.005, 10);
  }
  run_steps(*make("implicit", alone), 0.005, 500);
  for (std::size_t n = 0; n < system.node_count(); ++n) {
    ASSERT_LT((system.pos_mm[n] - alone.pos_mm[n]).length(), 0.05) << "node " << n;
  }
}

TEST(PropertySpringIntegrators, ResultsDoNotDependOnTheNumberOfThreads) {
  for (const std::string& name : kIntegrators) {
    std::vector<Vec3d> first;
    for (const int threads : {1, 2, 5}) {
      SpringSystem system = bent_sheet(300);
      on_threads(threads, [&] { run_steps(*make(name, system), 5e-3, 5); });
      if (threads == 1) first = system.pos_mm;
      EXPECT_EQ(system.pos_mm, first) << name;
    }
  }
}

TEST(UnitSpringIntegrators, SettingsThatCannotWorkAreRefused) {
  SpringSystem system = oscillator(1, 1, 0, 1, 0);
  const std::string line = input_error([&] { Xpbd(system, {8, 1}); });
  EXPECT_NE(line.find("two sweeps"), std::string::npos) << line;
  EXPECT_NE(input_error([&] { Xpbd(system, {-1, 2}); }), "");
  EXPECT_NE(input_error([&] { ProjectiveDynamics(system, {0}); }), "");
  EXPECT_NE(input_error([&] { ImplicitEuler(system, {0, 1, 0, 0}); }), "");
  EXPECT_NE(input_error([&] { SymplecticEuler(system, {true, 1, 9}); }), "");
}

TEST(UnitSpringIntegrators, ARunStopsWithinAStepWhenAskedAndLeavesTheLastFinishedOne) {
  struct StopAfter final : Progress {
    void stage(std::string_view) override {}
    void update(double) override { ++updates; }
    bool cancelled() const override { return updates >= 3; }
    int updates = 0;
  } progress;
  SpringSystem system = oscillator(1, 1, 0, 1, 0.1), same = system;
  SymplecticEuler integrator(system), other(same);
  EXPECT_THROW(run_steps(integrator, 0.01, 10, &progress), Cancelled);
  run_steps(other, 0.01, 2);
  EXPECT_EQ(system.pos_mm, same.pos_mm);
  EXPECT_EQ(system.velocity_mm_s, same.velocity_mm_s);
}
