// Links of a voxel where the material has diagonals (18 or 26 links). A diagonal link joins two
// elements that some path of uncut axis links joins which steps once along each of its axes. So it
// never crosses a cut or a gap, and bodies fall into the same pieces as with 6 links.
#pragma once

#include <array>

#include "lib/body/slot_set.h"
#include "lib/material/material.h"

namespace supple {

/// Calls `visit(direction, to)` for every link of an element: axes, then diagonals of faces, then
/// those of cells. Up to 54 steps along the lattice.
template <class Visit>
void for_each_linked(const BrickTopology& elements, const LinkCuts& cuts, int links, Slot from,
                     Visit&& visit) {
  constexpr Slot kNone = ~Slot(0);
  std::array<Slot, kDirections> at;
  at.fill(kNone);
  at[kNoStep] = from;
  for (int axes = 1; axes <= (links == 6 ? 1 : links == 18 ? 2 : 3); ++axes) {
    for (int direction = 0; direction < kDirections; ++direction) {
      if (axes_of_direction(direction) != axes) continue;
      // The last step of a path: along any of the axes, from where the others lead.
      const LinkStep step = step_of_direction(direction);
      Slot& end = at[std::size_t(direction)];
      for (int axis = 0; axis < 3 && end == kNone; ++axis) {
        const int way = step[std::size_t(axis)];
        if (way == 0) continue;
        const int before = direction - (direction_along(axis, way > 0) - kNoStep);
        const Slot last = at[std::size_t(before)];
        if (last != kNone && !neighbour_slot(elements, cuts, last, axis, way > 0, end)) end = kNone;
      }
      if (end != kNone) visit(direction, end);
    }
  }
}

}  // namespace supple
