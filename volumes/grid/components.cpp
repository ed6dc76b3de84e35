// Face-connected components: pieces within bricks by flooding their masks, then union-find over the
// pieces that touch across the faces of bricks. Cost: about 12 bytes per brick, and 512 more for
// one that holds several pieces.
#include <algorithm>
#include <memory>
#include <numeric>

#include "volumes/base/parallel.h"
#include "volumes/grid/density_grid.h"

namespace supple {

namespace {

constexpr std::uint64_t kLowZ = 0x0101010101010101u;  // voxels of a layer, one x, with z = 0
constexpr std::uint64_t kHighZ = kLowZ << 7;
constexpr std::uint64_t kLowY = 0xff;

/// Disjoint sets; the smallest member is always the root, so that the numbering does not depend on
/// the order of the unions.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t size) : m_parent(size) {
    std::iota(m_parent.begin(), m_parent.end(), 0u);
  }
  std::uint32_t root(std::uint32_t member) {
    while (m_parent[member] != member) {
      m_parent[member] = m_parent[m_parent[member]];
      member = m_parent[member];
    }
    return member;
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

/// The voxels of a layer that are connected to `seeds` within `room`.
std::uint64_t flood_layer(std::uint64_t seeds, std::uint64_t room) {
  for (;;) {
    const std::uint64_t along_z = (seeds & ~kHighZ) << 1 | (seeds & ~kLowZ) >> 1;
    const std::uint64_t grown = (seeds | along_z | seeds << 8 | seeds >> 8) & room;
    if (grown == seeds) return seeds;
    seeds = grown;
  }
}

/// The piece of a non-empty mask that holds its first voxel.
BrickMask first_piece(const BrickMask& mask) {
  const int first =
      int(std::find_if(mask.begin(), mask.end(), [](auto w) { return w != 0; }) - mask.begin());
  BrickMask piece{}, before;
  piece[first] = mask[first] & (~mask[first] + 1);
  do {
    before = piece;
    for (int x = 0; x < kBrickDim; ++x) {
      if (x > 0) piece[x] |= piece[x - 1] & mask[x];
      piece[x] = flood_layer(piece[x], mask[x]);
    }
    for (int x = kBrickDim - 2; x >= 0; --x) {
      piece[x] = flood_layer(piece[x] | (piece[x + 1] & mask[x]), mask[x]);
    }
  } while (piece != before);
  return piece;
}

/// The face-connected pieces of every brick by itself, numbered in the order of their first voxels.
class Pieces {
 public:
  explicit Pieces(const BrickTopology& topology)
      : m_topology(topology),
        m_first(topology.brick_count() + 1, 0),
        m_labels(topology.brick_count()) {
    parallel_for(topology.brick_count(), [&](std::size_t b) { m_first[b + 1] = label(b); });
    std::partial_sum(m_first.begin(), m_first.end(), m_first.begin());
  }

  std::size_t count() const { return m_first.back(); }

  /// The piece of an active voxel.
  std::uint32_t at(std::size_t b, int offset) const {
    return m_first[b] + (is_single(b) ? 0u : m_labels[b][offset]);
  }

  /// True if the brick has only one piece, or none.
  bool is_single(std::size_t b) const { return m_labels[b] == nullptr; }

 private:
  /// Labels the voxels of a brick of several pieces; returns how many they are. There are at most
  /// 256, the half of a checkerboard.
  std::uint32_t label(std::size_t b) {
    BrickMask rest = m_topology.mask(b);
    std::uint32_t count = 0;
    while (mask_count(rest) > 0) {
      const BrickMask piece = first_piece(rest);
      for (int x = 0; x < kBrickDim; ++x) rest[x] &= ~piece[x];
      if (count == 0 && mask_count(rest) > 0) {
        m_labels[b] = std::make_unique<std::uint8_t[]>(kBrickVoxels);
      }
      if (count > 0) for_each_active(piece, [&](int n) { m_labels[b][n] = std::uint8_t(count); });
      ++count;
    }
    return count;
  }

  const BrickTopology& m_topology;
  std::vector<std::uint32_t> m_first;  // piece of each brick; in the end, of all of them
  std::vector<std::unique_ptr<std::uint8_t[]>> m_labels;  // null: the only piece
};

/// Voxels of the upper face along an axis that have an active voxel across it. Bits are those of
/// the two other axes, the last one fastest.
std::uint64_t contacts(const BrickMask& mask, const BrickMask& above, int axis) {
  if (axis == 0) return mask[kBrickDim - 1] & above[0];
  std::uint64_t bits = 0;
  for (int x = 0; x < kBrickDim; ++x) {
    const std::uint64_t row = axis == 1
                                  ? mask[x] >> 56 & above[x] & kLowY
                                  // The product moves the lowest bit of byte y to bit 56 + y.
                                  : (mask[x] >> 7 & above[x] & kLowZ) * 0x0102040810204080u >> 56;
    bits |= row << (kBrickDim * x);
  }
  return bits;
}

void unite_across(const BrickTopology& topology, const Pieces& pieces, std::size_t b, int axis,
                  DisjointSets& sets) {
  const std::int32_t above = topology.neighbour(b, 2 * axis + 1);
  if (above < 0) return;
  std::uint64_t bits = contacts(topology.mask(b), topology.mask(above), axis);
  // One contact tells all where both bricks are single pieces.
  if (pieces.is_single(b) && pieces.is_single(above)) bits &= ~bits + 1;
  for (; bits != 0; bits &= bits - 1) {
    const int bit = __builtin_ctzll(bits), u = bit >> 3, v = bit & 7;
    const Vec3i voxel = axis == 0 ? Vec3i(0, u, v) : axis == 1 ? Vec3i(u, 0, v) : Vec3i(u, v, 0);
    Vec3i below = voxel;
    below[axis] = kBrickDim - 1;
    sets.unite(pieces.at(b, brick_offset(below)), pieces.at(above, brick_offset(voxel)));
  }
}

/// Voxels of every piece.
std::vector<std::int64_t> piece_sizes(const BrickTopology& topology, const Pieces& pieces) {
  std::vector<std::int64_t> sizes(pieces.count(), 0);
  parallel_for(topology.brick_count(), [&](std::size_t b) {
    const BrickMask& mask = topology.mask(b);
    if (pieces.is_single(b))
      sizes[pieces.at(b, 0)] = mask_count(mask);
    else
      for_each_active(mask, [&](int offset) { ++sizes[pieces.at(b, offset)]; });
  });
  return sizes;
}

/// Tells for each piece if it belongs to one of the `count` largest sets.
std::vector<char> in_largest(DisjointSets& sets, std::vector<std::int64_t> sizes, int count) {
  std::vector<std::uint32_t> roots;
  for (std::uint32_t piece = 0; piece < sizes.size(); ++piece) {
    const std::uint32_t root = sets.root(piece);
    if (root == piece)
      roots.push_back(root);
    else
      sizes[root] += sizes[piece];
  }
  std::sort(roots.begin(), roots.end(), [&](std::uint32_t a, std::uint32_t b) {
    return sizes[a] != sizes[b] ? sizes[a] > sizes[b] : a < b;
  });
  if (roots.size() > std::size_t(count)) roots.resize(count);
  std::vector<char> kept(sizes.size(), 0);
  for (const std::uint32_t root : roots) kept[root] = 1;
  for (std::uint32_t piece = 0; piece < sizes.size(); ++piece) kept[piece] = kept[sets.root(piece)];
  return kept;
}

/// Unites what touches across the faces of bricks.
DisjointSets united(const BrickTopology& topology, const Pieces& pieces) {
  DisjointSets sets(pieces.count());
  for (std::size_t b = 0; b < topology.brick_count(); ++b) {
    for (int axis = 0; axis < 3; ++axis) unite_across(topology, pieces, b, axis, sets);
  }
  return sets;
}

BrickTopology kept_pieces(const BrickTopology& topology, const Pieces& pieces,
                          const std::vector<char>& kept) {
  std::vector<BrickMask> masks(topology.brick_count(), BrickMask{});
  parallel_for(topology.brick_count(), [&](std::size_t b) {
    const BrickMask& mask = topology.mask(b);
    if (pieces.is_single(b)) {
      if (kept[pieces.at(b, 0)]) masks[b] = mask;
      return;
    }
    for_each_active(mask, [&](int offset) {
      if (kept[pieces.at(b, offset)]) mask_set(masks[b], offset);
    });
  });
  return {topology.index().origins(), std::move(masks)};
}

}  // namespace

BrickTopology largest_components(const BrickTopology& topology, int count) {
  const Pieces pieces(topology);
  DisjointSets sets = united(topology, pieces);
  return kept_pieces(topology, pieces, in_largest(sets, piece_sizes(topology, pieces), count));
}

BrickTopology component_at(const BrickTopology& topology, const Vec3i& voxel) {
  if (!topology.is_active(voxel)) return {};
  const Pieces pieces(topology);
  DisjointSets sets = united(topology, pieces);
  const std::uint32_t wanted =
      sets.root(pieces.at(std::size_t(topology.find(voxel)), brick_offset(voxel)));
  std::vector<char> kept(pieces.count(), 0);
  for (std::uint32_t piece = 0; piece < kept.size(); ++piece) {
    kept[piece] = sets.root(piece) == wanted;
  }
  return kept_pieces(topology, pieces, kept);
}

}  // namespace supple
