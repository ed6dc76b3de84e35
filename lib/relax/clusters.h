// Elements that step together. Links without slack join elements that can only move as one; links
// at their limits join elements that block each other, one pulled up and its neighbour down, though
// both together are pulled one way. A relaxation that steps elements one by one never moves the
// former (design.md section 3) and comes to rest too early at the latter.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "lib/body/body.h"
#include "lib/body/slot_set.h"
#include "lib/relax/link_table.h"
#include "volumes/grid/brick_values.h"

namespace supple {

// Disjoint sets of slots.

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

struct Clusters {
  /// A link out of a cluster.
  struct Boundary {
    Slot inside, outside;
    LinkValues values;
    std::int32_t rest;   // stretch upwards from the inside, 2^-16 voxel
    bool inside_is_low;  // end of the link
    bool shared;         // the other end moves with another cluster
  };

  std::vector<Slot> members;              // by cluster, ascending within
  std::vector<std::uint32_t> first;       // of each cluster in `members`; one more at the end
  std::vector<Boundary> boundary;         // by cluster
  std::vector<std::uint32_t> first_link;  // of each cluster in `boundary`; one more at the end

  std::size_t count() const { return first.empty() ? 0 : first.size() - 1; }
  std::size_t bytes() const;
};

/// Says whether the link of this kind from `low` to `high` joins its ends.
using Joins = std::function<bool(int kind, Slot low, Slot high)>;

/// Clusters of a part of a body that becomes larger and larger: every link is judged once, and
/// elements in the midst of a cluster are left alone.
class GrowingClusters {
 public:
  /// Body, table and what `joins` refers to must outlive this.
  GrowingClusters(const Body& body, const LinkTable& table, Joins joins);

  /// Joins elements by the links of these bricks (ascending, each given once).
  void add(const std::vector<std::uint32_t>& bricks);
  /// The clusters of at least two elements that links of the table's kinds join; numbered by their
  /// smallest slots, so that nothing depends on the order of the links.
  Clusters find();
  std::size_t bytes() const;

 private:
  using LinksOut = std::vector<std::pair<std::uint32_t, Clusters::Boundary>>;  // with clusters

  void join(Slot a, Slot b);
  std::uint32_t number(BrickValues& numbers);
  LinksOut links_out(std::uint32_t brick, const BrickValues& numbers);

  const Body& m_body;
  const LinkTable& m_table;
  Joins m_joins;
  SlotForest m_forest;
  std::vector<BrickMask> m_outer;       // elements with links out of their clusters, or others
  std::vector<std::uint32_t> m_bricks;  // with joined elements, ascending once they are found
};

/// The clusters of these bricks (ascending) alone.
Clusters find_clusters(const Body& body, const LinkTable& table,
                       const std::vector<std::uint32_t>& bricks, const Joins& joins);

}  // namespace supple
