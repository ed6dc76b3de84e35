// Rows `error` of `supple bench fem`: how far the error that solutions report is from the true one.
#pragma once

#include <string>

#include "tools/lab/bench/report/report.h"
#include "volumes/base/progress.h"

namespace supple::tools {

/// Solves bodies of one kind (error_bodies.h) to several errors and to rounding. `within` is the
/// share of solutions whose error, the 95th percentile over free nodes, is at most its estimate;
/// `largest_ratio` the largest error by its estimate; iterations are means. Throws Cancelled.
BenchRow measure_errors(const std::string& kind, int bodies, Progress& cancel);

}  // namespace supple::tools
