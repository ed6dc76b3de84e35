#include "lib/chainmail/held_voxels.h"

#include <algorithm>
#include <cstdlib>

#include "volumes/base/error.h"

namespace supple {

namespace {

/// Names the two regions that share an element.
[[noreturn]] void throw_shared(const Body& body, const std::string& first,
                               const std::string& second, Slot slot) {
  throw InputError({"", first + " and " + second,
                    "voxel " + voxel_text(voxel_of(body.elements, slot)) + " in both",
                    "every voxel in one of them"});
}

std::string grab_name(const Handle& handle) {
  return "grab " + handle.region.name();
}

/// The union of all handles; an element that two of them hold is an error.
SlotSet all_grabbed(const Body& body, const std::vector<HeldHandle>& handles) {
  std::vector<SlotSet::Brick> bricks;
  std::size_t grabbed = 0;
  for (const HeldHandle& handle : handles) {
    const auto& own = handle.slots.bricks();
    bricks.insert(bricks.end(), own.begin(), own.end());
    grabbed += handle.slots.size();
  }
  const SlotSet all(std::move(bricks));
  if (all.size() == grabbed) return all;
  for (std::size_t b = 1; b < handles.size(); ++b) {
    for (std::size_t a = 0; a < b; ++a) {
      Slot slot;
      if (handles[a].slots.first_common(handles[b].slots, slot)) {
        throw_shared(body, grab_name(*handles[a].source), grab_name(*handles[b].source), slot);
      }
    }
  }
  return all;
}

SlotSet all_anchored(const Body& body, const std::vector<Region>& anchors,
                     const std::vector<HeldHandle>& handles, const SlotSet& grabbed) {
  std::vector<SlotSet::Brick> bricks;
  for (const Region& anchor : anchors) {
    const SlotSet own = elements_of(body, anchor, "fix");
    Slot slot;
    if (own.first_common(grabbed, slot)) {
      for (const HeldHandle& handle : handles) {
        if (!handle.slots.contains(slot)) continue;
        throw_shared(body, grab_name(*handle.source), "fix " + anchor.name(), slot);
      }
    }
    bricks.insert(bricks.end(), own.bricks().begin(), own.bricks().end());
  }
  return SlotSet(std::move(bricks));
}

void require_range(const Body& body, const HeldHandle& handle) {
  for (int c = 0; c < 3; ++c) {
    const std::int64_t by = handle.by(c);
    std::int64_t furthest = 0;
    handle.slots.for_each([&](Slot slot) {
      const std::int64_t target = body.q[std::size_t(c)].at(slot) + by;
      if (std::llabs(target) > std::llabs(furthest)) furthest = target;
    });
    if (std::llabs(furthest) <= kMaxOffset && std::llabs(by) < kMaxOffset) continue;
    throw InputError({"", grab_name(*handle.source),
                      "a move by " + number_text(double(by) / kFixedOne) +
                          " voxels to an offset of " + number_text(double(furthest) / kFixedOne) +
                          " voxels along axis " + "ijk"[c],
                      "moves and offsets within +-16383 voxels"});
  }
}

}  // namespace

HeldVoxels hold(const Body& body, const std::vector<Handle>& handles,
                const std::vector<Region>& anchors, const Holds& earlier) {
  HeldVoxels held;
  for (const Handle& handle : handles) {
    held.handles.push_back({elements_of(body, handle.region, "grab"), &handle});
    require_range(body, held.handles.back());
  }
  held.grabbed = all_grabbed(body, held.handles);
  held.anchors = all_anchored(body, anchors, held.handles, held.grabbed);

  SlotSet still = earlier.still;
  still.remove(held.grabbed);
  held.anchors.add(still);
  for (std::size_t c = 0; c < 3; ++c) {
    for (const Bound& bound : earlier.at_least[c]) {
      if (held.grabbed.contains(bound.slot)) continue;
      held.at_least[c].push_back({bound.slot, std::min(bound.value, body.q[c].at(bound.slot))});
    }
    for (const Bound& bound : earlier.at_most[c]) {
      if (held.grabbed.contains(bound.slot)) continue;
      held.at_most[c].push_back({bound.slot, std::max(bound.value, body.q[c].at(bound.slot))});
    }
  }
  return held;
}

}  // namespace supple
