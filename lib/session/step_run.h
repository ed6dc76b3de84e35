// A step: what comes before anything moves, then the drags, from pose to pose where they have ways.
#pragma once

#include <vector>

#include "lib/session/session_body.h"

namespace supple {

/// Runs the step of the record, which is on the grid, after the earlier ones, and fills the record
/// in. Throws as Session::step(), the body part of the way then.
void run_step(SessionBody& in, const std::vector<StepRecord>& earlier, StepRecord& record,
              Progress* progress);

}  // namespace supple
