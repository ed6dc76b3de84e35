#include "lib/chainmail/link_costs.h"

#include <algorithm>

namespace supple {

namespace {

constexpr std::size_t kByteEntries = 512;
constexpr Level kNoLinkInBytes = 0xffff;

std::vector<std::uint8_t> bytes_of(const std::vector<Level>& levels) {
  if (levels.size() > kByteEntries) return {};
  std::vector<std::uint8_t> bytes(2 * kByteEntries);
  for (std::size_t n = 0; n < levels.size(); ++n) {
    const Level level = levels[n] == kNoLink ? kNoLinkInBytes : levels[n];
    if (level > kNoLinkInBytes || (level == kNoLinkInBytes && levels[n] != kNoLink)) return {};
    bytes[n] = std::uint8_t(level);
    bytes[kByteEntries + n] = std::uint8_t(level >> 8);
  }
  return bytes;
}

CostRow costs_of(const std::int32_t* slacks, std::size_t count) {
  CostRow row;
  row.levels.resize(count);
  for (std::size_t n = 0; n < count; ++n) {
    row.levels[n] = slacks[n] >= kUnlimitedSlack ? kNoLink : Level(slacks[n]);
  }
  row.bytes = bytes_of(row.levels);
  row.is_uniform = std::all_of(row.levels.begin(), row.levels.end(),
                               [&](Level level) { return level == row.levels.front(); });
  return row;
}

}  // namespace

/// Raising the low end of a link lifts its high end once `lower` is used up, and the high end the
/// low one once `upper` is; lowering is mirrored.
LinkCosts::LinkCosts(const SlackTable& slacks, int coordinate, Direction direction)
    : m_stride(slacks.stride()), m_links(slacks.links()) {
  const std::size_t count = std::size_t(255) * std::size_t(m_stride) + 256;
  for (int axis = 0; axis < 3; ++axis) {
    for (const bool upward : {false, true}) {
      const bool uses_lower = upward == (direction == Direction::raise);
      m_rows[axis][upward] = costs_of(
          uses_lower ? slacks.lower_row(axis, coordinate) : slacks.upper_row(axis, coordinate),
          count);
    }
    m_symmetric[axis] = m_rows[axis][0] == m_rows[axis][1];
  }
  if (m_links == 6) return;
  m_diagonals.resize(kDirections);
  for (int d = 0; d < kDirections; ++d) {
    if (!is_diagonal(d) || !has_direction(m_links, d)) continue;
    // Raising the start of a link lifts its end once the fall is used up.
    const int falls = direction == Direction::raise ? d : opposite_direction(d);
    m_diagonals[std::size_t(d)] = costs_of(slacks.fall_row(falls, coordinate), count);
  }
  for (int d = 0; d < kDirections; ++d) {
    if (!has_direction(m_links, d)) continue;
    m_same_back[std::size_t(d)] = along(d) == along(opposite_direction(d));
  }
}

std::size_t LinkCosts::bytes() const {
  std::size_t total = 0;
  for (const auto& axis : m_rows) {
    for (const CostRow& row : axis) {
      total += row.levels.capacity() * sizeof(Level) + row.bytes.capacity();
    }
  }
  for (const CostRow& row : m_diagonals) {
    total += sizeof row + row.levels.capacity() * sizeof(Level) + row.bytes.capacity();
  }
  return total;
}

}  // namespace supple
