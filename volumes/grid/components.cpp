// Face-connected components by union-find over the active voxels.
#include <algorithm>
#include <numeric>

#include "volumes/grid/density_grid.h"

namespace supple {

namespace {

/// Disjoint sets over voxel slots; the smaller slot is always the root, so that the numbering does
/// not depend on the order of the unions.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t size) : m_parent(size) {
    std::iota(m_parent.begin(), m_parent.end(), 0u);
  }
  std::uint32_t root(std::uint32_t slot) {
    while (m_parent[slot] != slot) {
      m_parent[slot] = m_parent[m_parent[slot]];
      slot = m_parent[slot];
    }
    return slot;
  }
  void unite(std::uint32_t a, std::uint32_t b) {
    a = root(a);
    b = root(b);
    if (a < b) m_parent[b] = a;
    if (b < a) m_parent[a] = b;
  }

 private:
  std::vector<std::uint32_t> m_parent;
};

void unite_neighbours(const BrickTopology& topology, DisjointSets& sets) {
  constexpr int kStride[3] = {64, 8, 1};
  for (std::size_t b = 0; b < topology.brick_count(); ++b) {
    for_each_active(topology.mask(b), [&](int offset) {
      const Vec3i local = brick_local(offset);
      for (int axis = 0; axis < 3; ++axis) {
        const bool inside = local[axis] < kBrickDim - 1;
        const std::int32_t other = inside ? std::int32_t(b) : topology.neighbour(b, 2 * axis + 1);
        const int other_offset = offset + (inside ? kStride[axis] : -7 * kStride[axis]);
        if (other < 0 || !mask_test(topology.mask(other), other_offset)) continue;
        sets.unite(std::uint32_t(b * kBrickVoxels + offset),
                   std::uint32_t(std::size_t(other) * kBrickVoxels + other_offset));
      }
    });
  }
}

}  // namespace

BrickTopology largest_components(const BrickTopology& topology, int count) {
  const std::size_t slots = topology.brick_count() * kBrickVoxels;
  DisjointSets sets(slots);
  unite_neighbours(topology, sets);

  // Sizes by root, then the roots to keep.
  std::vector<std::uint32_t> size(slots, 0);
  std::vector<std::uint32_t> roots;
  for (std::size_t b = 0; b < topology.brick_count(); ++b) {
    for_each_active(topology.mask(b), [&](int offset) {
      const std::uint32_t root = sets.root(std::uint32_t(b * kBrickVoxels + offset));
      if (size[root]++ == 0) roots.push_back(root);
    });
  }
  std::sort(roots.begin(), roots.end(), [&](std::uint32_t a, std::uint32_t b) {
    return size[a] != size[b] ? size[a] > size[b] : a < b;
  });
  if (roots.size() > std::size_t(count)) roots.resize(count);
  std::vector<bool> kept(slots, false);
  for (const std::uint32_t root : roots) kept[root] = true;

  std::vector<Vec3i> origins;
  std::vector<BrickMask> masks;
  for (std::size_t b = 0; b < topology.brick_count(); ++b) {
    BrickMask mask{};
    for_each_active(topology.mask(b), [&](int offset) {
      if (kept[sets.root(std::uint32_t(b * kBrickVoxels + offset))]) mask_set(mask, offset);
    });
    origins.push_back(topology.origin(b));
    masks.push_back(mask);
  }
  return {std::move(origins), std::move(masks)};
}

}  // namespace supple
