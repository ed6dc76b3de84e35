// Scores: what an expert loses by tremor, a touch and a detour, the report, and the rules.
#include <gtest/gtest.h>

#include "lib/operation/score.h"
#include "tests/lib/operation/operation_fixtures.h"
#include "tests/support/errors.h"
#include "volumes/base/error.h"
#include "volumes/base/json.h"

namespace supple::test {
namespace {

using Points = std::array<double, kScoreCategories>;

Points points_of(const Expert& expert) {
  return score_of(expert_plan(), expert_samples(expert)).points;
}

/// At least 20 points in one category, and at most 10 in each other one.
void expect_lost_in(ScoreCategory category, const Points& expert, const Points& other) {
  for (int c = 0; c < kScoreCategories; ++c) {
    const double lost = expert[std::size_t(c)] - other[std::size_t(c)];
    const std::string& name = category_keys()[std::size_t(c)];
    if (c == int(category)) {
      EXPECT_GE(lost, 20) << name;
      EXPECT_LT(lost, 80) << name << ": all the same whatever comes beside it";
    } else {
      EXPECT_LE(lost, 10) << name;
      EXPECT_GE(lost, -1e-9) << name;
    }
  }
}

TEST(PropertyScore, AnExpertLosesNearlyNothing) {
  for (const double points : points_of({})) EXPECT_GE(points, 98);
}

TEST(PropertyScore, FiveTimesTheTremorCostsInstrumentHandlingAndLittleElse) {
  Expert trembling;
  trembling.tremor_mm = 0.5;
  expect_lost_in(ScoreCategory::instruments, points_of({}), points_of(trembling));
}

TEST(PropertyScore, ATouchOfTheRetinaCostsTissueTreatmentAndLittleElse) {
  Expert touching;
  touching.touches = true;
  expect_lost_in(ScoreCategory::tissue, points_of({}), points_of(touching));
}

TEST(PropertyScore, ADetourCostsEfficiencyAndLittleElse) {
  Expert wandering;
  wandering.rounds = 2;
  expect_lost_in(ScoreCategory::efficiency, points_of({}), points_of(wandering));
}

TEST(UnitScore, ARuleTakesPointsPerUnitBeyondWhatIsAllowedAndNoMoreThanItMay) {
  OperationPlan plan = needle_plan();
  ScoreRule time = rule_of("time_s");
  time.allowed = 4;
  time.points_per_unit = 3;
  time.most = 15;
  plan.rules = {time};
  const auto efficiency = [&](double seconds) {
    return score_of(plan, samples_of(seconds, [](double) { return Vec3d(0); })).points[1];
  };
  EXPECT_EQ(efficiency(4), 100);
  EXPECT_NEAR(efficiency(6), 94, 1e-9);
  EXPECT_EQ(efficiency(60), 85);
}

TEST(UnitScore, WhatIsWantedTakesPointsWhereItFallsShort) {
  OperationPlan plan = needle_plan();
  ScoreRule clearance = rule_of("clearance_mm");
  clearance.allowed = 2;
  clearance.points_per_unit = 10;
  plan.rules = {clearance};
  const auto tissue = [&](double height_mm) {
    return score_of(plan, samples_of(1, [&](double) { return Vec3d(0, 0, height_mm); })).points[0];
  };
  EXPECT_EQ(tissue(5), 100);
  EXPECT_NEAR(tissue(10), 90, 1e-9);
}

TEST(UnitScore, ACategoryNeverGoesBelowZero) {
  OperationPlan plan = needle_plan();
  for (int n = 0; n < 3; ++n) {
    plan.rules.push_back(rule_of("time_s"));
    plan.rules.back().points_per_unit = 50;
  }
  const OperationScore score = score_of(plan, samples_of(5, [](double) { return Vec3d(0); }));
  EXPECT_EQ(score.points[1], 0);
  EXPECT_EQ(score.total(), 400);
}

TEST(UnitScore, TheReportSaysWhatEachRuleMeasuredAndTook) {
  Expert touching;
  touching.touches = true;
  const OperationScore score = score_of(expert_plan(), expert_samples(touching));
  const Value report = to_value(score);
  EXPECT_EQ(report["total"].number(), score.total());
  double taken = 0;
  bool has_touches = false;
  for (const Value& row : report["categories"]["tissue"]["rules"].items()) {
    taken += row["taken"].number();
    if (row["measure"].text() != "touches") continue;
    has_touches = true;
    EXPECT_EQ(row["measured"].number(), 1);
    EXPECT_EQ(row["taken"].number(), 25);
    EXPECT_EQ(row["means"].text(), "Touches of an obstacle");
  }
  EXPECT_TRUE(has_touches);
  EXPECT_NEAR(report["categories"]["tissue"]["points"].number(), 100 - taken, 1e-9);
  EXPECT_EQ(report["tasks"][0]["progress"].number(), 1);
  EXPECT_GT(report["tasks"][0]["done_s"].number(), 10);
}

TEST(UnitScore, TipsOfAllInstrumentsButTheLampCountWhereARuleNamesNone) {
  OperationPlan plan = needle_plan();
  plan.instruments = {"lamp", "needle", "pick"};
  Samples samples = samples_of(10, [](double) { return Vec3d(0); });
  for (OperationSample& sample : samples) {
    sample.instruments.resize(3);
    for (int tool = 0; tool < 3; ++tool) {
      sample.instruments[std::size_t(tool)].pose.tip_mm.x = (tool + 1) * sample.time_s;
    }
  }
  ScoreRule path = rule_of("path_mm"), speed = rule_of("speed_mm_s");
  EXPECT_NEAR(measured(samples, plan, path), 60, 2.1);
  plan.around.lamp = "lamp";
  EXPECT_NEAR(measured(samples, plan, path), 50, 1.8);
  EXPECT_NEAR(measured(samples, plan, speed), 3, 1e-6);
  path.instrument = "lamp";
  EXPECT_NEAR(measured(samples, plan, path), 10, 0.4);
}

TEST(UnitScore, RulesAreReadWithTheUsualCategoryOfTheirMeasure) {
  Table scene = Table::parse(
      "[[score]]\nmeasure = \"touches\"\nat = \"lens\"\npoints = 10\nmost = 30\n"
      "[[score]]\nmeasure = \"path_mm\"\ncategory = \"instruments\"\nallowed = 40\n",
      "scene.toml");
  const std::vector<ScoreRule> rules = read_score_rules(scene);
  ASSERT_EQ(rules.size(), 2u);
  EXPECT_EQ(rules[0].category, ScoreCategory::tissue);
  EXPECT_EQ(rules[0].at, "lens");
  EXPECT_EQ(rules[0].points_per_unit, 10);
  EXPECT_EQ(rules[0].most, 30);
  EXPECT_EQ(rules[1].category, ScoreCategory::instruments);
  EXPECT_EQ(rules[1].allowed, 40);
}

TEST(UnitScore, ASceneWithoutRulesHasTheDefaultOnesOfAllCategories) {
  Table scene = Table::parse("", "scene.toml");
  std::array<int, kScoreCategories> count{};
  for (const ScoreRule& rule : read_score_rules(scene)) ++count[std::size_t(rule.category)];
  for (const int one : count) EXPECT_GE(one, 2);
  Table none = Table::parse("score = []", "scene.toml");
  EXPECT_TRUE(read_score_rules(none).empty());
}

TEST(UnitScore, APlanReadsBackAsItWasWritten) {
  OperationPlan plan = expert_plan();
  plan.around.lamp = "needle";
  plan.rules.push_back(rule_of("touches"));
  plan.rules.back().at = "retina";
  const std::string text = json_text(to_value(plan));
  Table table(parse_json(text));
  EXPECT_EQ(json_text(to_value(read_plan(table))), text);
}

TEST(FaultScore, RulesThatCannotBeMeasuredAreRefusedWithTheirLine) {
  const auto failure = [](const std::string& keys) {
    return input_error([&] {
      Table scene = Table::parse("[[score]]\n" + keys, "scene.toml");
      OperationPlan plan = needle_plan();
      plan.rules = read_score_rules(scene);
      plan.around.globe_radius_mm = 0;
      ScoreKeeper keeper(plan);
    });
  };
  EXPECT_EQ(failure("measure = \"touches\"\nat = \"retina\""), "");
  const std::string unknown = failure("measure = \"touchs\"");
  EXPECT_NE(unknown.find("scene.toml:2: score[1].measure: found \"touchs\""), std::string::npos)
      << unknown;
  EXPECT_EQ(failure("measure = \"time_s\"\nat = \"lens\""),
            "scene.toml:3: score[1].at: found \"lens\", expected no place, since time_s has none");
  EXPECT_EQ(failure("measure = \"turn_degrees\"\ninstrument = \"needle\""),
            "scene.toml:3: score[1].instrument: found \"needle\", expected no instrument, since "
            "turn_degrees has none");
  EXPECT_EQ(failure("measure = \"touches\"\nat = \"retna\""),
            "scene.toml:1: score.at: found \"retna\", expected retina, lens or membrane");
  EXPECT_EQ(failure("measure = \"path_mm\"\ninstrument = \"pick\""),
            "scene.toml:1: score.instrument: found \"pick\", expected needle");
  EXPECT_EQ(failure("measure = \"near_s\""),
            "scene.toml:1: score.measure: found near_s without a globe, expected another measure, "
            "or a scene with a globe");
  EXPECT_NE(failure("measure = \"time_s\"\npoint = 3").find("score[1].point"), std::string::npos);
  EXPECT_NE(failure("measure = \"time_s\"\nmost = 101").find("expected 0 to 100"),
            std::string::npos);
}

TEST(FaultScore, SamplesThatGoBackInTimeOrHaveOtherInstrumentsAreRefused) {
  ScoreKeeper keeper(needle_plan());
  Samples samples = samples_of(0.1, [](double) { return Vec3d(0); });
  keeper.take(samples[2]);
  EXPECT_NE(input_error([&] { keeper.take(samples[1]); }).find("time_s: found 0.02"),
            std::string::npos);
  samples[3].instruments.resize(2);
  EXPECT_NE(input_error([&] { keeper.take(samples[3]); }).find("found 2, expected 1 instrument"),
            std::string::npos);
}

}  // namespace
}  // namespace supple::test
