// Integrators against the analytic damped oscillator, refined.
#include <cmath>

#include <gtest/gtest.h>

#include "lib/springs/implicit_euler.h"
#include "lib/springs/projective.h"
#include "lib/springs/symplectic_euler.h"
#include "lib/springs/xpbd.h"
#include "tests/lib/spring_fixtures.h"

using namespace supple;
using namespace supple::test;

namespace {

/// x'' = -omega^2 x - 2 zeta omega x' from rest at stretch 1 mm, after t seconds.
double damped_oscillation(double omega, double zeta, double t) {
  const double damped = omega * std::sqrt(1 - zeta * zeta);
  return std::exp(-zeta * omega * t) *
         (std::cos(damped * t) + zeta * omega / damped * std::sin(damped * t));
}

/// Errors at the end of 1 s, in mm, with 200, 400, 800 and 1600 steps; then the fitted order.
template <class Integrator>
double order_on_the_oscillator() {
  const double m = 0.05, k = 5, zeta = 0.1, omega = std::sqrt(k / m);
  std::vector<double> errors;
  for (const int steps : {200, 400, 800, 1600}) {
    SpringSystem system = oscillator(m, k, 2 * zeta * omega * m, 20, 1);
    Integrator integrator(system);
    run_steps(integrator, 1.0 / steps, steps);
    errors.push_back(std::abs(system.pos_mm[1].x - 20 - damped_oscillation(omega, zeta, 1)));
    EXPECT_LT(errors.back(), 30.0 / steps);
  }
  for (std::size_t n = 1; n < errors.size(); ++n) {
    EXPECT_NEAR(errors[n - 1] / errors[n], 2, 0.25) << "refinement " << n;
  }
  return std::log2(errors.front() / errors.back()) / 3;
}

}  // namespace

TEST(ConvergenceSprings, SymplecticEulerMeetsTheDampedOscillatorAtOrderOne) {
  EXPECT_NEAR(order_on_the_oscillator<SymplecticEuler>(), 1, 0.1);
}

TEST(ConvergenceSprings, ImplicitEulerMeetsTheDampedOscillatorAtOrderOne) {
  EXPECT_NEAR(order_on_the_oscillator<ImplicitEuler>(), 1, 0.1);
}

TEST(ConvergenceSprings, XpbdMeetsTheDampedOscillatorAtOrderOne) {
  EXPECT_NEAR(order_on_the_oscillator<Xpbd>(), 1, 0.1);
}

TEST(ConvergenceSprings, ProjectiveDynamicsMeetTheDampedOscillatorAtOrderOne) {
  EXPECT_NEAR(order_on_the_oscillator<ProjectiveDynamics>(), 1, 0.1);
}
