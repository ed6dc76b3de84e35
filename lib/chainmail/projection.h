// One coordinate of the projection of project.cpp, for those who keep offsets outside the body.
#pragma once

#include "lib/chainmail/propagate.h"

namespace supple {

/// floor((L + U) / 2) of the values' envelopes: they satisfy every link afterwards. `propagator` is
/// that of the body. Throws Cancelled.
BrickValues projected(const BrickValues& values, int coordinate, Propagator& propagator,
                      Progress* progress = nullptr);

}  // namespace supple
