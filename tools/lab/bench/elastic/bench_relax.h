// `supple bench relax`: the cost of a pass of relaxation, the limits that it breaks, and the
// descent of the energy.
#pragma once

#include <string>
#include <vector>

#include "tools/console/console.h"
#include "tools/lab/bench/report/report.h"

namespace supple::tools {

struct RelaxBenchOptions {
  bool quick = false;
  int threads = 0;  // of the rows with several threads; 0: two, one on a single core
  std::vector<std::string> only;
  std::string ct_head;  // a head CT; empty: build/data/ct_head.nhdr where it is
};

/// Names of the rows that these options choose (relax_plan.h), in order, without measuring any.
/// Throws UsageError when `only` leaves none.
std::vector<std::string> relax_row_names(const RelaxBenchOptions& options, Console& console);

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
BenchReport bench_relax(const RelaxBenchOptions& options, Console& console);

}  // namespace supple::tools
