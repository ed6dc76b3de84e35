// The set of active voxels as 8^3 bricks, mirrored from the leaves of an OpenVDB tree, so that
// solvers and marchers need not include OpenVDB. Memory: 100 bytes per brick plus a two-level
// look-up table that grows with occupied 128^3 regions (16 kB each), never with the box.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "volumes/base/vec.h"

namespace supple {

constexpr int kBrickDim = 8;

/// The tables as flat arrays: regions of 16^3 bricks, x slowest, each -1 (no brick) or the number
/// of a table of 4096 brick numbers (x slowest), -1 where there is none.
struct BrickLookup {
  Vec3i region_lo{0, 0, 0};    // in units of 128 voxels
  Vec3i region_dims{0, 0, 0};  // 0: no bricks
  const std::int32_t* regions = nullptr;
  const std::int32_t* tables = nullptr;
};

/// Bricks, numbered as they come. Voxel coordinates may be negative.
class BrickIndex {
 public:
  static constexpr int kTableSize = 4096;

  BrickIndex() = default;
  /// `origins` are multiples of 8 and unique; they are numbered in this order.
  explicit BrickIndex(std::vector<Vec3i> origins);

  std::size_t count() const { return m_origins.size(); }
  bool empty() const { return m_origins.empty(); }
  /// Smallest voxel of brick b.
  const Vec3i& origin(std::size_t b) const { return m_origins[b]; }
  const std::vector<Vec3i>& origins() const { return m_origins; }

  /// Brick that holds the voxel, or -1.
  std::int32_t find(const Vec3i& voxel) const;
  /// The brick with this origin, a new one if there is none.
  std::size_t add(const Vec3i& origin);

  /// find() for callers that look up many voxels at once; valid until a brick is added.
  BrickLookup lookup() const;
  /// Index in lookup().tables of the number of brick b.
  std::size_t place(std::size_t b) const;
  /// Length of lookup().tables.
  std::size_t place_count() const { return m_tables.size() * kTableSize; }

  std::size_t bytes() const;

 private:
  std::size_t region_at(const Vec3i& voxel) const;
  void span_regions(const Vec3i& lo, const Vec3i& hi);
  void enter(std::size_t b);

  std::vector<Vec3i> m_origins;
  Vec3i m_region_lo{0, 0, 0};
  Vec3i m_region_dims{0, 0, 0};
  std::vector<std::int32_t> m_regions;
  std::vector<std::array<std::int32_t, kTableSize>> m_tables;
};

constexpr int kBrickVoxels = 512;

/// Bit n stands for the voxel with offset n in its brick.
using BrickMask = std::array<std::uint64_t, 8>;

/// Offset of a voxel in its brick, k fastest, as in an OpenVDB leaf: (i&7)<<6 | (j&7)<<3 | (k&7).
inline int brick_offset(const Vec3i& voxel) {
  return ((voxel.x & 7) << 6) | ((voxel.y & 7) << 3) | (voxel.z & 7);
}

/// Local coordinates of an offset in its brick.
inline Vec3i brick_local(int offset) {
  return {offset >> 6, (offset >> 3) & 7, offset & 7};
}

inline bool mask_test(const BrickMask& mask, int offset) {
  return (mask[offset >> 6] >> (offset & 63)) & 1;
}
inline void mask_set(BrickMask& mask, int offset) {
  mask[offset >> 6] |= std::uint64_t(1) << (offset & 63);
}
int mask_count(const BrickMask& mask);
/// Smallest box of the set bits, in local coordinates; empty when there are none.
IndexBox mask_bounds(const BrickMask& mask);
/// The smallest box around both.
IndexBox join(const IndexBox& a, const IndexBox& b);

/// Immutable list of bricks in ascending (x, y, z) order of their origins (x slowest), with
/// active-voxel masks and face neighbours. Voxel coordinates may be negative. Copies share it.
class BrickTopology {
 public:
  BrickTopology() noexcept : m_bricks(none()) {}
  BrickTopology(const BrickTopology&) = default;
  BrickTopology& operator=(const BrickTopology&) = default;
  /// Leaves `other` empty.
  BrickTopology(BrickTopology&& other) noexcept : m_bricks(std::exchange(other.m_bricks, none())) {}
  BrickTopology& operator=(BrickTopology&& other) noexcept {
    m_bricks = std::exchange(other.m_bricks, none());
    return *this;
  }

