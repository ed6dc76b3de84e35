// `supple bench io`: how fast files become sparse grids and volumes become files, beside the time
// that the system needs for the bytes alone (design.md section 9).
#pragma once

#include <string>
#include <vector>

#include "tools/console/console.h"
#include "tools/lab/bench/report/report.h"

namespace supple::tools {

struct IoBenchOptions {
  bool quick = false;
  int threads = 0;  // 0: two, one on a single core
  std::vector<std::string> only;
};

/// Names of the rows that these options choose, in order, without measuring any. Throws UsageError
/// when `only` leaves none.
std::vector<std::string> io_row_names(const IoBenchOptions& options);

/// Throws UsageError when `only` leaves no row, SystemError (disk full), Cancelled.
BenchReport bench_io(const IoBenchOptions& options, Console& console);

}  // namespace supple::tools
