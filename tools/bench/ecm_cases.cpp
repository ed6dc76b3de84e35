#include "tools/bench/ecm_cases.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include <oneapi/tbb/global_control.h>

#include "lib/body/lattice.h"
#include "tools/bench/memory.h"

namespace supple::tools {

namespace {

/// The largest slack of a link in any of the benchmark's materials, in voxels.
constexpr double kLargestSlack = 0.7;
/// Displacements add up to less than the engine's range.
constexpr double kRangeVoxels = 16000;
/// Smaller bodies drown in the pages that any program touches.
constexpr std::int64_t kPeakFromNodes = 1'000'000;

/// What a workload does with its body, in pulls.
struct Motion {
  std::vector<Pull> script;  // from rest: warms up, shows memory, and must end alike for all sides
  std::vector<Pull> cycle;   // what is timed
  bool from_rest = false;    // each cycle, or else goes on from where the body is
  int max_cycles = 100;      // of all sides together, for the range
};

/// A side after its script.
struct Warm {
  EcmSide side;
  std::unique_ptr<EcmEngine> engine;
  std::int64_t bytes = 0;
  std::optional<std::int64_t> peak_bytes;
  std::int64_t moved = 0;
  std::uint64_t checksum = 0;
  double last_ms = 0;
};

Vec3i direction_of(const std::string& name) {
  if (name == "-x") return {-1, 0, 0};
  if (name == "+y") return {0, 1, 0};
  return {1, name == "xy" || name == "xyz", name == "xyz"};
}

Pull pull_of(const Vec3i& voxel, const std::string& direction, double voxels) {
  Pull pull{voxel, {}};
  for (int c = 0; c < 3; ++c) {
    pull.by_q[c] = direction_of(direction)[c] * std::int32_t(voxels * kFixedOne);
  }
  return pull;
}

double timed_pull(EcmEngine& engine, const Pull& pull, int threads) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  std::size_t(threads));
  return time_ms([&] { engine.pull(pull); });
}

/// The element nearest to the middle of the body's box.
Vec3i middle_element(const Body& body) {
  const IndexBox& bounds = body.elements.active_bounds();
  Vec3i voxel = (bounds.lo + bounds.hi + Vec3i(1)) / 2;
  if (!body.elements.is_active(voxel)) nearest_element(body, voxel, voxel);
  return voxel;
}

/// The foremost element (largest j) on the cheek of a head that fills the box.
Vec3i cheek_element(const Body& body) {
  const Vec3i& dims = body.geometry.dims();
  Vec3i voxel(dims.x * 2 / 3, dims.y - 1, dims.z / 6);
  while (voxel.y > 0 && !body.elements.is_active(voxel)) --voxel.y;
  return voxel;
}

/// More than the slack of any path from the voxel through the body's box.
double displacement_that_moves_all(const Body& body, const Vec3i& voxel) {
  const IndexBox& bounds = body.elements.active_bounds();
  int steps = 0;
  for (int a = 0; a < 3; ++a) steps += std::max(voxel[a] - bounds.lo[a], bounds.hi[a] - voxel[a]);
  return std::ceil(kLargestSlack * steps) + 1;
}

Motion motion_of_all(const EcmWorkload& workload, const Body& body) {
  const Vec3i voxel = middle_element(body);
  const double voxels = displacement_that_moves_all(body, voxel);
  const Pull pull = pull_of(voxel, workload.direction, voxels);
  if (workload.start == "rest") return {{pull}, {pull}, true};
  return {{pull, pull}, {pull}, false, int(kRangeVoxels / voxels) - 2};
}

/// Pulls of a local motion of the given amplitude: out of rest, or to and fro about the rest place.
Motion local_motion(const EcmWorkload& workload, const Vec3i& voxel, double amplitude) {
  const Pull out = pull_of(voxel, workload.direction, amplitude);
  if (workload.start == "rest" || workload.start == "pull") return {{out}, {out}, true};
  const Pull back = pull_of(voxel, workload.direction, -2 * amplitude);
  const Pull forth = pull_of(voxel, workload.direction, 2 * amplitude);
  return {{out, back, forth}, {back, forth}, false};
}

