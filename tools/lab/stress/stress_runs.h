// Rows of `supple stress`, each in a process of its own: a crash, a hang or too much memory is the
// verdict of a row, and the others go on.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tools/console/console.h"
#include "tools/lab/stress/stress_cells.h"
#include "tools/lab/stress/stress_verdict.h"
#include "volumes/base/process.h"

namespace supple::tools {

struct StressRow : StressVerdict {
  StressCell cell;
  double wall_s = 0, peak_mb = 0;
};

/// Runs the rows, and calls `done` after each. Throws Cancelled, SystemError.
std::vector<StressRow> run_stress(const StressOptions& options, Console& console,
                                  const std::function<void(const StressRow&)>& done);

/// One row in this process, in a folder that is there: what was measured. Throws as the row does.
MeasuredValues run_row(const StressCell& cell, const std::string& folder, Console& console);

}  // namespace supple::tools
