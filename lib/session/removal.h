// Taking elements out of a body: what is removed is void from then on.
#pragma once

#include "lib/body/holds.h"
#include "lib/session/handle_ledger.h"
#include "volumes/state/state.h"

namespace supple {

/// The state without these elements of its body: densities there are those of the air around the
/// volume, offsets, labels and cuts go with them, and anchors without an element left. Densities
/// further than two voxels from what is left go, too. Throws InputError where nothing is left.
State without_elements(const State& state, const SlotSet& removed);

/// The elements of a set on the bricks of another topology, as far as it has them.
SlotSet moved_to(const BrickTopology& from, const BrickTopology& to, const SlotSet& set);
Holds moved_to(const BrickTopology& from, const BrickTopology& to, const Holds& holds);

}  // namespace supple