/// The amplitude whose last pull moves about `wanted` elements. These grow with its cube, so a few
/// steps do.
double find_amplitude(const EcmWorkload& workload, Body& body, const Vec3i& voxel,
                      std::int64_t wanted, Progress& cancel) {
  const auto engine = make_engine("supple", body, &cancel);
  double amplitude = 0.3 * std::cbrt(double(wanted));
  for (int step = 0; step < 8; ++step) {
    engine->reset();
    for (const Pull& pull : local_motion(workload, voxel, amplitude).script) engine->pull(pull);
    const double moved = double(engine->moved());
    if (std::abs(moved - double(wanted)) < 0.03 * double(wanted)) break;
    amplitude *= std::clamp(std::cbrt(double(wanted) / moved), 0.5, 2.0);
  }
  release_offsets(body);
  return amplitude;
}

Warm warm_up(const EcmSide& side, MeasuredBody& measured, const std::vector<Pull>& script,
             Progress& cancel) {
  release_offsets(measured.body);
  Warm warm;
  warm.side = side;
  const std::int64_t heap_before = heap_bytes();
  const PeakMemory peak;
  warm.engine = make_engine(side.engine, measured.body, &cancel);
  for (const Pull& pull : script) {
    report(&cancel, 0);
    warm.last_ms = timed_pull(*warm.engine, pull, side.threads);
  }
  // The reference has nodes of its own; the others work on the body.
  const std::int64_t shared = side.engine == "multiset" ? 0 : measured.bytes;
  warm.bytes = shared + heap_bytes() - heap_before;
  if (const auto growth = peak.growth()) warm.peak_bytes = shared + *growth;
  warm.moved = warm.engine->moved();
  warm.checksum = warm.engine->checksum();
  return warm;
}

std::vector<Warm> warm_up_all(const EcmWorkload& workload, MeasuredBody& measured,
                              const std::vector<Pull>& script, Progress& cancel) {
  std::vector<Warm> sides;
  for (const EcmSide& side : workload.sides) {
    sides.push_back(warm_up(side, measured, script, cancel));
    if (sides.back().checksum != sides.front().checksum) {
      throw Error(row_name(workload, side) + ": found other offsets than " +
                  row_name(workload, workload.sides.front()) + ", expected equal ones");
    }
  }
  return sides;
}

/// The fields that all cases share, up to the times.
BenchRow row_of(const EcmWorkload& workload, const Warm& warm, const Body& body,
                std::int64_t moved) {
  const double nodes = double(body.elements.active_count());
  BenchRow row = {{"case", workload.kind},
                  {"engine", warm.side.engine},
                  {"field", workload.field},
                  {"size", {workload.size.x, workload.size.y, workload.size.z}},
                  {"direction", workload.direction},
                  {workload.kind == "stream" ? "script" : "start", workload.start},
                  {"nodes", body.elements.active_count()},
                  {"moved", moved},
                  {"ns_per_node", 0.0},
                  {"bytes_per_node", double(warm.bytes) / nodes}};
  if (nodes >= kPeakFromNodes && warm.peak_bytes) {
    row["peak_bytes_per_node"] = double(*warm.peak_bytes) / nodes;
  }
  row["max_list"] = warm.engine->max_list();
  return row;
}

