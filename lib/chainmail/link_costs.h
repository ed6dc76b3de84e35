// Cost of one link, which a value loses when it travels through it, looked up from the classes of
// its ends: the slack of design.md section 3 for one coordinate and one direction of propagation.
//
// Values travel as levels, biased so that a missing link needs no branch:
//   raise:  level = q + 2^30      lower:  level = 2^30 - q      1 <= level < 2^31 as |q| < 2^30
//   level_j = max(level_j, level_i - cost)   unsigned subtraction, signed maximum
// A cost is below 2^30 or kNoLink = 2^31, which leaves a negative level that never wins.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lib/chainmail/direction.h"
#include "lib/material/material.h"

namespace supple {

using Level = std::uint32_t;

constexpr Level kLevelBias = Level(1) << 30;
constexpr Level kNoLink = Level(1) << 31;

inline Level level_of(std::int32_t q, Direction direction) {
  return direction == Direction::raise ? kLevelBias + Level(q) : kLevelBias - Level(q);
}

/// One row of costs: of all links along one axis, in one direction of travel.
struct CostRow {
  std::vector<Level> levels;  // by class_a * stride + class_b
  /// The same as 512 low and 512 high bytes, for table look-ups in vector registers: where there
  /// are no more entries and every cost is below 2^16 - 1, which stands for kNoLink.
  std::vector<std::uint8_t> bytes;
  bool is_uniform = false;  // every link costs the same, as where the limits are constant

  bool operator==(const CostRow& other) const { return levels == other.levels; }
};

/// Costs of one coordinate and direction; entry class_a * stride() + class_b of a row.
class LinkCosts {
 public:
  LinkCosts() = default;
  LinkCosts(const SlackTable& slacks, int coordinate, Direction direction);

  bool empty() const { return m_rows[0][0].levels.empty(); }
  int stride() const { return m_stride; }
  /// Cost of travelling along `axis` towards higher (`upward`) or lower voxels.
  const CostRow& row(int axis, bool upward) const { return m_rows[axis][upward]; }
  /// True where links cost the same both ways, as those across the coordinate's own axis.
  bool is_symmetric(int axis) const { return m_symmetric[axis]; }
  /// Links per voxel: 6, 18 or 26, as in SlackTable.
  int links() const { return m_links; }
  /// Cost of travelling in any direction that a link has.
  const CostRow& along(int direction) const {
    return is_diagonal(direction) ? m_diagonals[std::size_t(direction)]
                                  : m_rows[axis_of_direction(direction)][direction > kNoStep];
  }
  /// True where that costs the same both ways.
  bool is_symmetric_along(int direction) const { return m_same_back[std::size_t(direction)]; }
  std::size_t bytes() const;

 private:
  int m_stride = 1;
  std::array<std::array<CostRow, 2>, 3> m_rows;  // [axis][upward]
  std::array<bool, 3> m_symmetric{};
  int m_links = 6;
  std::vector<CostRow> m_diagonals;  // by direction; empty with 6 links
  std::array<bool, kDirections> m_same_back{};
};

}  // namespace supple
