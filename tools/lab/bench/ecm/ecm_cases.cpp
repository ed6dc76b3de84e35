#include "tools/lab/bench/ecm/ecm_cases.h"

#include <algorithm>

#include "tools/lab/bench/ecm/ecm_sides.h"

namespace supple::tools {

namespace {

std::vector<WarmSide> warm_up_all(const EcmWorkload& workload, MeasuredBody& measured,
                                  const std::vector<BenchDrag>& script, Progress& cancel) {
  std::vector<WarmSide> sides;
  for (const EcmSide& side : workload.sides) {
    sides.push_back(warm_up(side, measured, script, cancel));
    const std::int64_t nodes = measured.body.elements.active_count();
    if (workload.kind == "all" && sides.back().moved != nodes) {
      throw Error(row_name(workload, side) + ": found " + std::to_string(sides.back().moved) +
                  " moved elements, expected all " + std::to_string(nodes));
    }
    require_equal_offsets(workload, side, sides.back().checksum, sides.front().checksum);
  }
  return sides;
}

/// One side's pulls in each round; `ns_per_moved` gets the time per moved element of each pull.
TimedSide timed_side(WarmSide& warm, const Motion& motion, const EcmCaseLimits& limits,
                     std::int64_t nodes, Times& ns_per_moved) {
  TimedSide side;
  side.run = [&](Times& times) {
    if (motion.from_rest) warm.engine->reset();
    for (const BenchDrag& pull : motion.cycle) {
      times.ms.push_back(timed_pull(*warm.engine, pull, warm.side.threads));
      ns_per_moved.ms.push_back(times.ms.back() * 1e6 / double(warm.engine->moved()));
    }
  };
  if (warm.side.engine != "multiset") return side;
  side.max_runs = limits.multiset_runs;
  if (nodes >= limits.multiset_repeats_below) {
    side.max_runs = 1;
    side.times.ms = {warm.last_ms};
  }
  return side;
}

std::vector<BenchRow> measure_motion(const EcmWorkload& workload, MeasuredBody& measured,
                                     const Motion& motion, const EcmCaseLimits& limits,
                                     Progress& cancel) {
  std::vector<WarmSide> warm = warm_up_all(workload, measured, motion.script, cancel);
  const std::int64_t nodes = measured.body.elements.active_count();
  std::vector<Times> ns_per_moved(warm.size());
  std::vector<TimedSide> sides;
  for (std::size_t n = 0; n < warm.size(); ++n) {
    sides.push_back(timed_side(warm[n], motion, limits, nodes, ns_per_moved[n]));
  }
  RoundLimits rounds = limits.rounds;
  rounds.max_rounds = std::clamp(motion.max_cycles / int(sides.size()), 1, rounds.max_rounds);
  take_turns(sides, rounds, [&] { report(&cancel, 0); });

  std::vector<BenchRow> rows;
  for (std::size_t n = 0; n < sides.size(); ++n) {
    const double ns = workload.kind == "local" ? ns_per_moved[n].median()
                                               : sides[n].times.median() * 1e6 / double(nodes);
    BenchRow row = row_of(workload, warm[n], measured.body, warm[n].moved, ns);
    add_times(row, sides[n].times, warm[n].side.threads);
    rows.push_back(std::move(row));
  }
  return rows;
}

/// Adds how many times `supple` is faster than the other sides with one thread.
void add_speedups(std::vector<BenchRow>& rows) {
  for (BenchRow& row : rows) {
    if (row["engine"] != "supple") continue;
    for (const BenchRow& other : rows) {
      const std::string engine = other["engine"];
      const bool is_same = engine == "supple";
      if (other["threads"] != 1 || (is_same && row["threads"] == 1)) continue;
      row["times_" + (is_same ? "one_thread" : engine)] =
          other["median_ms"].get<double>() / row["median_ms"].get<double>();
    }
  }
}

std::vector<BenchRow> measure_sides(const EcmWorkload& workload, MeasuredBody& measured,
                                    const EcmCaseLimits& limits, Progress& cancel) {
  if (workload.kind == "ball") return measure_ball(workload, measured, limits, cancel);
  if (workload.kind == "links") return measure_links(workload, measured, limits, cancel);
  if (workload.kind == "stream") return measure_stream(workload, measured, limits, cancel);
  if (workload.kind == "all") {
    return measure_motion(workload, measured, motion_of_all(workload, measured.body), limits,
                          cancel);
  }
  const Vec3i voxel = middle_element(measured.body);
  const double amplitude = find_amplitude(workload, measured.body, voxel, workload.wanted, cancel);
  return measure_motion(workload, measured, local_motion(workload, voxel, amplitude), limits,
                        cancel);
}

}  // namespace

std::vector<BenchRow> measure_workload(const EcmWorkload& workload, MeasuredBody& measured,
                                       const EcmCaseLimits& limits, Progress& cancel) {
  std::vector<BenchRow> rows = measure_sides(workload, measured, limits, cancel);
  add_speedups(rows);
  return rows;
}

}  // namespace supple::tools
