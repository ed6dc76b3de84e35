#include "tools/lab/bench/report/timing.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <numeric>

#include "volumes/base/stopwatch.h"

namespace supple::tools {

double Times::quantile(double part) const {
  std::vector<double> sorted = ms;
  std::sort(sorted.begin(), sorted.end());
  const std::size_t count = sorted.size();
  if (part == 0.5 && count % 2 == 0) return (sorted[count / 2 - 1] + sorted[count / 2]) / 2;
  const double rank = std::ceil(part * double(count));
  return sorted[std::size_t(std::clamp(rank, 1.0, double(count))) - 1];
}

double Times::min() const {
  return *std::min_element(ms.begin(), ms.end());
}
double Times::max() const {
  return *std::max_element(ms.begin(), ms.end());
}

double time_ms(const std::function<void()>& action) {
  const auto begin = std::chrono::steady_clock::now();
  action();
  return ms_since(begin);
}

double cpu_time_ms(const std::function<void()>& action) {
  const auto now_ms = [] {
    std::timespec now{};
    ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return double(now.tv_sec) * 1e3 + double(now.tv_nsec) * 1e-6;
  };
  const double begin = now_ms();
  action();
  return now_ms() - begin;
}

void take_turns(std::vector<TimedSide>& sides, const RoundLimits& limits,
                const std::function<void()>& before_run) {
  double spent_ms = 0;
  for (int round = 0; round < limits.max_rounds; ++round) {
    if (round >= limits.min_rounds && spent_ms >= limits.budget_ms) break;
    for (TimedSide& side : sides) {
      if (side.max_runs > 0 && int(side.times.ms.size()) >= side.max_runs) continue;
      before_run();
      const std::size_t first = side.times.ms.size();
      side.run(side.times);
      spent_ms = std::accumulate(side.times.ms.begin() + std::ptrdiff_t(first), side.times.ms.end(),
                                 spent_ms);
    }
  }
}

void add_times(nlohmann::ordered_json& row, const Times& times, int threads) {
  row["median_ms"] = times.median();
  row["min_ms"] = times.min();
  row["max_ms"] = times.max();
  row["runs"] = times.ms.size();
  row["threads"] = threads;
}

}  // namespace supple::tools
