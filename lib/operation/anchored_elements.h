// Elements of a body that links join to anchors.
#pragma once

#include <vector>

#include "lib/body/slot_set.h"

namespace supple {

/// Per brick, those elements of `left` that uncut links along axes join to an anchor by way of
/// others. Whole bricks of bits at a time: about 0.5 ns per element of the body.
std::vector<BrickMask> anchored_elements(const BrickTopology& elements, const LinkCuts& cuts,
                                         const std::vector<BrickMask>& left,
                                         const SlotSet& anchors);

}  // namespace supple
