// A step of finite elements as a hand has it before all levels of its responses are there, for
// measurements of how near that is.
#pragma once

#include "lib/session/step_task.h"

namespace supple {

/// The stage in which the solid is made, before anything is grabbed.
constexpr const char* kSolidAheadStage = "solid ahead";

/// Finds the first FemStep::hand_levels levels of the responses of the only handle, along its way
/// and, where that is a shift, one across it, as for the plane of a view; moves the body to their
/// sum. Stages: the solid, what a grab waits for, and what one event of the hand does
/// ("following"). Throws as LiveResponses.
void move_to_hand_level(const ModelTask& task);

}  // namespace supple
