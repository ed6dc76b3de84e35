// Removal of elements from a body: they are void from then on.
#pragma once

#include "lib/body/slot_set.h"
#include "lib/session/handle_ledger.h"
#include "lib/session/handles/selection.h"
#include "lib/state/state.h"

namespace supple {

struct RemovedElements {
  SlotSet slots;
  /// Part of its density that a removed element leaves behind, 0 to 1.
  BrickArray<double> left_share;

  /// Removes these, too. `selection` selected them; it may be null.
  void add(const SlotSet& more, const Selection* selection, const Body& body);
};

/// The state without these elements of its body: densities there are those of the air around the
/// volume, but for a part of their own within a voxel of the surface of a removed ball, so that its
/// rim is round in pictures. Offsets, labels and cuts go with them, and anchors without an element
/// left. Densities further than two voxels from the remaining elements go, too. Throws InputError
/// where nothing is left.
State without_elements(const State& state, const RemovedElements& removed);

/// The elements of a set on the bricks of another topology, as far as it has them.
SlotSet moved_to(const BrickTopology& from, const BrickTopology& to, const SlotSet& set);
Holds moved_to(const BrickTopology& from, const BrickTopology& to, const Holds& holds);

}  // namespace supple
