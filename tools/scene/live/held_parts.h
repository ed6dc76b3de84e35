// Parts that the steps of a live session hold and fix, one by one, as people let go of them.
#pragma once

#include "tools/scene/live/live_session.h"

namespace supple::tools {

struct HeldParts {
  std::vector<Drag> handles;  // which stay where they are
  std::vector<PlacedSelection> anchors;
  bool has_others = false;  // fixed labels or points: nothing is let go of one by one
};

/// Finds parts held since everything was let go of last. Drags of one stroke are one handle.
/// `is_state_anchored`: the opened state fixes elements.
HeldParts held_parts(const std::vector<DoneStep>& done, bool is_state_anchored);

/// A step that lets go of everything but these, which stay where they are.
Step step_that_keeps(const HeldParts& parts);

}  // namespace supple::tools
