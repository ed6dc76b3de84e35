// `supple bench invert`: how fast displacements become offset fields, and how exactly (design.md
// sections 4 and 9).
#include <algorithm>
#include <thread>

#include "tools/console/command.h"
#include "tools/lab/bench/benches.h"
#include "tools/lab/bench/bodies/invert_fields.h"
#include "tools/lab/bench/invert/invert_tets.h"
#include "tools/lab/bench/invert/invert_update.h"
#include "tools/lab/bench/peers/invert_peers.h"
#include "tools/lab/bench/report/report.h"
#include "tools/lab/bench/report/timing.h"
#include "volumes/base/parallel.h"
#include "volumes/field/inversion/invert.h"

namespace supple::tools {

namespace {

constexpr std::int64_t kDraggedElements = 900'000;

/// One way to invert a field.
struct InvertSide {
  std::string method;  // newton, tets, vtk or itk
  int threads = 1;
};

/// A field with all that invert it, in turns.
struct InvertWorkload {
  std::string kind;  // the row's `case`
  Vec3i size;
  std::vector<InvertSide> sides;
};

std::string row_name(const InvertWorkload& workload, const InvertSide& side) {
  const Vec3i& size = workload.size;
  return workload.kind + "/" + std::to_string(size.x) + "x" + std::to_string(size.y) + "x" +
         std::to_string(size.z) + "/" + side.method + "/" + std::to_string(side.threads);
}

std::vector<InvertWorkload> plan_invert(const BenchOptions& options) {
  int threads = options.threads;
  if (threads == 0) threads = std::min(2, int(std::thread::hardware_concurrency()));
  std::vector<InvertWorkload> plan;
  const auto add = [&](const std::string& kind, const Vec3i& size,
                       const std::vector<std::string>& others) {
    InvertWorkload workload{kind, size, {{"newton", 1}}};
    if (threads > 1) workload.sides.push_back({"newton", threads});
    for (const std::string& other : others) workload.sides.push_back({other, 1});
    auto& sides = workload.sides;
    const auto is_left_out = [&](const InvertSide& side) {
      return !is_wanted_row(options.only, row_name(workload, side));
    };
    sides.erase(std::remove_if(sides.begin(), sides.end(), is_left_out), sides.end());
    if (!sides.empty()) plan.push_back(workload);
  };
  for (const int size : options.quick ? std::vector<int>{128} : std::vector<int>{128, 256}) {
    std::vector<std::string> others = {"tets"};
    if (size == 128 && !options.quick) others = {"tets", "vtk", "itk"};
    for (const std::string kind : {"smooth", "extreme", "fold", "noisy"}) {
      add(kind, Vec3i(size), others);
    }
  }
  add("update", {512, 512, 256}, {});
  if (plan.empty()) {
    throw UsageError(to_line({"", "--only", "'" + options.only.front() + "', which no row matches",
                              "part of a row's name, such as smooth/128x128x128/newton/1"}));
  }
  return plan;
}

/// Result and times of one side.
struct InvertResult {
  OffsetField field;
  Times cpu;
  bool is_absent = false;  // of a peer that is not installed
};

BenchRow row_of(const InvertWorkload& workload, const InvertSide& side, const Times& times,
                const Displacement& displacement, const InvertResult& result,
                const BrickTopology& nodes) {
  const bool is_ours = side.method == "newton";
  const bool fills_box = !is_ours && side.method != "tets";
  const VectorBricks& o = result.field.o;
  const double voxels = double((fills_box ? nodes : o.topology).active_count());
  BenchRow row = {{"case", workload.kind},
                  {"method", side.method},
                  {"size", {workload.size.x, workload.size.y, workload.size.z}},
                  {"voxels", std::int64_t(voxels)},
                  {"mvoxels_per_s", voxels / (1e3 * times.median() * side.threads)}};
  if (!result.cpu.ms.empty()) row["mvoxels_per_cpu_s"] = voxels / (1e3 * result.cpu.median());
  const InversionCertificate& certificate = result.field.certificate;
  if (is_ours) {
    row["residual_max"] = certificate.residual_max;
    row["residual_p999"] = certificate.residual_p999;
    row["missing"] = missing_nodes(displacement.u, o);
    row["folded"] = certificate.folded_cells;
    row["min_det"] = certificate.min_det;
    row["unresolved"] = certificate.unresolved_voxels;
  } else {
    const Judgement judgement = judge(displacement.u, o, nodes);
    row["residual_max"] = judgement.residual_max;
    row["residual_p999"] = judgement.residual_p999;
    row["missing"] = judgement.missing;
  }
  add_times(row, times, side.threads);
  return row;
}

std::vector<BenchRow> update_rows(const InvertWorkload& workload, bool quick, Console& console) {
  std::vector<int> threads;
  for (const InvertSide& side : workload.sides) threads.push_back(side.threads);
  return measure_update(workload.size, kDraggedElements, threads, quick ? 10 : 40, console);
}

/// Makes one inversion by one of our own methods.
void run_method(const std::string& method, const Displacement& displacement, InvertResult& result,
                Times& times) {
  result.field = {};
  result.cpu.ms.push_back(cpu_time_ms([&] {
    times.ms.push_back(time_ms([&] {
      if (method == "tets") {
        result.field.o = invert_by_tetrahedra(displacement);
      } else {
        result.field = invert(displacement);
      }
    }));
  }));
}

/// Runs a peer once; no time, and a note the first time, when the peer is not installed.
void run_peer(const std::string& peer, const Displacement& displacement, InvertResult& result,
              Times& times, Console& console) {
  if (result.is_absent) return;
  std::optional<PeerInverse> inverse = invert_by_peer(peer, displacement, 1);
  if (!inverse) {
    result.is_absent = true;
    console.note(peer + " is not installed: its rows are left out");
    return;
  }
  result.field.o = std::move(inverse->o);
  times.ms.push_back(inverse->ms);
}

std::vector<BenchRow> measure_workload(const InvertWorkload& workload, const RoundLimits& limits,
                                       Console& console) {
  const Displacement displacement = field_to_invert(workload.kind, workload.size.x);
  std::vector<InvertResult> results(workload.sides.size());
  std::vector<TimedSide> sides;
  for (std::size_t n = 0; n < workload.sides.size(); ++n) {
    const InvertSide of = workload.sides[n];
    const bool is_peer = of.method == "vtk" || of.method == "itk";
    TimedSide side;
    side.max_runs = is_peer ? 1 : 0;
    side.run = [&, n, of, is_peer](Times& times) {
      const ThreadLimit limit(of.threads);
      if (is_peer) {
        run_peer(of.method, displacement, results[n], times, console);
      } else {
        run_method(of.method, displacement, results[n], times);
      }
    };
    sides.push_back(std::move(side));
  }
  take_turns(sides, limits, [&] {
    if (console.cancelled()) throw Cancelled();
  });
  const BrickTopology nodes = inner_nodes(displacement);
  std::vector<BenchRow> rows;
  for (std::size_t n = 0; n < sides.size(); ++n) {
    if (sides[n].times.ms.empty()) continue;
    rows.push_back(
        row_of(workload, workload.sides[n], sides[n].times, displacement, results[n], nodes));
  }
  return rows;
}

}  // namespace

std::vector<std::string> invert_row_names(const BenchOptions& options, Console&) {
  std::vector<std::string> names;
  for (const InvertWorkload& workload : plan_invert(options)) {
    for (const InvertSide& side : workload.sides) names.push_back(row_name(workload, side));
  }
  return names;
}

BenchReport bench_invert(const BenchOptions& options, Console& console) {
  const std::vector<InvertWorkload> plan = plan_invert(options);
  BenchReport result{"invert", measure_machine(), {}};
  const RoundLimits limits = options.quick ? RoundLimits{3, 10, 1500} : RoundLimits{5, 25, 6000};
  for (const InvertWorkload& workload : plan) {
    console.stage(row_name(workload, workload.sides.front()));
    for (BenchRow& row : workload.kind == "update" ? update_rows(workload, options.quick, console)
                                                   : measure_workload(workload, limits, console)) {
      result.rows.push_back(std::move(row));
    }
  }
  return result;
}

}  // namespace supple::tools
