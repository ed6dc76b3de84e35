#include "lib/material/material.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "volumes/base/error.h"

namespace supple {

namespace {

constexpr int kClassMax = 255;
constexpr const char* kAxisName = "ijk";

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.10g", value);
  return text;
}

/// A curve under the name that the user gave it.
struct NamedCurve {
  std::string name;
  const Curve* curve;
  double lo, hi;  // admissible values; lo is exclusive when `open`
  bool open;
  const char* expected;
};

std::vector<NamedCurve> curves_of(const MaterialTable& table) {
  const double infinity = HUGE_VAL;
  const auto longest = [&](std::string name, const Curve& curve) {
    return NamedCurve{std::move(name), &curve, 1, infinity, false, "max_length >= 1"};
  };
  const auto shortest = [&](std::string name, const Curve& curve) {
    return NamedCurve{std::move(name), &curve, 0, 1, true, "0 < min_length <= 1"};
  };
  std::vector<NamedCurve> curves{longest("max_length", table.max_length),
                                 shortest("min_length", table.min_length),
                                 {"shear1", &table.shear1, 0, infinity, false, "shear >= 0"},
                                 {"shear2", &table.shear2, 0, infinity, false, "shear >= 0"}};
  for (int axis = 0; axis < 3; ++axis) {
    if (const auto& curve = table.max_length_axis[axis]) {
      curves.push_back(longest(std::string("max_length_") + kAxisName[axis], *curve));
    }
    if (const auto& curve = table.min_length_axis[axis]) {
      curves.push_back(shortest(std::string("min_length_") + kAxisName[axis], *curve));
    }
  }
  return curves;
}

void validate_curve(const std::string& file, const MaterialTable& table, const NamedCurve& named) {
  const auto& keys = named.curve->keys;
  if (keys.empty()) {
    throw InputError({file, named.name, "no key points", "at least one [density, value]"});
  }
  for (std::size_t n = 0; n < keys.size(); ++n) {
    const auto [density, value] = keys[n];
    const auto fail = [&](const std::string& expected) {
      throw InputError({file, named.name + " key point " + std::to_string(n + 1),
                        "[" + number(density) + ", " + number(value) + "]", expected});
    };
    if (!std::isfinite(density) || !std::isfinite(value)) fail("finite numbers");
    if (density < table.domain_lo || density > table.domain_hi) {
      fail("a density inside the domain [" + number(table.domain_lo) + ", " +
           number(table.domain_hi) + "]");
    }
    if (n > 0 && density <= keys[n - 1].first) {
      fail("a density above " + number(keys[n - 1].first) + " of the key point before");
    }
    if (value < named.lo || value > named.hi || (named.open && value == named.lo)) {
      fail(named.expected);
    }
  }
}

void validate_range(const std::string& file, const char* name, double lo, double hi, bool equal) {
  if (std::isfinite(lo) && std::isfinite(hi) && (equal ? lo <= hi : lo < hi)) return;
  throw InputError({file, name, "[" + number(lo) + ", " + number(hi) + "]",
                    equal ? "lower <= upper, finite" : "lower < upper, finite"});
}

/// Limits at one density of the table's domain, position 0…510 in half classes.
LinkLimits limits_at(const MaterialTable& table, int axis, int half_classes) {
  const double density =
      table.domain_lo + half_classes / 510.0 * (table.domain_hi - table.domain_lo);
  const auto& own_max = table.max_length_axis[axis];
  const auto& own_min = table.min_length_axis[axis];
  const Curve& longest = own_max ? *own_max : table.max_length;
  const Curve& shortest = own_min ? *own_min : table.min_length;
  return {shortest(density), longest(density), table.shear1(density), table.shear2(density)};
}

/// Voxels to 2^-16 voxel, rounded down. A value within 1e-6 of the next unit counts as that unit,
/// so that 1.25 interpolated as 1.2499999999999998 gives the slack of 1.25 on every machine.
std::int32_t floor_fixed(double voxels) {
  const double units = std::floor(voxels * 65536.0 + 1e-6);
  return std::int32_t(std::clamp(units, 0.0, double(kUnlimitedSlack)));
}

}  // namespace

