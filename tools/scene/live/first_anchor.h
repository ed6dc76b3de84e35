// The anchor with which a session begins whose volume has bone: drags of soft tissue then stop at
// it, and it need not be moved and turned along.
#pragma once

#include <optional>

#include "tools/scene/live/live_session.h"

namespace supple::tools {

/// An event that fixes the largest rigid piece of a volume that nobody has done anything with; none
/// for a state, for a journal with events, for a scene with steps, and for a body without pieces.
std::optional<LiveEvent> first_anchor(LiveSession& live);

}  // namespace supple::tools