  /// `origins` are multiples of 8 and unique; bricks are sorted, `masks` follow. Bricks with an
  /// empty mask are dropped.
  BrickTopology(std::vector<Vec3i> origins, std::vector<BrickMask> masks);

  std::size_t brick_count() const { return m_bricks->index.count(); }
  bool empty() const { return m_bricks->index.empty(); }
  /// Smallest voxel of brick b.
  const Vec3i& origin(std::size_t b) const { return m_bricks->index.origin(b); }
  const BrickMask& mask(std::size_t b) const { return m_bricks->masks[b]; }

  /// Brick that holds the voxel, or -1.
  std::int32_t find(const Vec3i& voxel) const { return m_bricks->index.find(voxel); }
  bool is_active(const Vec3i& voxel) const {
    const std::int32_t b = find(voxel);
    return b >= 0 && mask_test(mask(std::size_t(b)), brick_offset(voxel));
  }
  /// The bricks without their masks.
  const BrickIndex& index() const { return m_bricks->index; }
  /// Brick across a face, or -1. Faces: 0 -x, 1 +x, 2 -y, 3 +y, 4 -z, 5 +z.
  std::int32_t neighbour(std::size_t b, int face) const { return m_bricks->neighbours[b][face]; }

  std::int64_t active_count() const { return m_bricks->active_count; }
  /// Smallest box of the active voxels; empty when there are none.
  const IndexBox& active_bounds() const { return m_bricks->active_bounds; }
  /// Memory of this list, however many copies share it.
  std::size_t bytes() const;

  bool operator==(const BrickTopology& other) const {
    return m_bricks == other.m_bricks || (index().origins() == other.index().origins() &&
                                          m_bricks->masks == other.m_bricks->masks);
  }

 private:
  struct Bricks {
    BrickIndex index;
    std::vector<BrickMask> masks;
    std::vector<std::array<std::int32_t, 6>> neighbours;
    std::int64_t active_count = 0;
    IndexBox active_bounds;
  };
  static const std::shared_ptr<const Bricks>& none();

  std::shared_ptr<const Bricks> m_bricks;
};

/// Calls `visit(offset)` for every set bit, ascending.
template <class Visit>
void for_each_active(const BrickMask& mask, Visit&& visit) {
  for (int word = 0; word < 8; ++word) {
    for (std::uint64_t bits = mask[word]; bits != 0; bits &= bits - 1) {
      visit(word * 64 + __builtin_ctzll(bits));
    }
  }
}

/// Calls `visit(voxel)` for every active voxel, in brick order.
template <class Visit>
void for_each_voxel(const BrickTopology& topology, Visit&& visit) {
  for (std::size_t b = 0; b < topology.brick_count(); ++b) {
    for_each_active(topology.mask(b),
                    [&](int offset) { visit(topology.origin(b) + brick_local(offset)); });
  }
}

/// All voxels within Chebyshev distance `rings` of an active voxel (26-neighbourhood dilation).
BrickTopology dilate(const BrickTopology& topology, int rings);

/// The same, but new voxels lie inside the box of voxels 0 … dims - 1.
BrickTopology dilate_inside(const BrickTopology& topology, int rings, const Vec3i& dims);

/// True when a trilinear reading at the position would see an active voxel.
bool touches(const BrickTopology& topology, const Vec3d& pos);

/// Part 0 is the brick. Bit 4, 2 and 1 of a part say that only its lowest voxels along x, y and z
/// count.
struct BrickExtremes {
  static constexpr std::size_t kParts = 8;

  std::array<float, kParts> lo, hi;  // lo > hi: none
  bool integers = true;              // of all densities
};

/// Extremes of the finite densities of the voxels that are active in the mask.
/// @param values 512 densities in brick order.
BrickExtremes find_extremes(const float* values, const BrickMask& mask);

}  // namespace supple
