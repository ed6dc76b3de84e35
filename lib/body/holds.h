// What does not move freely: elements that handles of earlier drags hold.
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
};

/// What the handles of earlier drags still hold in one body: elements of two-sided handles stay
/// where they are; those of push handles stay at or beyond where they were pushed to.
struct Holds {
  SlotSet anchored;
  std::array<std::vector<Bound>, 3> at_least{}, at_most{};  // per coordinate, ascending slots
};

}  // namespace supple
