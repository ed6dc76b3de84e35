#include "tools/bench/bench_relax.h"

#include <algorithm>
#include <filesystem>
#include <random>
#include <thread>

#include <oneapi/tbb/global_control.h>

#include "lib/relax/relaxation.h"
#include "tools/bench/cancel_only.h"
#include "tools/bench/ecm_bodies.h"
#include "tools/bench/ecm_motion.h"
#include "tools/bench/row_filter.h"
#include "tools/bench/timing.h"
#include "tools/command.h"

namespace supple::tools {

namespace {

constexpr const char* kDefaultHead = "build/data/ct_head.nhdr";
constexpr RelaxMethod kMethods[] = {RelaxMethod::plain, RelaxMethod::jacobi, RelaxMethod::red_black,
                                    RelaxMethod::accelerated};

struct RelaxRow {
  std::string kind;   // the row's `case`
  std::string field;  // noise, ct, smooth, head_phantom or ct_head
  int size;           // voxels per axis; 0: the head CT's own
  RelaxMethod method;
  int threads = 1;
  int count = 0;  // passes timed per round, states, or most passes

  std::string group() const {
    return kind + "/" + field + (size == 0 ? "" : "/" + std::to_string(size));
  }
  std::string name() const {
    return group() + "/" + name_of(method) + (kind == "cost" ? "/" + std::to_string(threads) : "");
  }
};

std::string head_file(const RelaxBenchOptions& options) {
  if (!options.ct_head.empty()) return options.ct_head;
  return std::filesystem::exists(kDefaultHead) ? kDefaultHead : "";
}

std::vector<RelaxRow> plan_relax(const RelaxBenchOptions& options, Console& console) {
  const int cores = int(std::thread::hardware_concurrency());
  const int several = options.threads > 0 ? options.threads : std::min(2, std::max(1, cores));
  std::vector<RelaxRow> plan;
  const auto add = [&](const std::string& kind, const std::string& field, int size, int count) {
    for (const RelaxMethod method : kMethods) {
      if (kind == "cost") plan.push_back({kind, field, size, method, 1, count});
      if (kind != "cost" || several > 1) {
        plan.push_back({kind, field, size, method, several, count});
      }
    }
  };
  add("cost", "noise", 128, 4);
  add("cost", "head_phantom", 128, 4);
  if (!options.quick) add("cost", "noise", 256, 2);
  const bool has_head = !head_file(options).empty();
  if (!has_head) console.note(std::string("no ") + kDefaultHead + ": rows of ct_head are left out");
  for (const char* field : {"noise", "ct"}) add("states", field, options.quick ? 32 : 64, 100);
  if (has_head) add("states", "ct_head", 0, options.quick ? 4 : 100);
  add("descent", "head_phantom", options.quick ? 64 : 128, options.quick ? 1000 : 8000);

  const auto is_left_out = [&](const RelaxRow& row) {
    return !is_wanted_row(options.only, row.name());
  };
  plan.erase(std::remove_if(plan.begin(), plan.end(), is_left_out), plan.end());
  if (plan.empty()) {
    throw UsageError(to_line({"", "--only", "'" + options.only.front() + "', which no row matches",
                              "part of a row's name, such as cost/noise/128/jacobi/1"}));
  }
  return plan;
}

Body body_of(const RelaxRow& row, const std::string& head) {
  if (row.field == "ct_head") return ct_head_body(head);
  if (row.field == "head_phantom") return head_phantom_body(Vec3i(row.size));
  return block_body(row.field, Vec3i(row.size));
}

/// A body under a drag, and what holds it.
struct DraggedBody {
  Body body;
  SlotSet still;
  Holds holds;
};

IndexBox back_of(const Body& body) {
  IndexBox back = body.elements.active_bounds();
  back.hi.y = back.lo.y + (back.hi.y - back.lo.y) / 16;
  return back;
}

/// The front pulled along j by that many voxels, the back fixed.
DraggedBody pull_front(Body body, double voxels, Progress& cancel) {
  DraggedBody dragged{std::move(body), {}, {}};
  const IndexBox& bounds = dragged.body.elements.active_bounds();
  Vec3i front;
  nearest_element(dragged.body,
                  {(bounds.lo.x + bounds.hi.x) / 2, bounds.hi.y, (bounds.lo.z + bounds.hi.z) / 2},
                  front);
  const Region back(back_of(dragged.body));
  drag(dragged.body, {{front, {0, std::int32_t(voxels * kFixedOne), 0}}}, {back}, dragged.holds,
       &cancel);
  dragged.still = still_elements(dragged.body, {back}, dragged.holds);
  return dragged;
}

/// One to three random elements dragged by up to 8 voxels in every axis.
DraggedBody drag_at_random(const Body& rest, std::mt19937& random, Progress& cancel) {
  DraggedBody dragged{rest, {}, {}};
  const IndexBox& bounds = rest.elements.active_bounds();
  for (int handles = 1 + int(random() % 3); handles > 0; --handles) {
    Vec3i voxel;
    std::array<std::int32_t, 3> by;
    for (int c = 0; c < 3; ++c) {
      voxel[c] = bounds.lo[c] + int(random() % unsigned(bounds.hi[c] - bounds.lo[c] + 1));
      by[std::size_t(c)] = std::int32_t(random() % (16u * 65536)) - 8 * 65536;
    }
    nearest_element(rest, voxel, voxel);
    drag(dragged.body, {{voxel, by}}, {}, dragged.holds, &cancel);
  }
  dragged.still = still_elements(dragged.body, {}, dragged.holds);
  return dragged;
}

BenchRow row_of(const RelaxRow& row, const Body& body) {
  BenchRow fields;
  fields["case"] = row.kind;
  fields["method"] = name_of(row.method);
  fields["field"] = row.field;
  const Vec3i size = row.size > 0 ? Vec3i(row.size) : body.geometry.dims();
  fields["size"] = {size.x, size.y, size.z};
  fields["nodes"] = body.elements.active_count();
  return fields;
}

double mean(const Times& times) {
  double sum = 0;
  for (const double ms : times.ms) sum += ms;
  return sum / double(times.ms.size());
}

/// Passes of all methods in turns, each on its own copy; those of the first round are not counted,
/// so that memory is there and every brick is in motion.
void measure_cost(const std::vector<RelaxRow>& rows, const Body& rest, bool quick,
                  std::vector<BenchRow>& out, Progress& cancel) {
  DraggedBody start = pull_front(rest, 0.45 * rest.elements.active_bounds().hi.y, cancel);
  std::vector<std::unique_ptr<Relaxation>> relaxations;
  std::vector<TimedSide> sides;
  for (const RelaxRow& row : rows) {
    RelaxParams params;
    params.method = row.method;
    relaxations.push_back(
        std::make_unique<Relaxation>(start.body, start.still, start.holds, params));
    for (int n = 0; n < 2 * row.count; ++n) relaxations.back()->pass();
    sides.push_back({[&relaxation = *relaxations.back(), &row](Times& times) {
                       const oneapi::tbb::global_control limit(
                           oneapi::tbb::global_control::max_allowed_parallelism,
                           std::size_t(row.threads));
                       for (int n = 0; n < row.count; ++n) {
                         times.ms.push_back(time_ms([&] { relaxation.pass(); }));
                       }
                     },
                     0,
                     {}});
  }
  take_turns(sides, quick ? RoundLimits{6, 6, 400} : RoundLimits{12, 12, 2000},
             [&] { report(&cancel, 0); });
  for (std::size_t n = 0; n < rows.size(); ++n) {
    BenchRow row = row_of(rows[n], start.body);
    const double nodes = double(start.body.elements.active_count());
    row["ns_per_node_pass"] = sides[n].times.median() * 1e6 / nodes;
    row["mean_ns_per_node_pass"] = mean(sides[n].times) * 1e6 / nodes;
    row["bytes_per_node"] = double(relaxations[n]->bytes()) / nodes;
    add_times(row, sides[n].times, rows[n].threads);
    out.push_back(std::move(row));
  }
}

/// Links that a few passes broke, counted after every pass, and passes that raised the energy.
void measure_states(const std::vector<RelaxRow>& rows, const Body& rest, std::vector<BenchRow>& out,
                    Progress& cancel) {
  constexpr int kPasses = 5;
  for (const RelaxRow& row : rows) {
    std::mt19937 random(2001);
    Times times;
    std::int64_t violations = 0, links = 0, rises = 0;
    double worst = 0, before = 0, after = 0;
    for (int n = 0; n < row.count; ++n) {
      DraggedBody state = drag_at_random(rest, random, cancel);
      RelaxParams params;
      params.method = row.method;
      Relaxation relaxation(state.body, state.still, state.holds, params);
      double energy = HUGE_VAL;
      for (int pass = 0; pass < kPasses; ++pass) {
        report(&cancel, 0);
        times.ms.push_back(time_ms([&] { relaxation.pass(); }));
        if (pass == 0) before += relaxation.energy_before_pass();
        rises += relaxation.energy_before_pass() > energy * (1 + 1e-12);
        energy = relaxation.energy_before_pass();
        relaxation.store();
        const LinkCheck check = check_links(state.body);
        violations += check.violated;
        links += check.links;
        worst = std::max(worst, check.worst_excess_voxels);
      }
      after += relaxation.energy();
    }
    BenchRow fields = row_of(row, rest);
    fields["states"] = row.count;
    fields["passes"] = kPasses;
    fields["violations"] = violations;
    fields["violated_percent"] = 100.0 * double(violations) / double(links);
    fields["worst_excess_voxels"] = worst;
    fields["energy_rises"] = rises;
    fields["energy_before"] = before / row.count;
    fields["energy_after"] = after / row.count;
    add_times(fields, times, row.threads);
    out.push_back(std::move(fields));
  }
}

/// Energies after every pass of each method.
void measure_descent(const std::vector<RelaxRow>& rows, const Body& rest,
                     std::vector<BenchRow>& out, Progress& cancel) {
  DraggedBody start = pull_front(rest, 4, cancel);
  std::vector<std::vector<double>> energies;
  std::vector<Times> times(rows.size());
  double least = HUGE_VAL;
  for (std::size_t n = 0; n < rows.size(); ++n) {
    RelaxParams params;
    params.method = rows[n].method;
    Relaxation relaxation(start.body, start.still, start.holds, params);
    energies.emplace_back();
    for (int pass = 0; pass < rows[n].count; ++pass) {
      report(&cancel, 0);
      times[n].ms.push_back(time_ms([&] { relaxation.pass(); }));
      energies.back().push_back(relaxation.energy_before_pass());
    }
    energies.back().push_back(relaxation.energy());
    // What breaks limits is no measure for what keeps them.
    if (rows[n].method != RelaxMethod::plain) least = std::min(least, energies.back().back());
  }
  for (std::size_t n = 0; n < rows.size(); ++n) {
    BenchRow fields = row_of(rows[n], rest);
    const std::vector<double>& energy = energies[n];
    fields["energy_before"] = energy.front();
    for (const int passes : {10, 20, 100, 500}) {
      fields["energy_" + std::to_string(passes)] = energy[std::size_t(passes)];
    }
    fields["energy_after"] = energy.back();
    fields["passes"] = rows[n].count;
    const auto near = std::find_if(energy.begin(), energy.end(),
                                   [&](double value) { return value <= 1.01 * least; });
    if (near == energy.end()) {
      fields["passes_to_1_percent"] = nullptr;
    } else {
      fields["passes_to_1_percent"] = near - energy.begin();
    }
    add_times(fields, times[n], rows[n].threads);
    out.push_back(std::move(fields));
  }
}

}  // namespace

std::vector<std::string> relax_row_names(const RelaxBenchOptions& options, Console& console) {
  std::vector<std::string> names;
  for (const RelaxRow& row : plan_relax(options, console)) names.push_back(row.name());
  return names;
}

BenchReport bench_relax(const RelaxBenchOptions& options, Console& console) {
  const std::vector<RelaxRow> plan = plan_relax(options, console);
  BenchReport result{"relax", measure_machine(), {}};
  CancelOnly cancel(console);
  for (auto first = plan.begin(); first != plan.end();) {
    const auto last = std::find_if(
        first, plan.end(), [&](const RelaxRow& row) { return row.group() != first->group(); });
    const std::vector<RelaxRow> rows(first, last);
    const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism,
                                            std::size_t(rows.back().threads));
    console.stage(first->group());
    const Body rest = body_of(*first, head_file(options));
    if (first->kind == "cost") measure_cost(rows, rest, options.quick, result.rows, cancel);
    if (first->kind == "states") measure_states(rows, rest, result.rows, cancel);
    if (first->kind == "descent") measure_descent(rows, rest, result.rows, cancel);
    first = last;
  }
  return result;
}

}  // namespace supple::tools
