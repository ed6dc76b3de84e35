// One-sided links of one coordinate between elements that no link of the lattice joins: contacts.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/body/lattice.h"

namespace supple {

/// q of `above` is to be at least q of `below` + least; nothing bounds it from the other side.
struct ContactLink {
  Slot below, above;
  std::int64_t least;
};

}  // namespace supple
