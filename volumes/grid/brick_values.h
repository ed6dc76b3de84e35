// One integer per voxel of a BrickTopology, stored only for bricks that were touched; all others
// read 0. So a local change of a large body costs memory where it happens.
//
// Memory: 2 kB per stored brick and 8 bytes per brick of the topology. Bricks come from chunks of
// 64, so touching one is O(1) and its address holds until it is released or the values die.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "volumes/grid/brick_topology.h"

namespace supple {

/// What a brick that is not stored reads as.
alignas(64) inline constexpr std::int32_t kZeroBrick[kBrickVoxels] = {};

/// Threads may read together, and write stored bricks together: touch() of a stored brick changes
/// nothing else. touch() of an absent one, set() and release() need the object for themselves.
class BrickValues {
 public:
  /// No bricks at all: reads 0 everywhere, but cannot be written before resize().
  BrickValues() = default;
  /// Room for that many bricks, none of them stored.
  explicit BrickValues(std::size_t brick_count) : m_table(brick_count, nullptr) {}
  /// Copies the stored bricks.
  BrickValues(const BrickValues& other);
  /// Addresses of bricks stay valid; `other` is left without bricks.
  BrickValues(BrickValues&& other) noexcept { swap(other); }
  BrickValues& operator=(BrickValues other) noexcept {
    swap(other);
    return *this;
  }
  void swap(BrickValues& other) noexcept;

  /// True while no brick is stored.
  bool empty() const { return m_stored == 0; }
  std::size_t brick_count() const { return m_table.size(); }
  std::size_t stored_bricks() const { return m_stored; }

  /// The 512 values of a brick in brick order, 64-byte aligned; null where none are stored, also
  /// beyond brick_count().
  const std::int32_t* brick(std::size_t b) const {
    return b < m_table.size() ? m_table[b] : nullptr;
  }
  /// The same with zeros where none are stored.
  const std::int32_t* brick_or_zero(std::size_t b) const {
    const std::int32_t* values = brick(b);
    return values != nullptr ? values : kZeroBrick;
  }
  /// The value of slot 512 * brick + offset; 0 where none is stored.
  std::int32_t at(std::size_t slot) const {
    const std::int32_t* values = brick(slot / kBrickVoxels);
    return values != nullptr ? values[slot % kBrickVoxels] : 0;
  }

  /// The values of a brick below brick_count(), stored from now on; zeros when it was absent.
  std::int32_t* touch(std::size_t b) { return m_table[b] != nullptr ? m_table[b] : store(b); }
  void set(std::size_t slot, std::int32_t value) {
    touch(slot / kBrickVoxels)[slot % kBrickVoxels] = value;
  }
  /// The brick reads 0 again; its memory serves the next touch().
  void release(std::size_t b);

  /// Room for that many bricks; those beyond are released.
  void resize(std::size_t brick_count);
  /// Back to no bricks at all, and no memory.
  void clear() { BrickValues().swap(*this); }

  /// Memory held: the table, and chunks whether in use or free.
  std::size_t bytes() const;

  /// Equal where every voxel reads the same, stored or not.
  bool operator==(const BrickValues& other) const;
  bool operator!=(const BrickValues& other) const { return !(*this == other); }

 private:
  struct alignas(64) Brick {
    std::int32_t values[kBrickVoxels];
  };

  std::int32_t* store(std::size_t b);
  void add_chunk();

  std::vector<std::int32_t*> m_table;  // per brick; null: absent
  std::vector<std::unique_ptr<Brick[]>> m_chunks;
  std::vector<std::int32_t*> m_free;  // bricks of the chunks that nobody uses
  std::size_t m_stored = 0;
  std::size_t m_chunk_bricks = 0;  // in all chunks together
};

}  // namespace supple
