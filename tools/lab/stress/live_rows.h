// The row of a live session: random operations, each looked at.
#pragma once

#include "tools/console/console.h"
#include "tools/lab/stress/stress_input.h"
#include "tools/lab/stress/stress_verdict.h"

namespace supple::tools {

/// StressInput::operations of all kinds but pictures, the same in every run. An operation that is
/// refused must have changed nothing; then all are taken back, and the journal is carried out by a
/// second session.
void run_live(const StressInput& input, const std::string& folder, Console& console,
              MeasuredValues& all);

}  // namespace supple::tools
