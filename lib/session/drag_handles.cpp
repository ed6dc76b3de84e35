#include "lib/session/drag_handles.h"

namespace supple {

namespace {

/// The edge without what is taken, its parts with it.
void take_out(SoftEdge& edge, const SlotSet& taken) {
  SlotSet left = edge.slots;
  left.remove(taken);
  std::vector<double> parts;
  std::size_t n = 0;
  edge.slots.for_each([&](Slot slot) {
    if (left.contains(slot)) parts.push_back(edge.parts[n]);
    ++n;
  });
  edge = {std::move(left), std::move(parts)};
}

Region region_of(const SlotSet& slots, const BrickTopology& elements, std::string name) {
  std::vector<Vec3i> origins;
  std::vector<BrickMask> masks;
  for (const SlotSet::Brick& entry : slots.bricks()) {
    origins.push_back(elements.origin(entry.brick));
    masks.push_back(entry.mask);
  }
  return Region::of_mask(std::make_shared<BrickTopology>(std::move(origins), std::move(masks)),
                         std::move(name));
}

}  // namespace

std::vector<Handle> handles_of(const std::vector<Drag>& drags, const std::vector<Region>& regions,
                               const HandleSurroundings& around) {
  const Body& body = around.body;
  SlotSet taken = around.taken;
  for (std::size_t n = 0; n < drags.size(); ++n) {
    if (drags[n].soft_mm == 0) continue;
    for (const Region& region : regions) taken.add(elements_of(body, region, "grab"));
    break;
  }
  std::vector<Handle> handles;
  for (std::size_t n = 0; n < drags.size(); ++n) {
    const Drag& drag = drags[n];
    handles.emplace_back(regions[n], fixed_from_mm(drag.by_mm, body.geometry.spacing_mm()),
                         drag.kind);
    if (drag.motion.is_shift() && drag.soft_mm == 0) continue;
    const SlotSet slots = elements_of(body, regions[n], "grab");
    HandleMotion motion = drag.motion;
    if (!motion.about_lps_mm) motion.about_lps_mm = centre_lps_mm(body, slots);
    if (!motion.is_shift()) {
      handles.back().each_by_q = displacements_of(body, slots, motion, drag.by_mm);
    }
    if (drag.soft_mm == 0) continue;
    SoftEdge edge = soft_edge(*drag.selection, drag.soft_mm, body, around.density);
    take_out(edge, taken);
    if (edge.slots.empty()) continue;
    taken.add(edge.slots);
    Handle soft(region_of(edge.slots, body.elements, "edge of " + regions[n].name()), {0, 0, 0},
                around.edge_kind);
    soft.each_by_q = displacements_of(body, edge.slots, motion, drag.by_mm, edge.parts);
    soft.is_edge = true;
    handles.push_back(std::move(soft));
  }
  return handles;
}

}  // namespace supple
