// Keeps the offsets of every brick as they were before its first change: 2 kB per touched brick,
// 4 bytes per brick of the body.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "volumes/grid/brick_topology.h"

namespace supple {

class UndoLog {
 public:
  explicit UndoLog(std::size_t brick_count) : m_entry(brick_count, -1) {}

  /// To be called before a value of the brick changes.
  void before_change(std::size_t brick, const std::vector<std::int32_t>& values) {
    if (m_entry[brick] >= 0) return;
    const auto first = values.begin() + std::ptrdiff_t(brick * kBrickVoxels);
    m_saved.insert(m_saved.end(), first, first + kBrickVoxels);
    m_bricks.push_back(brick);
    m_entry[brick] = std::int32_t(m_bricks.size() - 1);
  }

  /// Puts every value back and forgets all.
  void roll_back(std::vector<std::int32_t>& values) {
    for (std::size_t n = 0; n < m_bricks.size(); ++n) {
      std::copy_n(saved(n), kBrickVoxels,
                  values.begin() + std::ptrdiff_t(m_bricks[n] * kBrickVoxels));
      m_entry[m_bricks[n]] = -1;
    }
    m_bricks.clear();
    m_saved.clear();
  }

  /// Bricks that were announced, in order of their first change.
  const std::vector<std::size_t>& bricks() const { return m_bricks; }
  /// The 512 old values of bricks()[n].
  const std::int32_t* saved(std::size_t n) const { return m_saved.data() + n * kBrickVoxels; }
  /// The 512 old values of a brick, or null when it was not touched.
  const std::int32_t* saved_of(std::size_t brick) const {
    return m_entry[brick] < 0 ? nullptr : saved(std::size_t(m_entry[brick]));
  }

 private:
  std::vector<std::int32_t> m_entry;  // per brick, index into m_bricks or -1
  std::vector<std::size_t> m_bricks;
  std::vector<std::int32_t> m_saved;
};

}  // namespace supple
