// Disjoint sets of slots.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "lib/body/slot_set.h"
#include "volumes/grid/brick_values.h"

namespace supple {

/// A set's root is its smallest slot. Slots that were never joined cost nothing where their brick
/// has no joined one.
class SlotForest {
 public:
  explicit SlotForest(std::size_t bricks) : m_parent(bricks) {}

  bool has_joined(std::size_t brick) const { return m_parent.brick(brick) != nullptr; }
  bool is_joined(Slot slot) const { return m_parent.at(slot) != 0; }
  bool is_root(Slot slot) const { return m_parent.at(slot) == std::int32_t(slot + 1); }
  /// The root of a joined slot.
  Slot root(Slot slot) const {
    for (Slot parent = parent_of(slot); parent != slot; parent = parent_of(slot)) slot = parent;
    return slot;
  }
  /// Unites the sets of two joined slots.
  void join(Slot a, Slot b) {
    a = shortened(a);
    b = shortened(b);
    set_root(std::max(a, b), std::min(a, b));
  }
  /// Sets the parent of a slot, itself or another slot of its set; it is joined from now on.
  /// Threads may do so together in bricks with joined slots, while none asks for roots.
  void set_root(Slot slot, Slot root) {
    m_parent.touch(slot / kBrickVoxels)[slot % kBrickVoxels] = std::int32_t(root + 1);
  }

  std::size_t bytes() const { return m_parent.bytes(); }

 private:
  // One more than the parent, so that 0 stands for none.
  Slot parent_of(Slot slot) const { return Slot(m_parent.at(slot)) - 1; }
  /// Finds the root, and halves the path to it.
  Slot shortened(Slot slot) {
    Slot parent = parent_of(slot);
    while (parent != slot) {
      const Slot above = parent_of(parent);
      set_root(slot, above);
      slot = above;
      parent = parent_of(slot);
    }
    return slot;
  }

  BrickValues m_parent;
};

}  // namespace supple
