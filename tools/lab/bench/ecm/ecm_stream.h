// An interactive drag: many small pulls at the cheek of a head, timed one by one.
#pragma once

#include "tools/lab/bench/ecm/ecm_cases.h"

namespace supple::tools {

/// One row per side. A side has the whole stream to itself: alternating event by event would cool
/// the caches that a drag keeps warm. Throws as measure_workload().
std::vector<BenchRow> measure_stream(const EcmWorkload& workload, MeasuredBody& measured,
                                     const EcmCaseLimits& limits, Progress& cancel);

}  // namespace supple::tools
