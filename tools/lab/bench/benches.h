// The benchmarks by name, behind the options that they share.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tools/console/console.h"
#include "tools/lab/bench/report/report.h"
#include "tools/lab/options/lab_options.h"

namespace supple::tools {

struct Bench {
  std::function<std::vector<std::string>()> row_names;
  std::function<BenchReport()> measure;
};

/// A build with SUPPLE_BENCH=OFF (no_benches.cpp) throws UsageError.
Bench bench_of(const BenchOptions& options, int threads, Console& console);

}  // namespace supple::tools
