// `supple bench springs`: the cost of a frame of a membrane, and the course of its energy
// (design.md sections 6 and 9).
#include <algorithm>
#include <cstdio>
#include <optional>

#include "lib/springs/xpbd.h"
#include "tools/console/command.h"
#include "tools/lab/bench/benches.h"
#include "tools/lab/bench/elastic/springs_membrane.h"
#include "tools/lab/bench/report/report.h"
#include "tools/lab/bench/report/timing.h"
#include "volumes/base/error.h"

namespace supple::tools {

namespace {

/// A membrane of one stiffness with all that move it, in turns.
struct SpringsWorkload {
  std::string kind;  // the row's `case`: pluck, drag or hold
  double stiffness_n_m;
  std::vector<std::string> integrators;
};

/// A membrane that moves, with what it has measured.
struct MovingMembrane {
  std::string name;
  SpringSystem system;
  std::unique_ptr<SpringIntegrator> integrator;
  std::optional<Forceps> forceps;
  bool is_held = false;  // the forceps stop where they are highest
  Times times, cpu;
  double largest_j = 0;
  double spent_ms = 0;
  std::vector<double> energies_j;  // after each frame
  SpringStepReport sum;
};

std::string row_name(const SpringsWorkload& workload, const std::string& integrator) {
  return workload.kind + "/" + number_text(workload.stiffness_n_m) + "/" + integrator;
}

std::vector<SpringsWorkload> plan_springs(const BenchOptions& options) {
  std::vector<SpringsWorkload> plan;
  for (const std::string kind : {"pluck", "drag", "hold"}) {
    for (const double stiffness : {1.0, 1e2, 1e4, 1e6}) {
      SpringsWorkload workload{kind, stiffness, {}};
      for (const std::string name : {"xpbd", "projective", "implicit", "explicit"}) {
        // Undamped, it never comes to rest.
        if (kind == "hold" && name == "explicit") continue;
        if (is_wanted_row(options.only, row_name(workload, name))) {
          workload.integrators.push_back(name);
        }
      }
      if (!workload.integrators.empty()) plan.push_back(workload);
    }
  }
  if (plan.empty()) {
    throw UsageError(to_line({"", "--only", "'" + options.only.front() + "', which no row matches",
                              "part of a row's name, such as pluck/10000/xpbd"}));
  }
  return plan;
}

/// Rows call symplectic Euler "explicit", and hold XPBD to fixed numbers of substeps and sweeps.
std::unique_ptr<SpringIntegrator> integrator_of(const std::string& name, SpringSystem& system) {
  if (name == "xpbd") return std::make_unique<Xpbd>(system, Xpbd::Params{8, 4});
  return make_integrator(
      name == "explicit" ? SpringMethod::symplectic : spring_method(name).value(), system);
}

void run_frame(MovingMembrane& membrane, int frame) {
  if (membrane.is_held) frame = std::min(frame, Forceps::kHighestFrame);
  if (membrane.forceps) membrane.forceps->move(membrane.system, frame);
  SpringStepReport report;
  double ms = 0;
  membrane.cpu.ms.push_back(
      cpu_time_ms([&] { ms = time_ms([&] { report = membrane.integrator->step(kFrameS); }); }));
  membrane.times.ms.push_back(ms);
  membrane.spent_ms += ms;
  membrane.sum.substeps += report.substeps;
  membrane.sum.iterations += report.iterations;
  const double now_j = energy(membrane.system).total_j();
  membrane.energies_j.push_back(now_j);
  membrane.largest_j = std::max(membrane.largest_j, now_j);
}

/// Adds how far the membrane is from where it would come to rest.
void add_rest(BenchRow& row, const MovingMembrane& membrane, const PulledMembrane& pulled) {
  double off_mm = 0;
  for (std::size_t n = 0; n < membrane.system.node_count(); ++n) {
    const Vec3d off = membrane.system.pos_mm[n] - pulled.system.pos_mm[n];
    off_mm = std::max(off_mm, off.length());
  }
  const double pull_n =
      membrane.forceps->pull_n(membrane.system, membrane.integrator->reactions_n());
  row["error_mm"] = off_mm;
  row["rest_energy_ratio"] = membrane.energies_j.back() / pulled.energy_j;
  row["force_ratio"] = pull_n / pulled.pull_n;
}

BenchRow row_of(const SpringsWorkload& workload, const MovingMembrane& membrane,
                double reference_j) {
  const double frames = double(membrane.times.ms.size());
  BenchRow row = {{"case", workload.kind},
                  {"integrator", membrane.name},
                  {"nodes", membrane.system.node_count()},
                  {"stiffness", workload.stiffness_n_m},
                  {"frame_ms", membrane.times.median()},
                  {"frame_p95_ms", membrane.times.quantile(0.95)},
                  {"frame_cpu_ms", membrane.cpu.median()},
                  {"substeps", membrane.sum.substeps / frames},
                  {"iterations", membrane.sum.iterations / frames},
                  {"energy_ratio", membrane.largest_j / reference_j}};
  if (workload.kind == "pluck") {
    for (const std::size_t frame : {1, 2, 5, 10, 20, 50, 100, 200, 500, 1000}) {
      if (frame > membrane.energies_j.size()) break;
      row["energy_" + std::to_string(frame)] = membrane.energies_j[frame - 1] / reference_j;
    }
  }
  return row;
}

std::vector<BenchRow> measure_workload(const SpringsWorkload& workload, bool quick,
                                       Console& console) {
  const bool is_held = workload.kind == "hold";
  const int frames = quick || is_held ? 100 : 1000;
  const double budget_ms = quick ? 1500 : 20000;  // of one membrane
  constexpr int kMinFrames = 2;
  const bool is_dragged = workload.kind != "pluck";
  std::optional<PulledMembrane> pulled;
  if (is_dragged) pulled = pulled_membrane(workload.stiffness_n_m);
  double reference_j = is_dragged ? pulled->energy_j : 0;
  std::vector<std::unique_ptr<MovingMembrane>> membranes;
  for (const std::string& name : workload.integrators) {
    auto membrane = std::make_unique<MovingMembrane>();
    membrane->name = name;
    membrane->is_held = is_held;
    if (is_dragged) {
      membrane->system = flat_membrane(workload.stiffness_n_m);
      membrane->forceps.emplace(membrane->system);
    } else {
      membrane->system = plucked_membrane(workload.stiffness_n_m);
      reference_j = membrane->largest_j = energy(membrane->system).total_j();
    }
    membrane->integrator = integrator_of(name, membrane->system);
    membranes.push_back(std::move(membrane));
  }
  for (int frame = 0; frame < frames; ++frame) {
    for (const auto& membrane : membranes) {
      if (console.cancelled()) throw Cancelled();
      if (frame >= kMinFrames && membrane->spent_ms > budget_ms) continue;
      run_frame(*membrane, frame);
    }
  }
  std::vector<BenchRow> rows;
  for (const auto& membrane : membranes) {
    BenchRow row = row_of(workload, *membrane, reference_j);
    if (is_held) add_rest(row, *membrane, *pulled);
    add_times(row, membrane->times, 1);
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace

std::vector<std::string> springs_row_names(const BenchOptions& options, Console&) {
  std::vector<std::string> names;
  for (const SpringsWorkload& workload : plan_springs(options)) {
    for (const std::string& name : workload.integrators) {
      names.push_back(row_name(workload, name));
    }
  }
  return names;
}

BenchReport bench_springs(const BenchOptions& options, Console& console) {
  const std::vector<SpringsWorkload> plan = plan_springs(options);
  BenchReport result{"springs", measure_machine(), {}};
  for (const SpringsWorkload& workload : plan) {
    console.stage(row_name(workload, workload.integrators.front()));
    for (BenchRow& row : measure_workload(workload, options.quick, console)) {
      result.rows.push_back(std::move(row));
    }
  }
  return result;
}

}  // namespace supple::tools
