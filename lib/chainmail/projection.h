// One coordinate of the projection of project.cpp, for those who keep offsets outside the body.
#pragma once

#include <vector>

#include "lib/chainmail/free_pieces.h"
#include "lib/chainmail/propagate.h"

namespace supple {

/// What holds an element from sinking below a value and from rising above one.
struct HeldBounds {
  std::vector<Seed> least, most;
};

/// The half-way values of the envelopes, within the bounds where the links allow that: they satisfy
/// every link. `values` meet the bounds, and `propagator` is that of the body. Each of the `pieces`
/// shifts as one. Throws Cancelled.
BrickValues projected(const BrickValues& values, int coordinate, const HeldBounds& bounds,
                      Propagator& propagator, Progress* progress = nullptr,
                      const FreePieces& pieces = {});

}  // namespace supple
