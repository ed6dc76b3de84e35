// `supple bench fit`: how near Enhanced ChainMail and relaxation come to finite elements on
// standard loads of an elastic block, and with which limits and which bulk modulus.
#pragma once

#include <string>
#include <vector>

#include "tools/console/console.h"
#include "tools/lab/bench/report/report.h"

namespace supple::tools {

struct FitBenchOptions {
  bool quick = false;
  std::vector<std::string> only;
};

/// load/nu/model, which --only matches. Throws UsageError when `only` leaves none.
std::vector<std::string> fit_row_names(const FitBenchOptions& options);

/// Rows by load (pull, press, shear, bend, indent, tug), Poisson's ratio and model:
///   ecm6, ecm26      Enhanced ChainMail whose links give by the part that comes closest, alike in
///                    length and shear;
///   relax6, relax26  relaxed to the end without a limit in its way;
///   poisson          the same with the bulk modulus E / (1 - 2 nu) (RelaxParams::poisson);
///   fitted           and with the bulk modulus that comes closest.
/// Errors are distances from linear finite elements of the same voxels: root mean square over the
/// way, and the 95th percentile over the way of the handle. Throws UsageError, Cancelled.
BenchReport bench_fit(const FitBenchOptions& options, Console& console);

}  // namespace supple::tools
