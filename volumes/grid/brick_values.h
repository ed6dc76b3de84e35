// One number or vector per voxel of a BrickTopology, stored only for bricks that were touched; all
// others read 0. So a local change of a large body costs memory where it happens.
//
// Memory: 512 numbers per stored brick and 8 bytes per brick of the topology. Bricks come from
// chunks of 64, so touching one is O(1) and its address holds until it is released or the values
// die.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "volumes/grid/brick_topology.h"

namespace supple {

/// Values of a brick that is not stored. Zeros of static memory, since a vector leaves its own
/// memory as it is.
template <class T>
alignas(64) inline const T kZeroBrickOf[kBrickVoxels] = {};
inline constexpr auto& kZeroBrick = kZeroBrickOf<std::int32_t>;

/// True if all 512 values of a brick are 0; at once where the brick is not stored.
template <class T>
bool are_zeros(const T* values) {
  return values == kZeroBrickOf<T> || std::equal(values, values + kBrickVoxels, kZeroBrickOf<T>);
}

/// Threads may read together, and write stored bricks together: touch() of a stored brick changes
/// nothing else. touch() of an absent one, set() and release() need the object for themselves.
template <class T>
class BrickArray {
 public:
  /// No bricks at all: reads 0 everywhere, but cannot be written before resize().
  BrickArray() = default;
  /// Room for that many bricks, none of them stored.
  explicit BrickArray(std::size_t brick_count) : m_table(brick_count, nullptr) {}
  /// Makes an array of all values, 512 per brick: stores the bricks that hold some other than 0.
  static BrickArray of(const std::vector<T>& values);
  /// Copies the stored bricks.
  BrickArray(const BrickArray& other);
  /// Addresses of bricks stay valid; `other` is left without bricks.
  BrickArray(BrickArray&& other) noexcept { swap(other); }
  BrickArray& operator=(BrickArray other) noexcept {
    swap(other);
    return *this;
  }
  void swap(BrickArray& other) noexcept;

  /// True while no brick is stored.
  bool empty() const { return m_stored == 0; }
  std::size_t brick_count() const { return m_table.size(); }
  std::size_t stored_bricks() const { return m_stored; }

  /// The 512 values of a brick in brick order, 64-byte aligned; null where none are stored, also
  /// beyond brick_count().
  const T* brick(std::size_t b) const { return b < m_table.size() ? m_table[b] : nullptr; }
  /// The same with zeros where none are stored.
  const T* brick_or_zero(std::size_t b) const {
    const T* values = brick(b);
    return values != nullptr ? values : kZeroBrickOf<T>;
  }
  /// The value of slot 512 * brick + offset; 0 where none is stored.
  T at(std::size_t slot) const {
    const T* values = brick(slot / kBrickVoxels);
    return values != nullptr ? values[slot % kBrickVoxels] : T(0);
  }
  /// All values, 512 per brick.
  std::vector<T> all() const;

  /// The values of a brick below brick_count(), stored from now on; zeros when it was absent.
  T* touch(std::size_t b) { return m_table[b] != nullptr ? m_table[b] : store(b); }
  void set(std::size_t slot, T value) { touch(slot / kBrickVoxels)[slot % kBrickVoxels] = value; }
  /// The brick reads 0 again; its memory serves the next touch().
  void release(std::size_t b);

  /// Memory for so many bricks more than are stored, at once and in large pages.
  void reserve(std::size_t more);
  /// Every brick is stored from now on.
  void touch_all();
  /// The bricks are numbered anew: brick n is what `kept[n]` was, ascending; all others are
  /// released.
  void keep_only(const std::vector<std::size_t>& kept);

  /// The bricks are numbered anew: brick n becomes `places[n]`, each once, of so many.
  void place_at(const std::vector<std::size_t>& places, std::size_t brick_count);

  /// Room for that many bricks; those beyond are released.
  void resize(std::size_t brick_count);
  /// Goes back to no bricks at all, and no memory.
  void clear() { BrickArray().swap(*this); }

  /// Memory held: the table, and chunks whether in use or free.
  std::size_t bytes() const;

  /// Equal where every voxel reads the same, stored or not.
  bool operator==(const BrickArray& other) const;
  bool operator!=(const BrickArray& other) const { return !(*this == other); }

 private:
  struct alignas(64) Brick {
    T values[kBrickVoxels];
  };

  T* store(std::size_t b);
  void add_chunk(std::size_t bricks);

  std::vector<T*> m_table;  // per brick; null: absent
  std::vector<std::unique_ptr<Brick[]>> m_chunks;
  std::vector<T*> m_free;  // bricks of the chunks that nobody uses
  std::size_t m_stored = 0;
  std::size_t m_chunk_bricks = 0;  // in all chunks together
};

/// Calls `visit(value)` for every value of the stored bricks.
template <class T, class Visit>
void for_each_stored(BrickArray<T>& values, Visit&& visit) {
  for (std::size_t b = 0; b < values.brick_count(); ++b) {
    if (values.brick(b) == nullptr) continue;
    T* const brick = values.touch(b);
    for (int n = 0; n < kBrickVoxels; ++n) visit(brick[n]);
  }
}

extern template class BrickArray<std::int16_t>;
extern template class BrickArray<std::int32_t>;
extern template class BrickArray<double>;
extern template class BrickArray<Vec3f>;

/// Offsets from rest in 2^-16 voxel, labels.
using BrickValues = BrickArray<std::int32_t>;
/// Displacements, offsets.
using BrickVectors = BrickArray<Vec3f>;

}  // namespace supple
