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

/// Throws InputError for an element that is grabbed and fixed.
void require_free(const Body& body, const std::vector<HeldHandle>& handles,
                  const FixedElements& fixed, const SlotSet& grabbed) {
  Slot slot;
  if (!fixed.slots.first_common(grabbed, slot)) return;
  for (const Region& region : fixed.regions) {
    if (!elements_of(body, region, "fix").contains(slot)) continue;
    for (const HeldHandle& handle : handles) {
      if (!handle.slots.contains(slot)) continue;
      throw_shared(body, grab_name(*handle.source), "fix " + region.name(), slot);
    }
  }
}

void require_moves(const HeldHandle& handle) {
  const std::size_t given = handle.source->each_by_q.size(), elements = handle.slots.size();
  if (handle.moves_as_one() || given == elements) return;
  throw InputError({"", grab_name(*handle.source), std::to_string(given) + " displacements",
                    "one for each of " + std::to_string(elements) + " elements"});
}

void require_range(const Body& body, const HeldHandle& handle) {
  for (std::size_t c = 0; c < 3; ++c) {
    std::int64_t furthest = 0, longest = 0;
    std::size_t n = 0;
    handle.slots.for_each([&](Slot slot) {
      const std::int64_t by = handle.by(n++)[c];
      const std::int64_t target = body.q[c].at(slot) + by;
      if (std::llabs(target) > std::llabs(furthest)) furthest = target;
      if (std::llabs(by) > std::llabs(longest)) longest = by;
    });
    if (std::llabs(furthest) <= kMaxOffset && std::llabs(longest) < kMaxOffset) continue;
    throw InputError({"", grab_name(*handle.source),
                      "a move by " + number_text(double(longest) / kFixedOne) +
                          " voxels to an offset of " + number_text(double(furthest) / kFixedOne) +
                          " voxels along axis " + "ijk"[c],
                      "moves and offsets within +-16383 voxels"});
  }
}

const Bound* find_bound(const std::vector<Bound>& bounds, Slot slot) {
  const auto found =
      std::lower_bound(bounds.begin(), bounds.end(), slot,
                       [](const Bound& bound, Slot wanted) { return bound.slot < wanted; });
  return found != bounds.end() && found->slot == slot ? &*found : nullptr;
}

/// Places a tool. One that is still there keeps its place and side; a new one begins at the
/// elements, on the side that it moves away from. An edge always does: a bound that it left would
/// hold elements back from a handle that turns round.
void place_tool(const Body& body, const Holds& earlier, HeldHandle& handle) {
  for (std::size_t c = 0; c < 3; ++c) {
    std::size_t n = 0;
    handle.slots.for_each([&](Slot slot) {
      const std::int32_t by = handle.by(n++)[c];
      const bool goes_on = !handle.source->is_edge;
      if (const Bound* least = goes_on ? find_bound(earlier.at_least[c], slot) : nullptr) {
        handle.below[c].push_back({slot, least->value, by});
      } else if (const Bound* most = goes_on ? find_bound(earlier.at_most[c], slot) : nullptr) {
        handle.above[c].push_back({slot, most->value, by});
      } else if (by != 0) {
        (by > 0 ? handle.below : handle.above)[c].push_back({slot, body.q[c].at(slot), by});
      }
    });
  }
}

/// Moves bounds that an element has passed already, as after a projection, to where it is.
Holds met_by(const Body& body, Holds holds) {
  for (std::size_t c = 0; c < 3; ++c) {
    for (Bound& bound : holds.at_least[c]) {
      bound.value = std::min(bound.value, body.q[c].at(bound.slot));
    }
    for (Bound& bound : holds.at_most[c]) {
      bound.value = std::max(bound.value, body.q[c].at(bound.slot));
    }
  }
  return holds;
}

std::vector<Bound> without(const std::vector<Bound>& bounds, const SlotSet& set) {
  std::vector<Bound> kept;
  std::copy_if(bounds.begin(), bounds.end(), std::back_inserter(kept),
               [&](const Bound& bound) { return !set.contains(bound.slot); });
  return kept;
}

}  // namespace

FixedElements fix(const Body& body, const std::vector<Region>& regions) {
  std::vector<SlotSet::Brick> bricks;
  for (const Region& region : regions) {
    const SlotSet own = elements_of(body, region, "fix");
    bricks.insert(bricks.end(), own.bricks().begin(), own.bricks().end());
  }
  return {regions, SlotSet(std::move(bricks))};
}

HeldVoxels hold(const Body& body, const std::vector<Handle>& handles, const FixedElements& fixed,
                const Holds& holds) {
  const Holds earlier = met_by(body, holds);
  HeldVoxels held;
  for (const Handle& handle : handles) {
    held.handles.push_back({elements_of(body, handle.region, "grab"), &handle});
    require_moves(held.handles.back());
    require_range(body, held.handles.back());
    if (handle.kind == HandleKind::push) place_tool(body, earlier, held.handles.back());
  }
  held.grabbed = all_grabbed(body, held.handles);
  require_free(body, held.handles, fixed, held.grabbed);
  held.fixed = &fixed.slots;

  held.rest.anchored = earlier.anchored;
  held.rest.anchored.remove(held.grabbed);
  for (std::size_t c = 0; c < 3; ++c) {
    held.rest.at_least[c] = without(earlier.at_least[c], held.grabbed);
    held.rest.at_most[c] = without(earlier.at_most[c], held.grabbed);
  }
  return held;
}

Holds without_sides(const Holds& holds, const std::string& field) {
  for (const auto* side : {&holds.at_least, &holds.at_most}) {
    for (const std::vector<Bound>& bounds : *side) {
      if (std::all_of(bounds.begin(), bounds.end(),
                      [](const Bound& bound) { return bound.asks; })) {
        continue;
      }
      throw InputError({"", field, "a push handle of an earlier drag, still held",
                        "its release before, or a handle that holds"});
    }
  }
  Holds kept;
  kept.anchored = holds.anchored;
  return kept;
}

}  // namespace supple
