// Ball limits (eq. 4.6) beside box limits: the same pull under both, and how far the results lie
// apart. They are different models, so their offsets need not agree.
#pragma once

#include "tools/lab/bench/ecm/ecm_cases.h"

namespace supple::tools {

/// Rows of a workload of kind `ball` with sides `supple` and `ball`, from rest. The row of `ball`
/// says how many links stay violated, and the distance of its elements to those of `supple`.
std::vector<BenchRow> measure_ball(const EcmWorkload& workload, MeasuredBody& measured,
                                   const EcmCaseLimits& limits, Progress& cancel);

}  // namespace supple::tools
