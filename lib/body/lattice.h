// Slots of a body and their lattice neighbours: slot = 512 * brick + offset, in brick order.
// A neighbour inside the brick is an addition; at a brick's border BrickTopology::neighbour is
// asked. Only links that were cut are stored.
#pragma once

#include <cstdint>

#include "volumes/grid/brick_topology.h"
#include "volumes/grid/link_cuts.h"

namespace supple {

using Slot = std::uint32_t;

constexpr int kSlotStride[3] = {64, 8, 1};

inline std::size_t slot_count(const BrickTopology& elements) {
  return elements.brick_count() * kBrickVoxels;
}

/// Slot of a voxel; false when it is no element.
inline bool slot_of(const BrickTopology& elements, const Vec3i& voxel, Slot& slot) {
  const std::int32_t brick = elements.find(voxel);
  const int offset = brick_offset(voxel);
  if (brick < 0 || !mask_test(elements.mask(brick), offset)) return false;
  slot = Slot(brick) * kBrickVoxels + Slot(offset);
  return true;
}

inline Vec3i voxel_of(const BrickTopology& elements, Slot slot) {
  return elements.origin(slot / kBrickVoxels) + brick_local(int(slot % kBrickVoxels));
}

/// The element that a link joins one step along `axis`; false when there is none or it is cut.
inline bool neighbour_slot(const BrickTopology& elements, const LinkCuts& cuts, Slot slot, int axis,
                           bool positive, Slot& neighbour) {
  const Slot brick = slot / kBrickVoxels;
  const int offset = int(slot % kBrickVoxels);
  const int stride = kSlotStride[axis];
  const int local = (offset / stride) & 7;
  std::int32_t other = std::int32_t(brick);
  int other_offset;
  if (local != (positive ? 7 : 0)) {
    other_offset = positive ? offset + stride : offset - stride;
  } else {
    other = elements.neighbour(brick, 2 * axis + (positive ? 1 : 0));
    if (other < 0) return false;
    other_offset = positive ? offset - 7 * stride : offset + 7 * stride;
  }
  if (!mask_test(elements.mask(other), other_offset)) return false;
  if (!cuts.empty() && (positive ? cuts.is_cut(brick, offset, axis)
                                 : cuts.is_cut(std::size_t(other), other_offset, axis))) {
    return false;
  }
  neighbour = Slot(other) * kBrickVoxels + Slot(other_offset);
  return true;
}

/// Calls `visit(slot)` for every element, in brick order.
template <class Visit>
void for_each_element(const BrickTopology& elements, Visit&& visit) {
  for (std::size_t b = 0; b < elements.brick_count(); ++b) {
    for_each_active(elements.mask(b),
                    [&](int offset) { visit(Slot(b * kBrickVoxels + std::size_t(offset))); });
  }
}

/// Calls `visit(axis, low, high)` for every link of brick b whose low end lies in it.
template <class Visit>
void for_each_link(const BrickTopology& elements, const LinkCuts& cuts, std::size_t b,
                   Visit&& visit) {
  for_each_active(elements.mask(b), [&](int offset) {
    const Slot low = Slot(b * kBrickVoxels + std::size_t(offset));
    Slot high;
    for (int axis = 0; axis < 3; ++axis) {
      if (neighbour_slot(elements, cuts, low, axis, true, high)) visit(axis, low, high);
    }
  });
}

}  // namespace supple
