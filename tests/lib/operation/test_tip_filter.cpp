// Filters of a tip's motion, against the analytic response of the filters that they follow.
#include <cmath>

#include <gtest/gtest.h>

#include "lib/operation/tip_filter.h"
#include "volumes/base/units.h"

namespace supple::test {
namespace {

/// Ratio of the root mean squares of what comes out and goes in, over whole periods after 4 s.
template <class Filter>
double gain(double hz, double step_s) {
  Filter filter;
  double in = 0, out = 0;
  for (int n = 0; n * step_s < 8; ++n) {
    const double x = std::sin(2 * kPi * hz * n * step_s);
    const double y = filter.take(Vec3d(x, 0, 0), step_s).x;
    if (n * step_s < 4) continue;
    in += x * x;
    out += y * y;
  }
  return std::sqrt(out / in);
}

TEST(ConvergenceTipFilter, GainsGoToTheAnalyticOnesWithTheSquareOfTheStep) {
  // (1 / (1 + (f/f0)^2))^2 of a critically damped filter, twice; f^2 / sqrt(f0^4 + f^4) of
  // Butterworth's high pass.
  const double steady = std::pow(1 / (1 + 1.0), 2), tremor = 25 / std::hypot(16.0, 25.0);
  double steady_before = 0, tremor_before = 0;
  for (const double step_s : {0.02, 0.01, 0.005}) {
    const double steady_error = std::abs(gain<SteadyTip>(2, step_s) - steady);
    const double tremor_error = std::abs(gain<TipTremor>(5, step_s) - tremor);
    if (step_s < 0.02) {
      EXPECT_NEAR(std::log2(steady_before / steady_error), 2, 0.2);
      EXPECT_NEAR(std::log2(tremor_before / tremor_error), 2, 0.2);
    }
    steady_before = steady_error;
    tremor_before = tremor_error;
  }
  EXPECT_LT(steady_before, 1e-3);
  EXPECT_LT(tremor_before, 2e-3);
}

TEST(PropertyTipFilter, TremorOfEightToTenHertzPassesAndTheSteadyTipKeepsLittleOfIt) {
  for (const double hz : {8.0, 9.0, 10.0}) {
    EXPECT_NEAR(gain<TipTremor>(hz, 0.02), 1, 0.05) << hz;
    EXPECT_LT(gain<SteadyTip>(hz, 0.02), 1 / 280.0) << hz;
  }
}

TEST(PropertyTipFilter, ConstantSpeedLeavesNoTremorAndTheSteadyTipFollowsLater) {
  SteadyTip steady;
  TipTremor tremor;
  Vec3d place, rest;
  for (int n = 0; n <= 500; ++n) {
    place = steady.take(Vec3d(0.02 * n * 7, 0, 0), 0.02);
    rest = tremor.take(Vec3d(0.02 * n * 7, 0, 0), 0.02);
  }
  EXPECT_NEAR(rest.length(), 0, 1e-9);
  EXPECT_NEAR((70 - place.x) / 7, 2 / kPi / 2, 1e-6);  // two filters, each late by 1 / (pi f0)
}

TEST(PropertyTipFilter, TheSteadyTipNeverOvershoots) {
  SteadyTip steady;
  steady.take(Vec3d(0), 0.02);
  double before = 0;
  for (int n = 0; n < 200; ++n) {
    const double x = steady.take(Vec3d(1, 0, 0), 0.02).x;
    EXPECT_GE(x, before);
    EXPECT_LE(x, 1 + 1e-12);
    before = x;
  }
  EXPECT_NEAR(before, 1, 1e-6);
}

TEST(PropertyTipFilter, StepsOfAnyLengthGiveTheSameMotion) {
  const auto end_of = [](const std::vector<double>& steps) {
    SteadyTip steady;
    double time_s = 0;
    Vec3d place = steady.take(Vec3d(0), 0);
    for (int n = 0; time_s < 2 - 1e-9; ++n) {
      const double step_s = steps[std::size_t(n) % steps.size()];
      time_s += step_s;
      place = steady.take(Vec3d(std::sin(time_s), 0, 0), step_s);
    }
    return place.x;
  };
  EXPECT_NEAR(end_of({0.02}), end_of({0.005, 0.01, 0.025}), 1e-3);
}

TEST(ExtremesTipFilter, AStepThatIsTooLongBeginsAnew) {
  SteadyTip steady;
  TipTremor tremor;
  steady.take(Vec3d(0), 0);
  tremor.take(Vec3d(0), 0);
  EXPECT_EQ(steady.take(Vec3d(5, 0, 0), 3), Vec3d(5, 0, 0));
  EXPECT_EQ(tremor.take(Vec3d(5, 0, 0), 3), Vec3d(0));
}

}  // namespace
}  // namespace supple::test
