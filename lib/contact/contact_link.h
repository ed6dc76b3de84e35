// One-sided links of one coordinate between elements that no link of the lattice joins: contacts.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/body/slot_set.h"

namespace supple {

/// Demands q of `above` >= q of `below` + least. Nothing bounds it from the other side.
struct ContactLink {
  Slot below, above;
  std::int64_t least;
};

}  // namespace supple
