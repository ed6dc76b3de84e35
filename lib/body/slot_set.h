// A set of elements of one body: bit masks of the bricks that hold any, ascending. 72 bytes per
// brick, so a compact region costs about a bit per voxel and scattered points 72 bytes each.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/body/lattice.h"

namespace supple {

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

}  // namespace supple
