#include "tools/bench/bench_invert.h"

#include <algorithm>
#include <thread>

#include <oneapi/tbb/global_control.h>

#include "tools/bench/invert_fields.h"
#include "tools/bench/row_filter.h"
#include "tools/bench/timing.h"
#include "tools/command.h"
#include "volumes/field/invert.h"

namespace supple::tools {

namespace {

/// One way to invert a field.
struct InvertSide {
  std::string method;  // newton
  int threads = 1;
};

/// A field with all that invert it, in turns.
struct InvertWorkload {
  std::string kind;  // the row's `case`
  int size = 0;
  std::vector<InvertSide> sides;
};

std::string row_name(const InvertWorkload& workload, const InvertSide& side) {
  const std::string n = std::to_string(workload.size);
  return workload.kind + "/" + n + "x" + n + "x" + n + "/" + side.method + "/" +
         std::to_string(side.threads);
}

std::vector<InvertWorkload> plan_invert(const InvertBenchOptions& options) {
  int threads = options.threads;
  if (threads == 0) threads = std::min(2, int(std::thread::hardware_concurrency()));
  std::vector<InvertWorkload> plan;
  for (const int size : options.quick ? std::vector<int>{128} : std::vector<int>{128, 256}) {
    for (const std::string kind : {"smooth", "extreme", "fold", "noisy"}) {
      InvertWorkload workload{kind, size, {{"newton", 1}}};
      if (threads > 1) workload.sides.push_back({"newton", threads});
      auto& sides = workload.sides;
      const auto is_left_out = [&](const InvertSide& side) {
        return !is_wanted_row(options.only, row_name(workload, side));
      };
      sides.erase(std::remove_if(sides.begin(), sides.end(), is_left_out), sides.end());
      if (!sides.empty()) plan.push_back(workload);
    }
  }
  if (plan.empty()) {
    throw UsageError(to_line({"", "--only", "'" + options.only.front() + "', which no row matches",
                              "part of a row's name, such as smooth/128x128x128/newton/1"}));
  }
  return plan;
}

BenchRow row_of(const InvertWorkload& workload, const InvertSide& side, const Times& times,
                const Displacement& displacement, const OffsetField& field) {
  const InversionCertificate& certificate = field.certificate;
  const double voxels = double(field.o.topology.active_count());
  BenchRow row = {{"case", workload.kind},
                  {"method", side.method},
                  {"size", {workload.size, workload.size, workload.size}},
                  {"voxels", field.o.topology.active_count()},
                  {"mvoxels_per_s", voxels / (1e3 * times.median() * side.threads)},
                  {"residual_max", certificate.residual_max},
                  {"residual_p999", certificate.residual_p999},
                  {"missing", missing_nodes(displacement.u, field.o)},
                  {"folded", certificate.folded_cells},
                  {"min_det", certificate.min_det},
                  {"unresolved", certificate.unresolved_voxels}};
  add_times(row, times, side.threads);
  return row;
}

std::vector<BenchRow> measure_workload(const InvertWorkload& workload, const RoundLimits& limits,
                                       Console& console) {
  const Displacement displacement = field_to_invert(workload.kind, workload.size);
  std::vector<OffsetField> fields(workload.sides.size());
  std::vector<TimedSide> sides;
  for (std::size_t n = 0; n < workload.sides.size(); ++n) {
    TimedSide side;
    side.run = [&, n](Times& times) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                      std::size_t(workload.sides[n].threads));
      fields[n] = {};
      times.ms.push_back(time_ms([&] { fields[n] = invert(displacement); }));
    };
    sides.push_back(std::move(side));
  }
  take_turns(sides, limits, [&] {
    if (console.cancelled()) throw Cancelled();
  });
  std::vector<BenchRow> rows;
  for (std::size_t n = 0; n < sides.size(); ++n) {
    rows.push_back(row_of(workload, workload.sides[n], sides[n].times, displacement, fields[n]));
  }
  return rows;
}

}  // namespace

std::vector<std::string> invert_row_names(const InvertBenchOptions& options) {
  std::vector<std::string> names;
  for (const InvertWorkload& workload : plan_invert(options)) {
    for (const InvertSide& side : workload.sides) names.push_back(row_name(workload, side));
  }
  return names;
}

BenchReport bench_invert(const InvertBenchOptions& options, Console& console) {
  const std::vector<InvertWorkload> plan = plan_invert(options);
  BenchReport result{"invert", measure_machine(), {}};
  const RoundLimits limits = options.quick ? RoundLimits{3, 10, 1500} : RoundLimits{5, 25, 6000};
  for (const InvertWorkload& workload : plan) {
    console.stage(workload.kind + " " + std::to_string(workload.size));
    for (BenchRow& row : measure_workload(workload, limits, console)) {
      result.rows.push_back(std::move(row));
    }
  }
  return result;
}

}  // namespace supple::tools
