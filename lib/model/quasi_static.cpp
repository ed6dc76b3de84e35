#include "lib/model/quasi_static.h"

#include "lib/relax/relaxation.h"

namespace supple {

std::vector<SlotSet> elements_of_handles(const Body& body, const std::vector<Handle>& handles) {
  std::vector<SlotSet> elements;
  for (const Handle& handle : handles) elements.push_back(elements_of(body, handle.region, "grab"));
  return elements;
}

std::vector<Reaction> quasi_static_reactions(const HeldBody& held,
                                             const std::vector<SlotSet>& handles,
                                             const CellModuli& moduli) {
  const SlotSet anchored = anchored_elements(held.body, held.anchors, held.holds);
  return reactions(held.body, handles, anchored, held.holds, moduli);
}

}  // namespace supple
