#include "lib/session/drag_handles.h"

#include <algorithm>

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

std::int32_t part_of(std::int32_t by, double part) {
  return part == 1 ? by : std::int32_t(double(by) * part);
}

void shorten(Handle& handle, double part) {
  for (std::int32_t& by : handle.by_q) by = part_of(by, part);
  for (auto& each : handle.each_by_q) {
    for (std::int32_t& by : each) by = part_of(by, part);
  }
}

/// The elements of a drag that no rigid piece has, and the pieces that it is the first to take.
void add_grabbed(const Drag& drag, std::size_t number, const Region& region,
                 const HandleMotion& motion, const HandleSurroundings& around,
                 std::vector<Handle>& handles) {
  const Body& body = around.body;
  Handle handle(region, fixed_from_mm(drag.by_mm, body.geometry.spacing_mm()), drag.kind);
  const bool is_rigid = around.pieces != nullptr && drag.kind == HandleKind::two_sided;
  SlotSet slots;
  bool is_left = true;
  if (is_rigid || !motion.is_shift()) slots = elements_of(body, region, "grab");
  if (is_rigid) {
    const std::size_t grabbed = slots.size();
    for (const PieceMotion& piece : *around.pieces) {
      slots.remove(*body.rigid.list[piece.piece].elements);
    }
    is_left = !slots.empty();
    if (is_left && slots.size() != grabbed) {
      handle.region = region_of(slots, body.elements, region.name());
    }
  }
  if (is_left) {
    if (!motion.is_shift()) {
      handle.each_by_q = displacements_of(body, slots, motion, drag.by_mm);
    }
    shorten(handle, around.part);
    handles.push_back(std::move(handle));
  }
  if (!is_rigid) return;
  for (const PieceMotion& piece : *around.pieces) {
    if (piece.drag != number) continue;
    Handle whole = handle_of(body, piece, around.part);
    whole.is_edge = is_left;
    is_left = true;
    handles.push_back(std::move(whole));
  }
}

void add_handles(const Drag& drag, std::size_t number, const Region& region,
                 const HandleSurroundings& around, SlotSet& taken, std::vector<Handle>& handles) {
  const Body& body = around.body;
  HandleMotion motion = drag.motion;
  const bool is_plain = motion.is_shift() && drag.soft_mm == 0;
  if (!is_plain && !motion.about_lps_mm) {
    motion.about_lps_mm = centre_lps_mm(body, elements_of(body, region, "grab"));
  }
  add_grabbed(drag, number, region, motion, around, handles);
  if (drag.soft_mm == 0) return;
  SoftEdge edge = soft_edge(*drag.selection, drag.soft_mm, body, around.density);
  take_out(edge, taken);
  if (edge.slots.empty()) return;
  taken.add(edge.slots);
  Handle soft(region_of(edge.slots, body.elements, "edge of " + region.name()), {0, 0, 0},
              around.edge_kind);
  soft.each_by_q = displacements_of(body, edge.slots, motion, drag.by_mm, edge.parts);
  soft.is_edge = true;
  shorten(soft, around.part);
  handles.push_back(std::move(soft));
}

}  // namespace

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

std::vector<Handle> handles_of(const std::vector<Drag>& drags, const std::vector<Region>& regions,
                               const HandleSurroundings& around) {
  SlotSet taken = around.taken;
  const bool has_edges =
      std::any_of(drags.begin(), drags.end(), [](const Drag& drag) { return drag.soft_mm > 0; });
  if (has_edges) {
    for (const Region& region : regions) taken.add(elements_of(around.body, region, "grab"));
    for (const RigidPiece& piece : around.body.rigid.list) taken.add(*piece.elements);
  }
  std::vector<Handle> handles;
  for (std::size_t n = 0; n < drags.size(); ++n) {
    add_handles(drags[n], n, regions[n], around, taken, handles);
  }
  return handles;
}

}  // namespace supple