double Curve::operator()(double density) const {
  if (density <= keys.front().first) return keys.front().second;
  if (density >= keys.back().first) return keys.back().second;
  const auto above = std::upper_bound(
      keys.begin(), keys.end(), density,
      [](double value, const std::pair<double, double>& key) { return value < key.first; });
  const auto& [d0, v0] = *(above - 1);
  const auto& [d1, v1] = *above;
  return v0 + (v1 - v0) * ((density - d0) / (d1 - d0));
}

void MaterialTable::validate(const std::string& file) const {
  validate_range(file, "domain", domain_lo, domain_hi, false);
  validate_range(file, "active", active_lo, active_hi, true);
  if (components < 0) {
    throw InputError({file, "components", std::to_string(components), "0 (all) or a count >= 1"});
  }
  for (const NamedCurve& named : curves_of(*this)) validate_curve(file, *this, named);
}

std::vector<std::string> MaterialTable::warnings() const {
  std::vector<std::string> lines;
  for (const NamedCurve& named : curves_of(*this)) {
    const auto& keys = named.curve->keys;
    for (std::size_t n = 1; n < keys.size(); ++n) {
      const int shared = class_of(keys[n].first);
      if (shared != class_of(keys[n - 1].first)) continue;
      lines.push_back(named.name + ": key points " + std::to_string(n) + " and " +
                      std::to_string(n + 1) + " (densities " + number(keys[n - 1].first) + " and " +
                      number(keys[n].first) + ") share class " + std::to_string(shared) +
                      ", one class spans " + number((domain_hi - domain_lo) / kClassMax));
    }
  }
  return lines;
}

std::uint8_t MaterialTable::class_of(double density) const {
  const double inside = density > domain_lo ? std::min(density, domain_hi) : domain_lo;
  return std::uint8_t(std::round(kClassMax * (inside - domain_lo) / (domain_hi - domain_lo)));
}

LinkLimits limits_of(const MaterialTable& table, int axis, int class_a, int class_b) {
  if (table.combine == Combine::density) return limits_at(table, axis, class_a + class_b);
  const LinkLimits a = limits_at(table, axis, 2 * class_a);
  const LinkLimits b = limits_at(table, axis, 2 * class_b);
  return {(a.min_length + b.min_length) / 2, (a.max_length + b.max_length) / 2,
          (a.shear1 + b.shear1) / 2, (a.shear2 + b.shear2) / 2};
}

SlackTable::SlackTable(const MaterialTable& table, const Vec3d& spacing_mm)
    : m_stride(table.combine == Combine::density ? 1 : kClassMax + 1),
      m_row_size(std::size_t(kClassMax) * m_stride + kClassMax + 1),
      m_upper(9 * m_row_size),
      m_lower(9 * m_row_size) {
  // In density mode only the sum of the classes counts: class_a 0 and 255 reach all 511 entries.
  const int step = table.combine == Combine::density ? kClassMax : 1;
  for (int axis = 0; axis < 3; ++axis) {
    const int transverse[2] = {axis == 0 ? 1 : 0, axis == 2 ? 1 : 2};
    for (int a = 0; a <= kClassMax; a += step) {
      for (int b = 0; b <= kClassMax; ++b) {
        const LinkLimits limits = limits_of(table, axis, a, b);
        const std::size_t entry = std::size_t(a) * m_stride + b;
        const auto set = [&](int coordinate, double upper, double lower) {
          const std::size_t row = std::size_t(3 * axis + coordinate) * m_row_size;
          m_upper[row + entry] = floor_fixed(upper);
          m_lower[row + entry] = floor_fixed(lower);
        };
        set(axis, limits.max_length - 1, 1 - limits.min_length);
        for (int n = 0; n < 2; ++n) {
          const double shear = (n == 0 ? limits.shear1 : limits.shear2) * spacing_mm[axis] /
                               spacing_mm[transverse[n]];
          set(transverse[n], shear, shear);
        }
      }
    }
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
