#include "lib/operation/score.h"

#include <algorithm>
#include <numeric>

#include "volumes/base/error.h"
#include "volumes/base/text.h"

namespace supple {

namespace {

const char* const kCategoryTitles[kScoreCategories] = {"tissue treatment", "efficiency",
                                                       "target achievement", "instrument handling",
                                                       "microscope handling"};

void require_known(const std::string& name, const std::vector<std::string>& names,
                   const ScoreRule& rule, const char* key) {
  if (!name.empty()) index_of_name(name, names, rule.place, key);
}

/// One number of all instruments that a rule looks at: sums are added, the worst one counts else.
double joined(const MeasureKind& kind, const std::vector<GatheredMeasure>& parts) {
  double value = 0;
  for (std::size_t n = 0; n < parts.size(); ++n) {
    const double one = parts[n].value();
    if (n == 0 || kind.gather == Gather::sum) {
      value += one;
    } else {
      value = kind.is_wanted ? std::min(value, one) : std::max(value, one);
    }
  }
  return value;
}

double points_taken(const ScoreRule& rule, const MeasureKind& kind, double measured) {
  const double beyond = kind.is_wanted ? rule.allowed - measured : measured - rule.allowed;
  return std::clamp(beyond * rule.points_per_unit, 0.0, rule.most);
}

}  // namespace

double OperationScore::total() const {
  return std::accumulate(points.begin(), points.end(), 0.0);
}

Value to_value(const OperationScore& score) {
  Value report;
  report["total"] = score.total();
  for (int category = 0; category < kScoreCategories; ++category) {
    Value& part = report["categories"][category_keys()[std::size_t(category)]];
    part["title"] = kCategoryTitles[category];
    part["points"] = score.points[std::size_t(category)];
    part["rules"] = Value::List();
    for (const RuleOutcome& outcome : score.rules) {
      if (int(outcome.rule.category) != category) continue;
      const MeasureKind& kind = measure_kind(outcome.rule.measure);
      Value row = to_value(outcome.rule);
      row.erase("category");
      row["means"] = kind.help;
      row["unit"] = kind.unit;
      row["measured"] = outcome.measured;
      row["taken"] = outcome.taken;
      part["rules"].push_back(std::move(row));
    }
  }
  report["tasks"] = Value::List();
  for (const TaskOutcome& task : score.tasks) {
    Value row;
    row["name"] = task.name;
    row["progress"] = task.progress;
    if (task.done_s) row["done_s"] = *task.done_s;
    report["tasks"].push_back(std::move(row));
  }
  return report;
}

ScoreKeeper::ScoreKeeper(const OperationPlan& plan) : m_tips(plan.instruments.size()) {
  for (const TaskSetup& task : plan.tasks) {
    m_tasks.emplace_back(task, plan.instruments);
    if (!task.body.empty()) index_of_name(task.body, plan.places, task.place, "task.body");
  }
  const std::string& lamp = plan.around.lamp;
  const int lamp_index = lamp.empty() ? -1 : index_of_name(lamp, plan.instruments, "", "lamp");
  for (const ScoreRule& rule : plan.rules) add_rule(plan, rule, lamp_index);
}

void ScoreKeeper::add_rule(const OperationPlan& plan, const ScoreRule& rule, int lamp) {
  const MeasureKind& kind = measure_kind(rule.measure);
  require_known(rule.instrument, plan.instruments, rule, "score.instrument");
  require_known(rule.at, plan.places, rule, "score.at");
  if (kind.needs_globe && plan.around.globe_radius_mm <= 0) {
    throw InputError({rule.place, "score.measure", rule.measure + " without a globe",
                      "another measure, or a scene with a globe"});
  }
  Measured measured{rule, {}};
  MeasureScope scope{-1, rule.instrument, rule.at, lamp, plan.around};
  if (kind.of != MeasureOf::tip) {
    measured.parts.emplace_back(kind, scope);
  } else {
    for (int tool = 0; tool < int(plan.instruments.size()); ++tool) {
      const std::string& name = plan.instruments[std::size_t(tool)];
      if (rule.instrument.empty() ? tool == lamp : name != rule.instrument) continue;
      scope.tool = tool;
      scope.instrument = name;
      measured.parts.emplace_back(kind, scope);
    }
  }
  m_rules.push_back(std::move(measured));
}

std::vector<TipMotion> ScoreKeeper::move_tips(const OperationSample& sample, double dt_s) {
  require(sample.instruments.size() == m_tips.size(), "instruments",
          double(sample.instruments.size()), with_count(std::int64_t(m_tips.size()), "instrument"));
  std::vector<TipMotion> tips(m_tips.size());
  for (std::size_t n = 0; n < tips.size(); ++n) {
    TipFilters& filters = m_tips[n];
    TipMotion& tip = tips[n];
    tip.tip_mm = sample.instruments[n].pose.tip_mm;
    tip.steady_mm = filters.steady.take(tip.tip_mm, dt_s);
    if (m_before_s) tip.way_mm = tip.steady_mm - filters.before_mm;
    tip.tremor_mm = filters.tremor.take(sample.instruments[n].asked.tip_mm, dt_s);
    filters.before_mm = tip.steady_mm;
  }
  return tips;
}

std::vector<OperationEvent> ScoreKeeper::take(const OperationSample& sample) {
  const double dt_s = sample.time_s - m_before_s.value_or(sample.time_s);
  require(dt_s >= 0, "time_s", sample.time_s, "a time that is not before the last one");
  OperationStep step{sample, dt_s, move_tips(sample, dt_s), {}, 0, !m_tasks.empty(), false};
  m_before_s = sample.time_s;
  for (TaskWatcher& task : m_tasks) {
    for (OperationEvent& event : task.take(sample)) step.task_events.push_back(std::move(event));
    step.task_part += task.progress() / double(m_tasks.size());
    step.is_done &= task.is_done();
    step.holds_target |= task.holds_target();
  }
  if (m_tasks.empty() || step.is_done) step.task_part = 1;
  for (Measured& measured : m_rules) {
    for (GatheredMeasure& part : measured.parts) part.take(step);
  }
  return std::move(step.task_events);
}

OperationScore ScoreKeeper::score() const {
  OperationScore score;
  score.points.fill(100);
  for (const Measured& measured : m_rules) {
    const MeasureKind& kind = measure_kind(measured.rule.measure);
    RuleOutcome outcome{measured.rule, joined(kind, measured.parts), 0};
    outcome.taken = points_taken(measured.rule, kind, outcome.measured);
    double& points = score.points[std::size_t(measured.rule.category)];
    points = std::max(0.0, points - outcome.taken);
    score.rules.push_back(std::move(outcome));
  }
  for (const TaskWatcher& task : m_tasks) {
    score.tasks.push_back({task.setup().name, task.progress(), task.done_s()});
  }
  return score;
}

}  // namespace supple
