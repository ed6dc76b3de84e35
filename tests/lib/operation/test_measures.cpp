// Measures of operations, by hand.
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "tests/lib/operation/operation_fixtures.h"

namespace supple::test {
namespace {

Vec3d stand(double) {
  return Vec3d(0);
}

void add_event(Samples& samples, std::size_t step, const std::string& kind, const std::string& at,
               double value, const std::string& instrument = "needle") {
  OperationSample& sample = samples.at(step);
  sample.events.push_back({sample.time_s, kind, instrument, at, Vec3d(0), value});
}

ScoreRule rule_at(const std::string& measure, const std::string& at) {
  ScoreRule rule = rule_of(measure);
  rule.at = at;
  return rule;
}

TEST(UnitMeasure, NamesAreUniqueAndEachHasAMeaning) {
  std::set<std::string> names;
  for (const MeasureKind& kind : measure_kinds()) {
    EXPECT_TRUE(names.insert(kind.name).second) << kind.name;
    EXPECT_NE(std::string(kind.help), "") << kind.name;
  }
  EXPECT_GE(names.size(), 20u);
}

TEST(UnitMeasure, AnOperationOfOneSampleMeasuresNothing) {
  for (const MeasureKind& kind : measure_kinds()) {
    const double expected = std::string(kind.name) == "clearance_mm" ? kGlobe_mm
                            : std::string(kind.name) == "task_part"  ? 1
                                                                     : 0;
    EXPECT_EQ(measured(samples_of(0, stand), kind.name), expected) << kind.name;
  }
}

TEST(UnitMeasure, ThePathIsTheWayWithoutTremor) {
  const auto straight = [](double time_s) { return Vec3d(2 * std::min(time_s, 10.0), 0, 0); };
  EXPECT_NEAR(measured(samples_of(13, straight), "path_mm"), 20, 1e-4);
  const auto trembling = [&](double time_s) {
    return straight(time_s) + Vec3d(0, 0.5 * std::sqrt(2) * std::sin(56.5 * time_s), 0);
  };
  EXPECT_NEAR(measured(samples_of(13, trembling), "path_mm"), 20, 1);
}

TEST(UnitMeasure, TremorIsTheRootMeanSquareOfACoordinate) {
  const auto trembling = [](double time_s) {
    return Vec3d(1, 1, 1) * (0.2 * std::sqrt(2) * std::sin(56.5 * time_s)) +
           Vec3d(3, 0, 0) * time_s;
  };
  EXPECT_NEAR(measured(samples_of(30, trembling), "tremor_mm"), 0.2, 0.005);
  EXPECT_LT(measured(samples_of(30, [](double t) { return Vec3d(3, 0, 0) * t; }), "tremor_mm"),
            0.02);
}

TEST(UnitMeasure, TouchesThatFollowAtOnceAreOne) {
  Samples samples = samples_of(4, stand);
  for (std::size_t step = 20; step < 30; ++step) add_event(samples, step, "touch", "retina", 0.1);
  add_event(samples, 35, "touch", "retina", 0.3);
  add_event(samples, 100, "touch", "retina", 0.2);
  add_event(samples, 100, "touch", "lens", 0.5);
  add_event(samples, 35, "touch", "lens", 0.4, "pick");
  OperationPlan plan = needle_plan();
  plan.instruments = {"needle", "pick"};
  for (OperationSample& sample : samples) sample.instruments.resize(2);
  EXPECT_EQ(measured(samples, plan, rule_of("touches")), 4);
  EXPECT_EQ(measured(samples, plan, rule_at("touches", "retina")), 2);
  EXPECT_NEAR(measured(samples, plan, rule_at("touch_time_s", "retina")), 12 * kStep_s, 1e-9);
  EXPECT_EQ(measured(samples, plan, rule_at("touch_force_n", "retina")), 0.3);
  EXPECT_EQ(measured(samples, plan, rule_of("touch_force_n")), 0.5);
  ScoreRule pick = rule_of("touches");
  pick.instrument = "pick";
  EXPECT_EQ(measured(samples, plan, pick), 1);
}

TEST(UnitMeasure, AreasLengthsAndCountsOfEventsAdd) {
  Samples samples = samples_of(1, stand);
  add_event(samples, 3, "bleeding", "retina", 0.5, "");
  add_event(samples, 9, "bleeding", "retina", 1.5, "");
  add_event(samples, 9, "edge_torn", "membrane", 0.25);
  add_event(samples, 10, "edge_torn", "membrane", 0.5);
  add_event(samples, 10, "gripped", "membrane", 4);
  add_event(samples, 20, "piece_lost", "membrane", 6, "");
  EXPECT_EQ(measured(samples, "bleedings"), 2);
  EXPECT_EQ(measured(samples, "bleeding_mm2"), 2);
  EXPECT_EQ(measured(samples, "torn_mm"), 0.75);
  EXPECT_EQ(measured(samples, "grips"), 1);
  EXPECT_EQ(measured(samples, "pieces_lost"), 1);
}

TEST(UnitMeasure, DistanceToTheGlobeIsLeastAndNearIsWithinHalfAMillimetre) {
  const Samples samples =
      samples_of(10, [](double time_s) { return Vec3d(0, 0, -11 + std::abs(time_s - 5)); });
  EXPECT_NEAR(measured(samples, "clearance_mm"), 0, 1e-9);
  EXPECT_NEAR(measured(samples, "near_s"), 1, 2 * kStep_s);
}

TEST(UnitMeasure, JawsThatCloseOnNothingAndOpenAgainAreCounted) {
  Samples samples = samples_of(8, stand);
  for (OperationSample& sample : samples) {
    const double beat = std::fmod(sample.time_s, 2);
    sample.instruments[0].pose.opening_degrees = 20 * std::abs(beat - 1);
  }
  add_event(samples, 150, "gripped", "membrane", 3);  // at 3 s, when they close for the second time
  EXPECT_EQ(measured(samples, "empty_grips"), 3);
  for (OperationSample& sample : samples) sample.instruments[0].pose.opening_degrees = 0;
  EXPECT_EQ(measured(samples, "empty_grips"), 0);
}

TEST(UnitMeasure, FocusIsTheMeanDistanceAlongTheView) {
  Samples samples = samples_of(4, [](double time_s) { return Vec3d(9, 9, time_s); });
  EXPECT_NEAR(measured(samples, "out_of_focus_mm"), 2, 0.02);
  for (OperationSample& sample : samples) sample.focus_mm = Vec3d(0, 0, sample.time_s - 0.5);
  EXPECT_NEAR(measured(samples, "out_of_focus_mm"), 0.5, 1e-9);
  OperationPlan plan = needle_plan();
  plan.around.view = Vec3d(2, 0, 0);
  EXPECT_NEAR(measured(samples, plan, rule_of("out_of_focus_mm")), 9, 1e-9);
}

TEST(UnitMeasure, ATipOutsideOfTheLampsConeIsUnlit) {
  OperationPlan plan = needle_plan();
  plan.instruments = {"needle", "lamp"};
  plan.around.lamp = "lamp";
  plan.around.lamp_cone_degrees = 45;
  Samples samples = samples_of(10, [](double time_s) { return Vec3d(time_s, 0, -3); });
  for (OperationSample& sample : samples) sample.instruments.resize(2);
  EXPECT_NEAR(measured(samples, plan, rule_of("unlit_s")), 7, 2 * kStep_s);
  for (OperationSample& sample : samples) sample.instruments[1].pose.axis = Vec3d(0, 0, -1);
  EXPECT_NEAR(measured(samples, plan, rule_of("unlit_s")), 10, 1e-9);
}

TEST(UnitMeasure, ZoomAndFocusCountAsOftenAsTheyAreTurned) {
  Samples samples = samples_of(6, stand);
  for (std::size_t step = 0; step < samples.size(); ++step) {
    OperationSample& sample = samples[step];
    sample.zoom = step < 50 ? 1 : step < 70 ? 1 + 0.01 * double(step - 50) : 1.2;
    if (step > 200) sample.zoom = 2;
    sample.focus_mm.z = step > 100 ? -1 : 0;
    sample.turn_degrees = Vec3d(step == 150 ? 3 : 0, step == 150 ? 4 : 0, 1e-3);
  }
  EXPECT_EQ(measured(samples, "zoom_changes"), 2);
  EXPECT_EQ(measured(samples, "focus_changes"), 1);
  EXPECT_NEAR(measured(samples, "turn_degrees"), 5, 1e-6);
}

TEST(UnitMeasure, SpeedAndIdleTimeAreThoseOfTheSteadyTip) {
  const Samples samples = samples_of(
      10, [](double time_s) { return Vec3d(6 * std::clamp(time_s - 4, 0.0, 2.0), 0, 0); });
  EXPECT_NEAR(measured(samples, "speed_mm_s"), 6, 0.05);
  // It goes on behind the tip by the filter's delay, and below 0.5 mm/s for the rest of it.
  EXPECT_NEAR(measured(samples, "idle_s"), 7.6, 0.3);
}

TEST(UnitMeasure, TimeEndsWithTheLastTaskAndHoldingIsNotIdle) {
  OperationPlan plan = needle_plan();
  plan.tasks = {expert_plan().tasks[0]};
  plan.tasks[0].targets = {{Vec3d(0), 1, 3}};
  const Samples samples = samples_of(10, stand);
  EXPECT_NEAR(measured(samples, plan, rule_of("time_s")), 3, 1e-9);
  EXPECT_NEAR(measured(samples, plan, rule_of("idle_s")), 0, 1e-9);
  EXPECT_NEAR(measured(samples, "idle_s"), 10, 1e-9);
  EXPECT_NEAR(measured(samples, "time_s"), 10, 1e-9);
}

TEST(UnitMeasure, ADetourIsTheWayBeyondStraightLinesBetweenTargets) {
  OperationPlan plan = needle_plan();
  plan.tasks = {expert_plan().tasks[0]};
  plan.tasks[0].targets = {{Vec3d(6, 0, 0), 0.5, 1}, {Vec3d(6, 3, 0), 0.5, 1}};
  const auto corners = [](const std::vector<Vec3d>& way) {
    return samples_of(double(way.size()) * 4, [&](double time_s) {
      const double at = std::min(time_s / 4, double(way.size()) - 1);
      const auto from = std::size_t(at), to = std::min(from + 1, way.size() - 1);
      const double part = std::min(1.0, 2 * (at - double(from)));  // it stands half of the time
      return way[from] + (way[to] - way[from]) * part;
    });
  };
  const Vec3d first(6, 0, 0), second(6, 3, 0), aside(6, 0, 8);
  EXPECT_NEAR(measured(corners({Vec3d(0), first, second}), plan, rule_of("detour_mm")), 0, 0.01);
  const double beyond = 8 + std::sqrt(73) - 3;
  EXPECT_NEAR(measured(corners({Vec3d(0), first, aside, second}), plan, rule_of("detour_mm")),
              beyond, 0.1);
  // What comes after the last target is no detour.
  EXPECT_NEAR(measured(corners({Vec3d(0), first, second, aside}), plan, rule_of("detour_mm")), 0,
              0.01);
}

}  // namespace
}  // namespace supple::test
