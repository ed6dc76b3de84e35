// `supple bench relax`: the cost of a pass of relaxation, the limits that it breaks, and the
// descent of the energy.
#include <algorithm>
#include <filesystem>
#include <iterator>

#include "tools/console/command.h"
#include "tools/console/console.h"
#include "tools/lab/bench/benches.h"
#include "tools/lab/bench/bodies/ecm_bodies.h"
#include "tools/lab/bench/elastic/relax_cases.h"
#include "volumes/base/parallel.h"
#include "volumes/base/relayed_progress.h"

namespace supple::tools {

namespace {

/// Rows that the options choose. `head`: empty when there is no head CT to measure.
std::vector<RelaxRow> checked_rows(const BenchOptions& options, const std::string& head) {
  std::vector<RelaxRow> plan =
      plan_relax({options.quick, options.threads, !head.empty(), options.only});
  if (plan.empty()) {
    throw UsageError(to_line({"", "--only", "'" + options.only.front() + "', which no row matches",
                              "part of a row's name, such as cost/noise/128/jacobi/1"}));
  }
  return plan;
}

Body body_of(const RelaxRow& row, const std::string& head) {
  if (row.field == "ct_head") return ct_head_body(head);
  if (row.field == "head_phantom") return head_phantom_body(Vec3i(row.size));
  if (row.field == "ball") return ball_body(row.size);
  if (row.field == "tissue_ball") return tissue_ball_body(row.size);
  if (row.field == "tissue_bar") return tissue_bar_body(row.size);
  return block_body(row.field, Vec3i(row.size));
}

std::vector<BenchRow> measure(const std::vector<RelaxRow>& rows, const Body& rest, bool quick,
                              Progress& cancel) {
  const std::string& kind = rows[0].kind;
  if (kind == "states") return measure_states(rows, rest, cancel);
  if (kind == "descent") return measure_descent(rows, rest, cancel);
  if (kind == "press" || kind == "pull") return measure_press(rows, rest, cancel);
  if (kind == "tighten") return measure_tighten(rows, rest, cancel);
  return measure_passes(rows, rest, quick, cancel);
}

}  // namespace

std::vector<std::string> relax_row_names(const BenchOptions& options, Console& console) {
  std::vector<std::string> names;
  for (const RelaxRow& row :
       checked_rows(options, head_file(options.ct_head, options.only.empty(), console))) {
    names.push_back(row.name());
  }
  return names;
}

/// Rows by case:
///   cost    ns per node and pass of every method, one and several threads, in turns;
///   volume  the same along all axes, with conservation of volume and without;
///   press   the volume of a ball that plates press, under several bulk moduli;
///   pull    the volume of a bar that is pulled;
///   tighten both volumes after tightening of limits (lib/chainmail/tighten.h);
///   states  random dragged states: limits that the passes broke, and passes after which the energy
///           was higher than before;
///   descent the energy of every method after a number of passes, and the passes it takes to come
///           within 1 % of the least energy found.
/// Throws UsageError when `only` leaves no row, Cancelled.
BenchReport bench_relax(const BenchOptions& options, Console& console) {
  const std::string head = head_file(options.ct_head, options.only.empty(), console);
  const std::vector<RelaxRow> plan = checked_rows(options, head);
  BenchReport result{"relax", measure_machine(), {}};
  CancelOnly cancel(&console);
  for (auto first = plan.begin(); first != plan.end();) {
    const auto last = std::find_if(
        first, plan.end(), [&](const RelaxRow& row) { return row.group() != first->group(); });
    const std::vector<RelaxRow> rows(first, last);
    const ThreadLimit limit(rows.back().threads);
    console.stage(first->group());
    std::vector<BenchRow> measured = measure(rows, body_of(*first, head), options.quick, cancel);
    std::move(measured.begin(), measured.end(), std::back_inserter(result.rows));
    first = last;
  }
  return result;
}

}  // namespace supple::tools
