// Measures one workload of the ECM benchmark: all its sides, in turns, on one body.
#pragma once

#include "tools/lab/bench/bodies/ecm_engines.h"
#include "tools/lab/bench/bodies/ecm_plan.h"
#include "tools/lab/bench/report/report.h"
#include "tools/lab/bench/report/timing.h"

namespace supple::tools {

/// A body with the heap that it took.
struct MeasuredBody {
  Body body;
  std::int64_t bytes = 0;
};

struct EcmCaseLimits {
  RoundLimits rounds;
  std::int64_t multiset_repeats_below = 0;  // larger bodies meet the multiset engine only once
  int multiset_runs = 3;                    // and smaller ones so often
  int stream_events = 200;
};

/// One row per side. Throws Error when two sides end with different offsets, Cancelled when
/// `cancel` says so.
std::vector<BenchRow> measure_workload(const EcmWorkload& workload, MeasuredBody& measured,
                                       const EcmCaseLimits& limits, Progress& cancel);

}  // namespace supple::tools
