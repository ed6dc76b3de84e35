// Which 8^3 brick lies where: a two-level table over the regions of 16^3 bricks that are occupied.
// Memory: 16 kB per occupied 128^3 region and 12 bytes per brick, never in proportion to the box.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
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

}  // namespace supple
