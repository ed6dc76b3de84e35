#include <algorithm>

#include "tools/lab/bench/ecm/ecm_cases.h"
#include "tools/lab/bench/ecm/ecm_sides.h"

namespace supple::tools {

namespace {

/// Displacements along the direction, in voxels, after a first pull by the amplitude.
///   pull    the voxel goes on, a 1500th of the amplitude per event, and all that it moved follows;
///   wander  each event takes it to the other side of its rest place, 0.9 to 1.1 amplitudes away;
///   anchored  the same with the back half of the head fixed.
std::vector<double> stream_steps(const std::string& script, double amplitude, int events) {
  std::vector<double> steps(std::size_t(events), amplitude / 1500);
  if (script == "pull") return steps;
  double place = amplitude;
  for (int n = 0; n < events; ++n) {
    const double side = n % 2 == 0 ? -1 : 1;
    const double target = side * amplitude * (0.9 + 0.2 * (n * 37 % 101) / 100);
    steps[std::size_t(n)] = target - place;
    place = target;
  }
  return steps;
}

/// The half of the box behind the cheek.
IndexBox back_half(const Body& body) {
  IndexBox half = body.elements.active_bounds();
  half.hi.y = (half.lo.y + half.hi.y) / 2;
  return half;
}

}  // namespace

std::vector<BenchRow> measure_stream(const EcmWorkload& workload, MeasuredBody& measured,
                                     const EcmCaseLimits& limits, Progress& cancel) {
  const Vec3i voxel = cheek_element(measured.body);
  // A steady pull moves more and more: it starts below the wanted number and ends above.
  const std::int64_t wanted = workload.start == "pull" ? workload.wanted * 4 / 5 : workload.wanted;
  const double amplitude = find_amplitude(workload, measured.body, voxel, wanted, cancel);
  const std::vector<double> steps = stream_steps(workload.start, amplitude, limits.stream_events);
  const std::vector<BenchDrag> first = {pull_of(voxel, workload.direction, amplitude)};

  std::vector<BenchRow> rows;
  std::optional<std::uint64_t> checksum;
  for (const EcmSide& side : workload.sides) {
    WarmSide warm = warm_up(side, measured, first, cancel);
    if (workload.start == "anchored") warm.engine->fix(back_half(measured.body));
    Times times, ns_per_moved;
    std::int64_t moved = 0;
    for (const double step : steps) {
      report(&cancel, 0);
      const BenchDrag pull = pull_of(voxel, workload.direction, step);
      times.ms.push_back(timed_pull(*warm.engine, pull, side.threads));
      const std::int64_t moved_now = warm.engine->moved();
      moved += moved_now;
      ns_per_moved.ms.push_back(times.ms.back() * 1e6 /
                                double(std::max<std::int64_t>(1, moved_now)));
    }
    const std::uint64_t end = warm.engine->checksum();
    require_equal_offsets(workload, side, end, checksum.value_or(end));
    checksum = end;
    BenchRow row = row_of(workload, warm, measured.body, moved / std::int64_t(steps.size()),
                          ns_per_moved.median());
    row["event_ms_median"] = times.median();
    row["event_ms_p95"] = times.quantile(0.95);
    add_times(row, times, side.threads);
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace supple::tools
