#include "lib/operation/score_rule.h"

namespace supple {

Fields fields(ScoreRule& rule) {
  return {
      Field("measure", rule.measure, "What takes points off").one_of(measure_names()).required(),
      Field("category", rule.category, category_keys(), "Of 100 points, from which they go")
          .otherwise("the usual one of the measure"),
      Field("instrument", rule.instrument, "Instrument that is looked at")
          .otherwise("all, but the lamp for tips"),
      Field("at", rule.at, "Obstacle or membrane").otherwise("all"),
      Field("allowed", rule.allowed, "How much costs nothing"),
      Field("points", rule.points_per_unit, "Points per unit beyond it").at_least(0),
      Field("most", rule.most, "Points that the rule takes at most").range(0, 100),
  };
}

namespace {

/// An expert's steady hand trembles by some 0.1 mm (thesis section 6.1.2), so 0.12 mm are free.
struct DefaultRule {
  const char* measure;
  double allowed, points_per_unit, most;
};
constexpr DefaultRule kDefaultRules[] = {
    {"touches", 0, 25, 75},     {"touch_force_n", 0.01, 250, 25}, {"bleeding_mm2", 0, 10, 50},
    {"torn_mm", 5, 2, 20},      {"time_s", 180, 0.2, 50},         {"path_mm", 150, 0.25, 50},
    {"detour_mm", 10, 2, 50},   {"idle_s", 60, 0.2, 20},          {"task_part", 1, 100, 100},
    {"targets_lost", 2, 2, 20}, {"tremor_mm", 0.12, 200, 50},     {"speed_mm_s", 25, 1, 20},
    {"empty_grips", 2, 5, 30},  {"turn_degrees", 15, 1, 20},      {"out_of_focus_mm", 2, 10, 40},
    {"unlit_s", 5, 1, 40},      {"zoom_changes", 5, 2, 10},
};

ScoreRule read_rule(Table& table) {
  ScoreRule rule;
  rule.place = table.place();
  // The measure comes first: its usual category stands where the table names none.
  ScoreRule named;
  table.read(fields(named));
  const MeasureKind& kind = measure_kind(named.measure);
  rule.category = kind.category;
  table.read(fields(rule));
  table.finish();
  if (!rule.at.empty() && kind.of != MeasureOf::places) {
    table.fail("at", "\"" + rule.at + "\"", "no place, since " + rule.measure + " has none");
  }
  if (!rule.instrument.empty() && kind.of == MeasureOf::operation) {
    table.fail("instrument", "\"" + rule.instrument + "\"",
               "no instrument, since " + rule.measure + " has none");
  }
  return rule;
}

}  // namespace

std::vector<ScoreRule> default_score_rules() {
  std::vector<ScoreRule> rules;
  for (const DefaultRule& row : kDefaultRules) {
    ScoreRule rule;
    rule.measure = row.measure;
    rule.category = measure_kind(row.measure).category;
    rule.allowed = row.allowed;
    rule.points_per_unit = row.points_per_unit;
    rule.most = row.most;
    rules.push_back(std::move(rule));
  }
  return rules;
}

std::vector<ScoreRule> read_score_rules(Table& scene) {
  if (!scene.has("score")) return default_score_rules();
  std::vector<ScoreRule> rules;
  for (Table& row : scene.tables("score")) rules.push_back(read_rule(row));
  return rules;
}

Value to_value(const ScoreRule& rule) {
  ScoreRule copy = rule;
  return fields_value(fields(copy));
}

}  // namespace supple
