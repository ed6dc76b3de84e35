// Directions that a hand's target needs: it is followed where it is a sum of theirs.
#pragma once

#include <vector>

#include "lib/session/fem_step.h"
#include "lib/session/handles/drag.h"

namespace supple {

/// The directions that a target lacks beside these, kMostDirections in all at most: a shift across
/// the others; of a first axis its two turns; where there is another axis, as many turns as span
/// all linear maps.
std::vector<HandDirection> lacking_directions(const DragPose& target,
                                              const std::vector<HandDirection>& directions,
                                              const Geometry& geometry);

}  // namespace supple
