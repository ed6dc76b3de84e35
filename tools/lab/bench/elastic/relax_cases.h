// The cases of `supple bench relax` (described in bench_relax.cpp). All rows of a call belong to
// one group; `rest` is their body at rest. Throw Cancelled.
#pragma once

#include <vector>

#include "lib/body/body.h"
#include "tools/lab/bench/elastic/relax_plan.h"
#include "tools/lab/bench/report/report.h"
#include "volumes/base/progress.h"

namespace supple::tools {

/// cost and volume.
std::vector<BenchRow> measure_passes(const std::vector<RelaxRow>& rows, const Body& rest,
                                     bool quick, Progress& cancel);
std::vector<BenchRow> measure_states(const std::vector<RelaxRow>& rows, const Body& rest,
                                     Progress& cancel);
std::vector<BenchRow> measure_descent(const std::vector<RelaxRow>& rows, const Body& rest,
                                      Progress& cancel);
/// press and pull.
std::vector<BenchRow> measure_press(const std::vector<RelaxRow>& rows, const Body& rest,
                                    Progress& cancel);
std::vector<BenchRow> measure_tighten(const std::vector<RelaxRow>& rows, const Body& rest,
                                      Progress& cancel);

}  // namespace supple::tools
