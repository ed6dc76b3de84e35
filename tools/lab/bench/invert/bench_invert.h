// `supple bench invert`: how fast displacements become offset fields, and how exactly (design.md
// sections 4 and 9).
#pragma once

#include <string>
#include <vector>

#include "tools/console/console.h"
#include "tools/lab/bench/report/report.h"

namespace supple::tools {

struct InvertBenchOptions {
  bool quick = false;
  int threads = 0;  // of the rows with several threads; 0: two, one on a single core
  std::vector<std::string> only;
};

/// Names of the rows that these options choose, in order, without measuring any. Throws UsageError
/// when `only` leaves none.
std::vector<std::string> invert_row_names(const InvertBenchOptions& options);

/// Throws UsageError when `only` leaves no row, Cancelled.
BenchReport bench_invert(const InvertBenchOptions& options, Console& console);

}  // namespace supple::tools
