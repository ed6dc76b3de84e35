// Parts that the steps of a live session hold and fix, one by one, as people let go of them.
#pragma once

#include <vector>

#include "lib/session/step.h"

namespace supple::tools {

struct DoneStep;  // tools/scene/live/live_session.h
struct LiveEvent;

/// Parts that are held and fixed since everything was let go of last.
struct HeldParts {
  std::vector<Drag> handles;  // which stay where they are
  std::vector<PlacedSelection> anchors;
  bool has_others = false;  // fixed labels or points: nothing is let go of one by one
};

/// Finds them. Drags of one stroke are one handle. `has_others`: before these steps.
HeldParts held_parts(const std::vector<DoneStep>& done, bool has_others);

/// The step by which the event lets go of one handle or anchor: a session lets go of everything;
/// what stays is held and fixed again in the same step. Throws InputError where there is no such
/// part, or nothing can be let go of alone.
Step step_without(const LiveEvent& event, HeldParts parts);

}  // namespace supple::tools
