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

  std::int32_t by(int coordinate) const { return source->by_q[std::size_t(coordinate)]; }
  /// Whether it keeps its elements from sinking (raise) or rising (lower) beyond their targets.
  bool bounds(Direction direction, int coordinate) const {
    if (source->kind == HandleKind::two_sided) return true;
    return direction == Direction::raise ? by(coordinate) > 0 : by(coordinate) < 0;
  }
};

struct HeldVoxels {
  std::vector<HeldHandle> handles;
  SlotSet grabbed;                                      // the elements of all handles
  SlotSet anchors;                                      // stay where they are
  std::array<std::vector<Bound>, 3> at_least, at_most;  // per coordinate, ascending slots
};

/// Finds handles and anchors in the body. Elements that are grabbed are not held any more; a bound
/// that an element has already passed, as after a projection, counts from where it is. Throws
/// InputError: a region without element, a voxel in two handles or in a handle and an anchor, a
/// target beyond the range of +-16384 voxels. Cost: the bricks of all regions, and the offsets of
/// the grabbed elements.
HeldVoxels hold(const Body& body, const std::vector<Handle>& handles,
                const std::vector<Region>& anchors, const Holds& earlier);

}  // namespace supple
