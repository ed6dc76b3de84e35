// Parts that the steps of a live session hold and fix, one by one, as people let go of them.
#pragma once

#include "tools/scene/live/live_session.h"
#include "volumes/base/value.h"

namespace supple::tools {

struct HeldPart {
  Drag held;   // of an anchor its selection alone
  Value keys;  // those of its selection, and how soft a handle is

  const PlacedSelection& given() const { return *held.placed; }
};

struct HeldParts {
  std::vector<HeldPart> handles, anchors;
  bool has_others = false;  // fixed labels or points, which are not taken one by one
};

/// Finds parts held since everything was let go of last. Drags of one stroke are one handle.
HeldParts held_parts(const std::vector<LiveSession::DoneStep>& done);

/// A step that lets go of everything but these, which stay where they are. Sets `keys` to its keys.
Step step_that_keeps(const HeldParts& parts, Value& keys);

}  // namespace supple::tools
