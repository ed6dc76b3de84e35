// Descriptions of steps in the words of a history: kind, millimetres and place.
#pragma once

#include "tools/scene/live/live_session.h"
#include "volumes/base/value.h"

namespace supple::tools {

/// Words for the selection that an event or a step's entry names: "128, 242, 26", "label 3".
std::string place_text(const Value& keys);

/// One line about the steps of a stroke, first to last, which are undone together.
std::string step_text(const std::vector<const DoneStep*>& stroke);
std::string look_text(const DoneLook& look);

/// Strokes, looks and clips in the order in which they were done; of those that are undone the next
/// one to be made again comes first.
struct History {
  struct Entry {
    std::string text;
    const char* kind;
    int steps = 1;
  };
  std::vector<Entry> done, undone;
};
History history_of(const LiveHistory& history);

/// The places that a hand was led to and has reached, the elements that moved, and what stopped it.
Value to_value(const LiveHand::Led& led);

}  // namespace supple::tools
