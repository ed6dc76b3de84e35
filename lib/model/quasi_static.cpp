#include "lib/model/quasi_static.h"

#include "lib/relax/relaxation.h"

namespace supple {

std::vector<Reaction> quasi_static_reactions(const HeldBody& held,
                                             const std::vector<Handle>& handles,
                                             double volume_stiffness_kpa) {
  std::vector<SlotSet> elements;
  for (const Handle& handle : handles) {
    elements.push_back(elements_of(held.body, handle.region, "grab"));
  }
  const SlotSet still = still_elements(held.body, held.anchors, held.holds);
  return reactions(held.body, elements, still, held.holds, volume_stiffness_kpa);
}

}  // namespace supple
