// Slots of a body and their lattice neighbours, sets of slots, and what of them handles hold.
//
// Slot = 512 * brick + offset, in brick order. A neighbour inside the brick is an addition; at a
// brick's border BrickTopology::neighbour is asked. Only links that were cut are stored.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

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

/// A set of elements of one body: bit masks of the bricks that hold any, ascending. 72 bytes per
/// brick, so a compact region costs about a bit per voxel and scattered points 72 bytes each.
class SlotSet {
 public:
  struct Brick {
    std::uint32_t brick;
    BrickMask mask;
  };

  SlotSet() = default;
  /// Takes bricks in any order: masks of the same brick are united, empty ones dropped. O(n log n)
  /// in bricks.
  explicit SlotSet(std::vector<Brick> bricks);
  /// Takes slots in any order, duplicates allowed.
  explicit SlotSet(std::vector<Slot> slots);

  bool empty() const { return m_bricks.empty(); }
  /// Number of elements; one pass over the bricks.
  std::size_t size() const;
  const std::vector<Brick>& bricks() const { return m_bricks; }
  /// The mask of a brick, or null when the set has nothing there.
  const BrickMask* find(std::size_t brick) const;
  bool contains(Slot slot) const;
  /// Calls `visit(slot)`, ascending.
  template <class Visit>
  void for_each(Visit&& visit) const {
    for (const Brick& entry : m_bricks) {
      for_each_active(entry.mask,
                      [&](int offset) { visit(entry.brick * kBrickVoxels + Slot(offset)); });
    }
  }

  /// Smallest element of a set that is not empty.
  Slot first() const;
  /// Smallest element of both sets; false when they have none in common.
  bool first_common(const SlotSet& other, Slot& slot) const;
  void add(const SlotSet& other);
  void remove(const SlotSet& other);

 private:
  std::vector<Brick> m_bricks;
};

/// The elements inside a box; O(bricks of the box), or of the body where those are fewer.
SlotSet slots_in_box(const BrickTopology& elements, const IndexBox& box);
/// The elements that are active in `mask` too.
SlotSet slots_in_mask(const BrickTopology& elements, const BrickTopology& mask);

/// An offset that an element may not pass.
struct Bound {
  Slot slot;
  std::int32_t value;
  /// True where the soft edge of a handle left the bound: a place that the element was asked to
  /// take, not a tool beside it.
  bool asks = false;
};

/// Elements of one body that the handles of earlier drags still hold. Those of two-sided handles
/// stay where they are. Those of push handles stay at or beyond the place that they were pushed to.
struct Holds {
  SlotSet anchored;
  std::array<std::vector<Bound>, 3> at_least{}, at_most{};  // per coordinate, ascending slots
};

}  // namespace supple
