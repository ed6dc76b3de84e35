// The parts that a session holds, fixes and has cut, as the message `scene` lists them: keys of
// events, and where they are now.
#pragma once

#include "tools/scene/live/held_parts.h"
#include "tools/scene/live/state_parts.h"
#include "volumes/base/value.h"

namespace supple::tools {

/// Numbered as a release counts them, where one can be let go of; those of the state that was
/// opened have no number, and its handles hold nothing. Handles without a middle are not listed.
Value handles_json(const HeldParts& held, const StateParts& of_state, const State& state,
                   const Displacement& moved);
Value anchors_json(const HeldParts& held, const StateParts& of_state, const State& state,
                   const Displacement& moved);
Value cuts_json(const std::vector<DoneStep>& done, const StateParts& of_state, const State& state,
                const Displacement& moved);

}  // namespace supple::tools
