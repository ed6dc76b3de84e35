// `supple bench render`: samples and frames of the free-sampling marcher, beside other libraries'
// samplers and beside its own straight frame (design.md sections 5 and 9).
#pragma once

#include <string>
#include <vector>

#include "tools/console/console.h"
#include "tools/lab/bench/report/report.h"

namespace supple::tools {

struct RenderBenchOptions {
  bool quick = false;
  int threads = 0;  // of the rows with several threads; 0: two, one on a single core
  std::vector<std::string> only;
};

/// Names of the rows that these options choose, in order, without measuring any. Throws UsageError
/// when `only` leaves none.
std::vector<std::string> render_row_names(const RenderBenchOptions& options);

/// Throws UsageError when `only` leaves no row, Cancelled.
BenchReport bench_render(const RenderBenchOptions& options, Console& console);

}  // namespace supple::tools
