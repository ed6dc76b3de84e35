#include "lib/session/handles/drag_handles.h"

#include <algorithm>
#include <cstdint>
#include <limits>

#include "lib/session/handles/handle_motion.h"

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
  if (!handle.steps || part == 1) return;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Vec3d& step = handle.steps->after[axis];
    const Vec3d& before = handle.steps->before[axis];
    step = before + (step - before) * part;
  }
}

const Body& start_of(const HandleSurroundings& around) {
  return around.start != nullptr ? *around.start : around.body;
}

/// The motion with the point that it goes about, which is meant from where it starts.
HandleMotion centred(HandleMotion motion, const Drag& drag, const Region& region,
                     const HandleSurroundings& around) {
  const bool is_plain = motion.is_shift() && drag.soft_mm == 0;
  if (!is_plain && !motion.about_lps_mm) {
    const Body& start = start_of(around);
    motion.about_lps_mm = centre_lps_mm(start, elements_of(start, region, "grab"));
  }
  return motion;
}

/// Displacements from `start` become those from now on: of a tool, from where it was at the pose
/// before; of all else, from where elements are. Those that an edge has taken further ask nothing.
void go_on(Handle& handle, const SlotSet& slots, const Displacements& earlier,
           const HandleSurroundings& around) {
  constexpr std::int64_t kMost = std::numeric_limits<std::int32_t>::max();
  const bool is_wish = handle.kind == HandleKind::push && handle.is_edge;
  const bool is_tool = handle.kind == HandleKind::push && !handle.is_edge;
  Displacements ways;
  slots.for_each([&](Slot slot) {
    const std::size_t n = ways.size();
    auto& by = ways.emplace_back(handle.each_by_q.empty() ? handle.by_q : handle.each_by_q[n]);
    for (std::size_t c = 0; c < 3; ++c) {
      const std::int64_t moved =
          std::int64_t(around.body.q[c].at(slot)) - around.start->q[c].at(slot);
      const std::int64_t left = by[c] - (is_tool ? std::int64_t(earlier[n][c]) : moved);
      const bool is_passed = is_wish && (by[c] > 0 ? left < 0 : left > 0 || by[c] == 0);
      by[c] = is_passed ? 0 : std::int32_t(std::clamp(left, -kMost, kMost));
    }
  });
  const bool is_even =
      std::all_of(ways.begin(), ways.end(), [&](const auto& by) { return by == ways.front(); });
  if (is_even) handle.by_q = ways.front();
  handle.each_by_q = is_even ? Displacements() : std::move(ways);
}

/// Returns the steps of a motion that the drags at the pose before have begun from `start`.
StepMotion begun_at(const Body& start, const SlotSet& slots, const GridSteps& before,
                    const GridSteps& after) {
  StepMotion steps{before, after, {}};
  slots.for_each([&](Slot slot) {
    steps.start_q.push_back({start.q[0].at(slot), start.q[1].at(slot), start.q[2].at(slot)});
  });
  return steps;
}

/// The elements of a drag that no rigid piece has, and the pieces that it is the first to take.
void add_grabbed(const Drag& drag, std::size_t number, const Region& region,
                 const HandleMotion& motion, const HandleSurroundings& around,
                 std::vector<Handle>& handles) {
  const Body& body = around.body;
  Handle handle(region, fixed_from_mm(drag.by_mm, body.geometry.spacing_mm()),
                drag.pushes ? HandleKind::push : HandleKind::two_sided);
  const bool is_rigid = around.pieces != nullptr && !drag.pushes;
  SlotSet slots;
  bool is_left = true;
  if (is_rigid || !motion.is_shift() || around.start != nullptr) {
    slots = elements_of(body, region, "grab");
  }
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
      handle.each_by_q = displacements_of(start_of(around), slots, motion, drag.by_mm);
      handle.steps = StepMotion{kUnitSteps, steps_of(motion, body.geometry), {}};
    }
    if (around.start != nullptr) {
      const Drag& before = (*around.earlier)[number];
      const HandleMotion earlier = centred(before.motion, before, region, around);
      go_on(handle, slots, displacements_of(*around.start, slots, earlier, before.by_mm), around);
      handle.steps = begun_at(*around.start, slots, steps_of(earlier, body.geometry),
                              steps_of(motion, body.geometry));
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
  const HandleMotion motion = centred(drag.motion, drag, region, around);
  add_grabbed(drag, number, region, motion, around, handles);
  if (drag.soft_mm == 0) return;
  SoftEdge edge = soft_edge(*drag.selection, drag.soft_mm, body, around.cuts, around.density);
  take_out(edge, taken);
  if (edge.slots.empty()) return;
  taken.add(edge.slots);
  Handle soft(region_of(edge.slots, body.elements, "edge of " + region.name()), {0, 0, 0},
              around.edge_kind);
  soft.each_by_q = displacements_of(start_of(around), edge.slots, motion, drag.by_mm, edge.parts);
  soft.is_edge = true;
  if (around.start != nullptr) go_on(soft, edge.slots, {}, around);
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
