#include <algorithm>
#include <cmath>

#include "lib/material/material.h"

namespace supple {

std::int32_t fixed_slack(double length) {
  const double units = std::floor(length * 65536.0 + 1e-6);
  return std::int32_t(std::clamp(units, 0.0, double(kUnlimitedSlack)));
}

SlackTable::SlackTable(const MaterialTable& table, const Vec3d& spacing_mm)
    : m_stride(table.combines_limits() ? kLastClass + 1 : 1),
      m_row_size(std::size_t(kLastClass) * m_stride + kLastClass + 1),
      m_upper(9 * m_row_size),
      m_lower(9 * m_row_size) {
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
  return (m_upper.capacity() + m_lower.capacity()) * sizeof(std::int32_t);
}

}  // namespace supple
