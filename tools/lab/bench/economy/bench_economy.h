// `supple bench economy`: what a fixed local drag costs while the volume grows around it
// (docs/economy.md).
#pragma once

#include <string>
#include <vector>

#include "tools/console/console.h"
#include "tools/lab/bench/report/report.h"

namespace supple::tools {

struct EconomyBenchOptions {
  bool quick = false;
  int threads = 0;  // 0: two, one on a single core
  std::vector<std::string> only;
};

/// Names of the rows that these options choose, in order, without measuring any. Throws UsageError
/// when `only` leaves none.
std::vector<std::string> economy_row_names(const EconomyBenchOptions& options);

/// Rows: a ball of 24 voxels radius whose middle goes by five voxels along j, in a box of 64^3,
/// 128^3 and 256^3 voxels, of which the rest is air or tissue of the same kind. Throws UsageError
/// when `only` leaves no row, Cancelled.
BenchReport bench_economy(const EconomyBenchOptions& options, Console& console);

}  // namespace supple::tools
