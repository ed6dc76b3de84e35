// Work of a drag by Enhanced ChainMail, for plans.
#pragma once

#include "volumes/base/unit_cost.h"

namespace supple {

constexpr UnitCost kEcmElementCost = {"ecm_element", 20,
                                      "An element that ECM moves, per coordinate"};

/// Looks at an element with these links of the material, in those of 6.
constexpr double ecm_looks(int links) {
  return links == 26 ? 5 : links == 18 ? 3 : 1;
}

}  // namespace supple
