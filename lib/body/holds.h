// Elements that do not move freely, since handles of earlier drags hold them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lib/body/slot_set.h"

namespace supple {

/// An offset that an element may not pass.
struct Bound {
  Slot slot;
  std::int32_t value;
  /// True where the soft edge of a handle left the bound: a place that the element was asked to
  /// take, not a tool beside it.
  bool asks = false;
};

/// Elements of one body that the handles of earlier drags still hold. Those of two-sided handles
/// stay where they are. Those of push handles stay at or beyond the place that they were pushed to.
struct Holds {
  SlotSet anchored;
  std::array<std::vector<Bound>, 3> at_least{}, at_most{};  // per coordinate, ascending slots
};

}  // namespace supple
