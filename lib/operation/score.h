// Tasks and scores of an operation, from its samples alone, so that a log replays to the same
// score. Categories as in published studies of EyeSi; 100 points each, rules take points off.
//
// Per step: OperationSample goes to ScoreKeeper::take(), which returns the events of tasks; these
// join the sample's events, and OperationLog (operation_log.h) writes it.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "lib/operation/measure.h"
#include "lib/operation/operation_sample.h"
#include "lib/operation/score_rule.h"
#include "lib/operation/task.h"
#include "volumes/base/value.h"

namespace supple {

/// All that a score depends on beside the samples.
struct OperationPlan {
  std::vector<std::string> instruments;  // in the order of the samples
  std::vector<std::string> places;       // obstacles and membranes that a rule may name
  std::vector<TaskSetup> tasks;
  std::vector<ScoreRule> rules = default_score_rules();
  OperationSurroundings around;
};
/// Throws InputError: unknown keys, values that are not allowed.
OperationPlan read_plan(Table& table);
/// The table from which read_plan() reads the same.
Value to_value(const OperationPlan& plan);

struct RuleOutcome {
  ScoreRule rule;
  double measured = 0;
  double taken = 0;  // points
};

struct TaskOutcome {
  std::string name;
  double progress = 0;           // 0 to 1
  std::optional<double> done_s;  // when, where it is done
};

struct OperationScore {
  std::array<double, kScoreCategories> points{};  // 0 to 100 by ScoreCategory
  std::vector<RuleOutcome> rules;
  std::vector<TaskOutcome> tasks;
  double total() const;
};
/// The report for a teacher: points of each category, and for each rule what was measured, what is
/// allowed, and the points that it took.
Value to_value(const OperationScore& score);

class ScoreKeeper {
 public:
  /// Throws InputError for names of a task or rule that the plan does not have.
  explicit ScoreKeeper(const OperationPlan& plan);

  /// Returns the events of tasks in this step. Events of tasks that the sample already has, as
  /// those of a log, do not count. Throws InputError for a sample with other instruments than the
  /// plan's, or of a time before the last one.
  std::vector<OperationEvent> take(const OperationSample& sample);

  const std::vector<TaskWatcher>& tasks() const { return m_tasks; }
  /// The score of the steps so far.
  OperationScore score() const;

 private:
  /// A rule, measured for each instrument that it looks at.
  struct Measured {
    ScoreRule rule;
    std::vector<GatheredMeasure> parts;
  };
  /// Filters of one instrument's tip.
  struct TipFilters {
    SteadyTip steady;
    TipTremor tremor;
    Vec3d before_mm{0, 0, 0};
  };
  void add_rule(const OperationPlan& plan, const ScoreRule& rule, int lamp);
  std::vector<TipMotion> move_tips(const OperationSample& sample, double dt_s);

  std::vector<TaskWatcher> m_tasks;
  std::vector<Measured> m_rules;
  std::vector<TipFilters> m_tips;
  std::optional<double> m_before_s;
};

}  // namespace supple