std::vector<BenchRow> measure_motion(const EcmWorkload& workload, MeasuredBody& measured,
                                     const Motion& motion, const EcmCaseLimits& limits,
                                     Progress& cancel) {
  std::vector<Warm> warm = warm_up_all(workload, measured, motion.script, cancel);
  const std::int64_t nodes = measured.body.elements.active_count();
  std::vector<TimedSide> sides;
  std::vector<Times> ns_per_moved(warm.size());
  for (std::size_t n = 0; n < warm.size(); ++n) {
    EcmEngine& engine = *warm[n].engine;
    const bool is_multiset = warm[n].side.engine == "multiset";
    TimedSide side;
    side.run = [&, n, threads = warm[n].side.threads, is_multiset](Times& times) {
      if (motion.from_rest) engine.reset();
      for (const Pull& pull : motion.cycle) {
        times.ms.push_back(timed_pull(engine, pull, threads));
        const std::int64_t moved = is_multiset ? nodes : engine.moved();
        ns_per_moved[n].ms.push_back(times.ms.back() * 1e6 / double(moved));
      }
    };
    if (is_multiset && nodes >= limits.multiset_repeats_below) {
      side.max_runs = 1;
      side.times.ms = {warm[n].last_ms};
    }
    sides.push_back(std::move(side));
  }
  RoundLimits rounds = limits.rounds;
  rounds.max_rounds = std::clamp(motion.max_cycles / int(sides.size()), 1, rounds.max_rounds);
  take_turns(sides, rounds, [&] { report(&cancel, 0); });

  std::vector<BenchRow> rows;
  for (std::size_t n = 0; n < sides.size(); ++n) {
    BenchRow row = row_of(workload, warm[n], measured.body, warm[n].moved);
    row["ns_per_node"] = workload.kind == "local" ? ns_per_moved[n].median()
                                                  : sides[n].times.median() * 1e6 / double(nodes);
    add_times(row, sides[n].times, warm[n].side.threads);
    rows.push_back(std::move(row));
  }
  return rows;
}

/// Displacements along the direction, in voxels, after a first pull by the amplitude.
///   pull    the voxel goes on, a 1500th of the amplitude per event, and all that it moved follows;
///   wander  each event takes it to the other side of its rest place, 0.9 to 1.1 amplitudes away.
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

std::vector<BenchRow> measure_stream(const EcmWorkload& workload, MeasuredBody& measured,
                                     const EcmCaseLimits& limits, Progress& cancel) {
  const Vec3i voxel = cheek_element(measured.body);
  // A steady pull moves more and more: it starts below the wanted number and ends above.
  const std::int64_t wanted = workload.start == "pull" ? workload.wanted * 4 / 5 : workload.wanted;
  const double amplitude = find_amplitude(workload, measured.body, voxel, wanted, cancel);
  const std::vector<double> steps = stream_steps(workload.start, amplitude, limits.stream_events);
  const std::vector<Pull> first = {pull_of(voxel, workload.direction, amplitude)};

  std::vector<BenchRow> rows;
  std::optional<std::uint64_t> checksum;
  for (const EcmSide& side : workload.sides) {
    Warm warm = warm_up(side, measured, first, cancel);
    Times times, ns_per_moved;
    std::int64_t moved = 0;
    for (const double step : steps) {
      report(&cancel, 0);
      const Pull pull = pull_of(voxel, workload.direction, step);
      times.ms.push_back(timed_pull(*warm.engine, pull, side.threads));
      const std::int64_t moved_now = warm.engine->moved();
      moved += moved_now;
      ns_per_moved.ms.push_back(times.ms.back() * 1e6 /
                                double(std::max<std::int64_t>(1, moved_now)));
    }
    const std::uint64_t end = warm.engine->checksum();
    if (checksum.value_or(end) != end) {
      throw Error(row_name(workload, side) + ": found other offsets than " +
                  row_name(workload, workload.sides.front()) + ", expected equal ones");
    }
    checksum = end;
    BenchRow row = row_of(workload, warm, measured.body, moved / std::int64_t(steps.size()));
    row["ns_per_node"] = ns_per_moved.median();
    row["event_ms_median"] = times.median();
    row["event_ms_p95"] = times.quantile(0.95);
    add_times(row, times, side.threads);
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace

std::vector<BenchRow> measure_workload(const EcmWorkload& workload, MeasuredBody& measured,
                                       const EcmCaseLimits& limits, Progress& cancel) {
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

}  // namespace supple::tools
