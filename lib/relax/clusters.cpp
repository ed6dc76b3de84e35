#include "lib/relax/clusters.h"

#include <algorithm>

#include "lib/relax/grouped.h"

namespace supple {

namespace {

/// Disjoint sets of slots; a set's root is its smallest slot. Slots that were never joined cost
/// nothing where their brick has no joined one.
class SlotForest {
 public:
  explicit SlotForest(std::size_t bricks) : m_parent(bricks) {}

  bool has_joined(std::size_t brick) const { return m_parent.brick(brick) != nullptr; }
  bool is_joined(Slot slot) const { return m_parent.at(slot) != 0; }
  /// Of a joined slot.
  Slot root(Slot slot) {
    Slot parent = parent_of(slot);
    while (parent != slot) {
      const Slot above = parent_of(parent);
      set(slot, above);
      slot = above;
      parent = parent_of(slot);
    }
    return slot;
  }
  void join(Slot a, Slot b) {
    if (!is_joined(a)) set(a, a);
    if (!is_joined(b)) set(b, b);
    a = root(a);
    b = root(b);
    set(std::max(a, b), std::min(a, b));
  }

 private:
  // One more than the parent, so that 0 stands for none.
  Slot parent_of(Slot slot) const { return Slot(m_parent.at(slot)) - 1; }
  void set(Slot slot, Slot parent) { m_parent.set(slot, std::int32_t(parent + 1)); }

  BrickValues m_parent;
};

constexpr std::uint32_t kNone = ~std::uint32_t(0);

/// Which cluster a slot is in.
class ClusterNumbers {
 public:
  explicit ClusterNumbers(std::size_t bricks) : m_numbers(bricks) {}
  std::uint32_t operator[](Slot slot) const { return std::uint32_t(m_numbers.at(slot)) - 1; }
  void set(Slot slot, std::uint32_t number) { m_numbers.set(slot, std::int32_t(number + 1)); }

 private:
  BrickValues m_numbers;
};

}  // namespace

std::size_t Clusters::bytes() const {
  return members.capacity() * sizeof(Slot) + boundary.capacity() * sizeof(Boundary) +
         (first.capacity() + first_link.capacity()) * sizeof(std::uint32_t);
}

Clusters find_clusters(const Body& body, const LinkTable& table,
                       const std::vector<std::uint32_t>& bricks, const Joins& joins) {
  const BrickTopology& elements = body.elements;
  SlotForest forest(elements.brick_count());
  for (const std::uint32_t b : bricks) {
    for_each_link(body, table.links(), b, [&](int kind, Slot low, Slot high) {
      if (joins(kind, low, high)) forest.join(low, high);
    });
  }

  // A root comes before the other members of its cluster, as it is the smallest slot.
  ClusterNumbers numbers(elements.brick_count());
  std::vector<std::pair<std::uint32_t, Slot>> members;
  std::uint32_t count = 0;
  for (std::size_t b = 0; b < elements.brick_count(); ++b) {
    if (!forest.has_joined(b)) continue;
    for_each_active(elements.mask(b), [&](int offset) {
      const Slot slot = Slot(b * kBrickVoxels) + Slot(offset);
      if (!forest.is_joined(slot)) return;
      const Slot root = forest.root(slot);
      if (root == slot) numbers.set(slot, count++);
      numbers.set(slot, numbers[root]);
      members.push_back({numbers[slot], slot});
    });
  }
  Clusters clusters;
  group_by_cluster(members, count, clusters.members, clusters.first);

  std::vector<std::pair<std::uint32_t, Clusters::Boundary>> boundary;
  for (const auto& member : members) {
    const std::uint32_t cluster = member.first;
    const Slot slot = member.second;
    for_each_neighbour(body, table.links(), slot, [&](int kind, bool upwards, Slot other) {
      if (numbers[other] == cluster) return;
      const LinkValues& values = table.values(kind, body.classes[slot], body.classes[other]);
      const std::int32_t rest =
          rest_of_link(body, kind, table.coordinate(), upwards ? slot : other);
      boundary.push_back(
          {cluster,
           {slot, other, values, upwards ? rest : -rest, upwards, numbers[other] != kNone}});
    });
  }
  group_by_cluster(boundary, count, clusters.boundary, clusters.first_link);
  return clusters;
}

}  // namespace supple
