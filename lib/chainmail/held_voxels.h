// Elements that a drag holds, found in the body: grabbed ones with their displacements, ones that
// stay, and bounds that earlier push handles left.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "lib/chainmail/ecm.h"
#include "lib/chainmail/propagate.h"

namespace supple {

/// An element that a push handle holds from one side, the tool's place before the drag, and how far
/// the tool goes.
struct ToolPlace {
  Slot slot;
  std::int32_t value, by;
};

/// A handle in the body; `source` is the handle as given and outlives the drag.
struct HeldHandle {
  SlotSet slots;
  const Handle* source;
  /// Tool of a push handle, per coordinate: at the elements that it keeps from sinking, and from
  /// rising, ascending.
  std::array<std::vector<ToolPlace>, 3> below = {}, above = {};

  bool is_push() const { return source->kind == HandleKind::push; }
  bool moves_as_one() const { return source->each_by_q.empty(); }
  /// The displacement of the n-th of the slots.
  const std::array<std::int32_t, 3>& by(std::size_t n) const {
    return moves_as_one() ? source->by_q : source->each_by_q[n];
  }
};

/// Anchors found in the body.
struct FixedElements {
  std::vector<Region> regions;
  SlotSet slots;
};

/// Grabbed elements, and elements that stay where they are: `fixed` and `rest.anchored`.
struct HeldVoxels {
  std::vector<HeldHandle> handles;
  SlotSet grabbed;       // the elements of all handles
  const SlotSet* fixed;  // outlives the drag
  Holds rest;            // earlier holds of elements that are not grabbed
};

/// Finds anchors in the body. Throws InputError: a region without element. Cost: the bricks of all
/// regions.
FixedElements fix(const Body& body, const std::vector<Region>& regions);

/// Finds handles in the body. Elements that are grabbed are not held any more; a push handle goes
/// on from where it pushed them to. Throws InputError: a handle without element, a voxel in two
/// handles or in a handle and an anchor, a displacement for more or fewer elements than there are,
/// a target beyond the range of +-16384 voxels. Cost: the bricks of handles and holds, the offsets
/// of the grabbed elements and the bounds.
HeldVoxels hold(const Body& body, const std::vector<Handle>& handles, const FixedElements& fixed,
                const Holds& holds);

/// The part of earlier holds that a model without sides obeys, that of two-sided handles: soft
/// edges only asked, and are let go. Throws InputError, with `field`, for a tool that is still
/// held.
Holds without_sides(const Holds& holds, const std::string& field);

}  // namespace supple
