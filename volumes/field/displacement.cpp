#include "volumes/field/displacement.h"

#include <limits>

#include "volumes/field/ring_fill.h"

namespace supple {

Displacement extend(const Displacement& displacement, const BrickTopology& target) {
  constexpr int kAllRings = std::numeric_limits<int>::max();
  return {displacement.geometry, fill_rings(displacement.u, target, kAllRings, RingFill::linear)};
}

}  // namespace supple
