// Times of repeated runs: the sides of a comparison take turns in one process, so that a change of
// the machine's pace meets all of them.
#pragma once

#include <functional>
#include <vector>

#include <nlohmann/json.hpp>

namespace supple::tools {

/// Milliseconds of single runs.
struct Times {
  std::vector<double> ms;

  double median() const { return quantile(0.5); }
  /// Nearest rank; the median of an even number is the mean of the middle two.
  double quantile(double part) const;
  double min() const;
  double max() const;
};

/// Milliseconds that `action` takes.
double time_ms(const std::function<void()>& action);

/// Milliseconds of processor time, all threads of the program together, that `action` takes; other
/// work on the machine hardly counts.
double cpu_time_ms(const std::function<void()>& action);

/// Rounds of a comparison: at least `min_rounds`, then until `budget_ms` are spent.
struct RoundLimits {
  int min_rounds = 3;
  int max_rounds = 100;
  double budget_ms = 500;
};

/// One side of a comparison.
struct TimedSide {
  std::function<void(Times&)> run;  // appends the milliseconds of one or several runs
  int max_runs = 0;                 // 0: as many as there are rounds
  Times times;
};

/// Runs every side once per round. `before_run` is called ahead of each run, and may throw to stop.
void take_turns(std::vector<TimedSide>& sides, const RoundLimits& limits,
                const std::function<void()>& before_run);

/// Adds median_ms, min_ms, max_ms, runs and threads, which every row ends with.
void add_times(nlohmann::ordered_json& row, const Times& times, int threads);

}  // namespace supple::tools
