// `supple bench ecm`: the thesis' multiset algorithm, a bucket-queue Dijkstra and the engine, on
// the workloads of design.md section 9.
#pragma once

#include <string>
#include <vector>

#include "tools/bench/report.h"
#include "tools/console.h"

namespace supple::tools {

struct EcmBenchOptions {
  bool quick = false;
  int threads = 0;
  std::vector<std::string> only;
  std::string ct_head;  // a volume; empty: build/data/ct_head.nhdr where that exists
};

/// Throws UsageError when `only` leaves no row, Error when engines disagree.
BenchReport bench_ecm(const EcmBenchOptions& options, Console& console);

}  // namespace supple::tools
