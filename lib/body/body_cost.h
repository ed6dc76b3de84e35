// Memory and work of a body that is opened, for plans.
#pragma once

#include "volumes/base/unit_cost.h"

namespace supple {

constexpr UnitCost kBodyElementCost = {"body_element", 25,
                                       "An element of the body, its links checked"};
constexpr double kBodyBytes = 600;  // of a brick of elements
constexpr double kPieceNs = 700;    // to find rigid pieces, per element

}  // namespace supple
