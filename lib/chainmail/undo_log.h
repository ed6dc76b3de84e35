// Keeps the offsets of every brick as they were before its first change: 2 kB per touched brick,
// nothing for one that was not stored. Untouched bricks cost nothing either: the index grows by
// pages of 1024 bricks.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "volumes/grid/brick_values.h"

namespace supple {

class UndoLog {
 public:
  /// To be called before a value of the brick changes, or the brick is stored.
  void before_change(std::size_t brick, const BrickValues& values) {
    if (entry_of(brick) == 0) record(brick, values);
  }

  /// Puts every value back, releases bricks that were not stored, and forgets all.
  void roll_back(BrickValues& values);

  /// Forgets all, O(touched bricks), and keeps memory for that many saved bricks.
  void clear(std::size_t kept_bricks = SIZE_MAX);

  std::size_t bytes() const;

  /// Bricks that were announced, in order of their first change.
  const std::vector<std::size_t>& bricks() const { return m_bricks; }
  /// The 512 old values of bricks()[n]; zeros when it was not stored.
  const std::int32_t* saved(std::size_t n) const {
    return m_copies[n] == kNotStored ? kZeroBrick : copy(m_copies[n]);
  }
  /// The 512 old values of a brick, or null when it was not touched.
  const std::int32_t* saved_of(std::size_t brick) const {
    const std::uint32_t entry = entry_of(brick);
    return entry == 0 ? nullptr : saved(entry - 1);
  }

 private:
  static constexpr std::size_t kPageBricks = 1024;
  static constexpr std::size_t kNotStored = SIZE_MAX;
  static constexpr std::size_t kChunkBricks = 16;
  using Page = std::array<std::uint32_t, kPageBricks>;
  using Chunk = std::array<std::int32_t, kChunkBricks * kBrickVoxels>;

  std::int32_t* copy(std::size_t n) const {
    return m_chunks[n / kChunkBricks]->data() + n % kChunkBricks * kBrickVoxels;
  }

  std::uint32_t entry_of(std::size_t brick) const {
    const std::size_t page = brick / kPageBricks;
    return page < m_pages.size() && m_pages[page] ? (*m_pages[page])[brick % kPageBricks] : 0;
  }

  void record(std::size_t brick, const BrickValues& values);

  std::vector<std::unique_ptr<Page>> m_pages;  // per brick: 1 + its index in m_bricks, or 0
  std::vector<std::size_t> m_bricks;
  std::vector<std::size_t> m_copies;  // which copy is that of bricks()[n]
  std::vector<std::unique_ptr<Chunk>> m_chunks;
  std::size_t m_copied = 0;
};

}  // namespace supple
