#include <limits>
#include <utility>

#include "volumes/field/offset_field.h"
#include "volumes/field/ring_fill.h"

namespace supple {

Displacement extend(Displacement displacement, const BrickTopology& target) {
  constexpr int kAllRings = std::numeric_limits<int>::max();
  displacement.u = fill_rings(std::move(displacement.u), target, kAllRings, RingFill::linear);
  return displacement;
}

}  // namespace supple
