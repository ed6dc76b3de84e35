// Changes of the body of a session: pieces, materials, cuts, removals.
#pragma once

#include <string>

#include "lib/session/session_body.h"

namespace supple {

/// The state as it is now, but for its journal.
State state_of(const SessionBody& in);

/// Takes over the rigid pieces of a state that was read from `path`, or those of the material; then
/// in.state.cuts are the cuts without the links that pieces hide.
void take_pieces_of_state(SessionBody& in, const std::string& path, Progress* progress);

/// Material, cuts, removals and new pieces of a step, which come before anything that moves.
void prepare_body(SessionBody& in, StepRecord& record, Progress* progress);

}  // namespace supple
