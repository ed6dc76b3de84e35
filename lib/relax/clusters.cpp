#include "lib/relax/clusters.h"

#include <algorithm>
#include <utility>

#include "lib/relax/grouped.h"
#include "volumes/base/parallel.h"

namespace supple {

namespace {

/// Calls `visit(slot)` for every joined element of a brick, ascending.
template <class Visit>
void for_each_joined(const SlotForest& forest, const BrickTopology& elements, std::uint32_t brick,
                     Visit&& visit) {
  for_each_active(elements.mask(brick), [&](int offset) {
    const Slot slot = Slot(brick * kBrickVoxels) + Slot(offset);
    if (forest.is_joined(slot)) visit(slot);
  });
}

}  // namespace

std::size_t Clusters::bytes() const {
  return members.capacity() * sizeof(Slot) + boundary.capacity() * sizeof(Boundary) +
         (first.capacity() + first_link.capacity()) * sizeof(std::uint32_t);
}

GrowingClusters::GrowingClusters(const Body& body, const LinkTable& table, Joins joins)
    : m_body(body),
      m_table(table),
      m_joins(std::move(joins)),
      m_forest(body.elements.brick_count()),
      m_outer(body.elements.brick_count()) {}

void GrowingClusters::join(Slot a, Slot b) {
  for (const Slot slot : {a, b}) {
    if (m_forest.is_joined(slot)) continue;
    const std::uint32_t brick = slot / kBrickVoxels;
    if (!m_forest.has_joined(brick)) m_bricks.push_back(brick);
    mask_set(m_outer[brick], int(slot % kBrickVoxels));
    m_forest.set_root(slot, slot);
  }
  m_forest.join(a, b);
}

void GrowingClusters::add(const std::vector<std::uint32_t>& bricks) {
  for (const std::uint32_t b : bricks) {
    for_each_link(m_body, m_table.links(), b, [&](int kind, Slot low, Slot high) {
      if (m_joins(kind, low, high)) join(low, high);
    });
  }
}

/// Gives every joined element one more than the number of its cluster. Returns how many there are.
std::uint32_t GrowingClusters::number(BrickValues& numbers) {
  const BrickTopology& elements = m_body.elements;
  std::vector<std::vector<Slot>> roots_of(m_bricks.size());
  parallel_for(m_bricks.size(), Grain{4}, [&](std::size_t n) {
    for_each_joined(m_forest, elements, m_bricks[n], [&](Slot slot) {
      if (m_forest.is_root(slot)) roots_of[n].push_back(slot);
    });
  });
  std::vector<Slot> roots;
  for (std::size_t n = 0; n < m_bricks.size(); ++n) {
    numbers.touch(m_bricks[n]);
    for (const Slot root : roots_of[n]) {
      roots.push_back(root);
      numbers.set(root, std::int32_t(roots.size()));
    }
  }
  parallel_for(m_bricks.size(), Grain{4}, [&](std::size_t n) {
    for_each_joined(m_forest, elements, m_bricks[n], [&](Slot slot) {
      if (m_forest.is_root(slot)) return;
      numbers.touch(m_bricks[n])[slot % kBrickVoxels] = numbers.at(m_forest.root(slot));
    });
  });
  parallel_for(m_bricks.size(), Grain{4}, [&](std::size_t n) {
    for_each_joined(m_forest, elements, m_bricks[n], [&](Slot slot) {
      m_forest.set_root(slot, roots[std::size_t(numbers.at(slot)) - 1]);
    });
  });
  return std::uint32_t(roots.size());
}

/// Finds the links that lead out of the clusters of a brick's elements. An element without any is
/// left alone from now on, as clusters never part.
GrowingClusters::LinksOut GrowingClusters::links_out(std::uint32_t brick,
                                                     const BrickValues& numbers) {
  LinksOut links;
  BrickMask outer{};
  for_each_active(m_outer[brick], [&](int offset) {
    const Slot slot = Slot(brick * kBrickVoxels) + Slot(offset);
    const std::int32_t own = numbers.at(slot);
    const std::size_t before = links.size();
    for_each_neighbour(m_body, m_table.links(), slot, [&](int kind, bool upwards, Slot other) {
      const std::int32_t beside = numbers.at(other);
      if (beside == own) return;
      const LinkValues& values = m_table.values(kind, m_body.classes[slot], m_body.classes[other]);
      const std::int32_t rest =
          rest_of_link(m_body, kind, m_table.coordinate(), upwards ? slot : other);
      links.push_back({std::uint32_t(own - 1),
                       {slot, other, values, upwards ? rest : -rest, upwards, beside != 0}});
    });
    if (links.size() > before) mask_set(outer, offset);
  });
  m_outer[brick] = outer;
  return links;
}

Clusters GrowingClusters::find() {
  std::sort(m_bricks.begin(), m_bricks.end());
  BrickValues numbers(m_body.elements.brick_count());
  const std::uint32_t count = number(numbers);
  std::vector<ClusteredItems<Slot>> members(m_bricks.size());
  std::vector<LinksOut> boundary(m_bricks.size());
  parallel_for(m_bricks.size(), Grain{4}, [&](std::size_t n) {
    for_each_joined(m_forest, m_body.elements, m_bricks[n], [&](Slot slot) {
      members[n].push_back({std::uint32_t(numbers.at(slot) - 1), slot});
    });
    boundary[n] = links_out(m_bricks[n], numbers);
  });
  Clusters clusters;
  group_by_cluster(std::move(members), count, clusters.members, clusters.first);
  group_by_cluster(std::move(boundary), count, clusters.boundary, clusters.first_link);
  return clusters;
}

std::size_t GrowingClusters::bytes() const {
  return m_forest.bytes() + m_outer.capacity() * sizeof(BrickMask) +
         m_bricks.capacity() * sizeof(std::uint32_t);
}

Clusters find_clusters(const Body& body, const LinkTable& table,
                       const std::vector<std::uint32_t>& bricks, const Joins& joins) {
  GrowingClusters growing(body, table, joins);
  growing.add(bricks);
  return growing.find();
}

}  // namespace supple
