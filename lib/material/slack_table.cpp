#include <algorithm>
#include <cmath>

#include "lib/material/material.h"

namespace supple {

std::int32_t fixed_slack(double length) {
  const double units = std::floor(length * 65536.0 + 1e-6);
  return std::int32_t(std::clamp(units, 0.0, double(kUnlimitedSlack)));
}

namespace {

/// floor(sqrt(square)), kUnlimitedSlack at most; square < 2^62.
std::int32_t root_below(std::uint64_t square) {
  auto root = std::uint64_t(std::sqrt(double(square)));
  while (root * root > square) --root;
  while ((root + 1) * (root + 1) <= square) ++root;
  return std::int32_t(std::min<std::uint64_t>(root, kUnlimitedSlack));
}

}  // namespace

SlackTable::SlackTable(const MaterialTable& table, const Vec3d& spacing_mm)
    : m_stride(table.combines_limits() ? kLastClass + 1 : 1),
      m_row_size(std::size_t(kLastClass) * m_stride + kLastClass + 1),
      m_upper(9 * m_row_size),
      m_lower(9 * m_row_size),
      m_links(table.links) {
  const MaterialClasses classes(table);
  for (int axis = 0; axis < 3; ++axis) {
    const int transverse[2] = {axis == 0 ? 1 : 0, axis == 2 ? 1 : 2};
    classes.for_each_pair(axis, [&](int a, int b, const LinkLimits& limits) {
      const std::size_t entry = std::size_t(a) * m_stride + b;
      const auto set = [&](int coordinate, double upper, double lower) {
        const std::size_t row = std::size_t(3 * axis + coordinate) * m_row_size;
        m_upper[row + entry] = fixed_slack(upper);
        m_lower[row + entry] = fixed_slack(lower);
      };
      set(axis, limits.max_length - 1, 1 - limits.min_length);
      for (int n = 0; n < 2; ++n) {
        const double shear =
            (n == 0 ? limits.shear1 : limits.shear2) * spacing_mm[axis] / spacing_mm[transverse[n]];
        set(transverse[n], shear, shear);
      }
    });
  }
  add_diagonals();
}

void SlackTable::add_diagonals() {
  int count = 0;
  for (int direction = 0; direction < kDirections; ++direction) {
    if (!is_diagonal(direction) || !has_direction(m_links, direction)) continue;
    m_diagonal_of[std::size_t(direction)] = std::int8_t(count++);
  }
  m_diagonals.resize(3 * std::size_t(count) * m_row_size);
  for (int direction = 0; direction < kDirections; ++direction) {
    if (!is_diagonal(direction) || !has_direction(m_links, direction)) continue;
    const LinkStep step = step_of_direction(direction);
    for (int c = 0; c < 3; ++c) {
      std::int32_t* const out =
          m_diagonals.data() +
          std::size_t(3 * m_diagonal_of[std::size_t(direction)] + c) * m_row_size;
      for (std::size_t entry = 0; entry < m_row_size; ++entry) {
        std::uint64_t square = 0;
        bool unlimited = false;
        for (int axis = 0; axis < 3; ++axis) {
          const int way = step[std::size_t(axis)];
          if (way == 0) continue;
          const std::int32_t slack = (way > 0 ? lower_row(axis, c) : upper_row(axis, c))[entry];
          unlimited |= slack >= kUnlimitedSlack;
          square += std::uint64_t(slack) * std::uint64_t(slack);
        }
        out[entry] = unlimited ? kUnlimitedSlack : root_below(square);
      }
    }
  }
}

const std::int32_t* SlackTable::fall_row(int direction, int coordinate) const {
  if (is_diagonal(direction)) {
    return m_diagonals.data() +
           std::size_t(3 * m_diagonal_of[std::size_t(direction)] + coordinate) * m_row_size;
  }
  const int axis = axis_of_direction(direction);
  return direction > kNoStep ? lower_row(axis, coordinate) : upper_row(axis, coordinate);
}

LinkSlack SlackTable::slack(int axis, std::uint8_t class_a, std::uint8_t class_b) const {
  LinkSlack slack;
  for (int c = 0; c < 3; ++c) {
    slack.upper[c] = upper(axis, c, class_a, class_b);
    slack.lower[c] = lower(axis, c, class_a, class_b);
  }
  return slack;
}

std::size_t SlackTable::bytes() const {
  return (m_upper.capacity() + m_lower.capacity() + m_diagonals.capacity()) * sizeof(std::int32_t);
}

}  // namespace supple
