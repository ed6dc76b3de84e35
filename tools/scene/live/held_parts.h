// Parts that the steps of a live session hold and fix, one by one, as people let go of them.
#pragma once

#include <vector>

#include "tools/scene/live/live_session.h"

namespace supple::tools {

/// Finds them. Drags of one stroke are one handle. `has_others`: before these steps.
HeldParts held_parts(const std::vector<DoneStep>& done, bool has_others);

/// The step by which the event lets go of one handle or anchor: a session lets go of everything;
/// what stays is held and fixed again in the same step. Throws InputError where there is no such
/// part, or nothing can be let go of alone.
Step step_without(const LiveEvent& event, HeldParts parts);

}  // namespace supple::tools
