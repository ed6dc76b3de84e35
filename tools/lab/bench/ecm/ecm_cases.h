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

// Ball limits (eq. 4.6) beside box limits: the same pull under both, and how far the results lie
// apart. They are different models, so their offsets need not agree.

/// Rows of a workload of kind `ball` with sides `supple` and `ball`, from rest. The row of `ball`
/// says how many links stay violated, and the distance of its elements to those of `supple`.
std::vector<BenchRow> measure_ball(const EcmWorkload& workload, MeasuredBody& measured,
                                   const EcmCaseLimits& limits, Progress& cancel);

// Cost of diagonal links: the same pull on the same body with 6, 18 and 26 links per voxel.

/// Rows of a workload of kind `links` with sides `links6`, `links18` and `links26`, from rest. The
/// offsets of different links differ; those of different threads must not, else Error.
std::vector<BenchRow> measure_links(const EcmWorkload& workload, MeasuredBody& measured,
                                    const EcmCaseLimits& limits, Progress& cancel);

// An interactive drag: many small pulls at the cheek of a head, timed one by one.

/// One row per side. A side has the whole stream to itself: alternating event by event would cool
/// the caches that a drag keeps warm. Throws as measure_workload().
std::vector<BenchRow> measure_stream(const EcmWorkload& workload, MeasuredBody& measured,
                                     const EcmCaseLimits& limits, Progress& cancel);

}  // namespace supple::tools
