// `supple bench springs`: the cost of a frame of a membrane, and the course of its energy
// (design.md sections 6 and 9).
#pragma once

#include <string>
#include <vector>

#include "tools/console/console.h"
#include "tools/lab/bench/report/report.h"

namespace supple::tools {

struct SpringsBenchOptions {
  bool quick = false;
  std::vector<std::string> only;
};

/// Names of the rows that these options choose, in order, without measuring any. Throws UsageError
/// when `only` leaves none.
std::vector<std::string> springs_row_names(const SpringsBenchOptions& options);

/// Throws UsageError when `only` leaves no row, Cancelled.
BenchReport bench_springs(const SpringsBenchOptions& options, Console& console);

}  // namespace supple::tools
