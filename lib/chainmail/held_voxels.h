// What a drag holds, found in the body: grabbed elements with their displacements, elements that
// stay, and bounds that earlier push handles left.
#pragma once

#include <array>
#include <vector>

#include "lib/chainmail/ecm.h"
#include "lib/chainmail/propagate.h"

namespace supple {

/// A handle in the body; `source` is the handle as given and outlives the drag.
struct HeldHandle {
  SlotSet slots;
  const Handle* source;
  /// Of a push handle, per coordinate: the elements that it keeps from sinking, and from rising,
  /// with the tool's place before the drag.
  std::array<std::vector<Bound>, 3> below = {}, above = {};

  bool is_push() const { return source->kind == HandleKind::push; }
  std::int32_t by(int coordinate) const { return source->by_q[std::size_t(coordinate)]; }
};

/// Anchors found in the body.
struct FixedElements {
  std::vector<Region> regions;
  SlotSet slots;
};

/// What stays where it is: `fixed` and `rest.still`.
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
/// handles or in a handle and an anchor, a target beyond the range of +-16384 voxels. Cost: the
/// bricks of handles and holds, the offsets of the grabbed elements and the bounds.
HeldVoxels hold(const Body& body, const std::vector<Handle>& handles, const FixedElements& fixed,
                const Holds& holds);

}  // namespace supple
