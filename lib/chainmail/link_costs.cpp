#include "lib/chainmail/link_costs.h"

namespace supple {

namespace {

std::vector<Level> costs_of(const std::int32_t* slacks, std::size_t count) {
  std::vector<Level> costs(count);
  for (std::size_t n = 0; n < count; ++n) {
    costs[n] = slacks[n] >= kUnlimitedSlack ? kNoLink : Level(slacks[n]);
  }
  return costs;
}

}  // namespace

/// Raising the low end of a link lifts its high end once `lower` is used up, and the high end the
/// low one once `upper` is; lowering is mirrored.
LinkCosts::LinkCosts(const SlackTable& slacks, int coordinate, Direction direction)
    : m_stride(slacks.stride()) {
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
}

std::size_t LinkCosts::bytes() const {
  std::size_t total = 0;
  for (const auto& axis : m_rows) {
    for (const auto& row : axis) total += row.capacity() * sizeof(Level);
  }
  return total;
}

}  // namespace supple
