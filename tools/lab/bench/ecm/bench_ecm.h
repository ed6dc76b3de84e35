// `supple bench ecm`: the thesis' multiset algorithm, a bucket-queue Dijkstra and the engine, on
// the workloads of design.md section 9.
#pragma once

#include <string>
#include <vector>

#include "tools/console/console.h"
#include "tools/lab/bench/report/report.h"

namespace supple::tools {

struct EcmBenchOptions {
  bool quick = false;
  int threads = 0;
  std::vector<std::string> only;
  std::string ct_head;  // a volume; empty: build/data/ct_head.nhdr where that exists
};

/// Names of the rows that these options choose, in order, without measuring any. Throws UsageError
/// when `only` leaves none.
std::vector<std::string> ecm_row_names(const EcmBenchOptions& options, Console& console);

/// Throws UsageError when `only` leaves no row, Error when engines disagree.
BenchReport bench_ecm(const EcmBenchOptions& options, Console& console);

}  // namespace supple::tools
