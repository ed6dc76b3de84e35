// Cost of diagonal links: the same pull on the same body with 6, 18 and 26 links per voxel.
#pragma once

#include "tools/lab/bench/ecm/ecm_cases.h"

namespace supple::tools {

/// Rows of a workload of kind `links` with sides `links6`, `links18` and `links26`, from rest. The
/// offsets of different links differ; those of different threads must not, else Error.
std::vector<BenchRow> measure_links(const EcmWorkload& workload, MeasuredBody& measured,
                                    const EcmCaseLimits& limits, Progress& cancel);

}  // namespace supple::tools
