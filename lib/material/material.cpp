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

std::vector<NamedCurve> curves_of(const LimitTable& table) {
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

void validate_curve(const std::string& file, const LimitTable& table, const NamedCurve& named) {
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

void validate_range(const std::string& file, const std::string& name, double lo, double hi,
                    bool equal) {
  if (std::isfinite(lo) && std::isfinite(hi) && (equal ? lo <= hi : lo < hi)) return;
  throw InputError({file, name, "[" + number(lo) + ", " + number(hi) + "]",
                    equal ? "lower <= upper, finite" : "lower < upper, finite"});
}

/// The nearest of the places 0…steps over the table's domain.
int step_of(const LimitTable& table, int steps, double density) {
  const double inside =
      density > table.domain_lo ? std::min(density, table.domain_hi) : table.domain_lo;
  return int(std::round(steps * (inside - table.domain_lo) / (table.domain_hi - table.domain_lo)));
}

std::string label_name(std::int32_t label) {
  return "label." + std::to_string(label);
}

void validate_table(const std::string& file, const std::string& prefix, const LimitTable& table) {
  validate_range(file, prefix + "domain", table.domain_lo, table.domain_hi, false);
  for (NamedCurve& named : curves_of(table)) {
    named.name.insert(0, prefix);
    validate_curve(file, table, named);
  }
}

/// One line per key point that falls into the class of the one before.
void warn_of_shared_classes(const std::string& name,
                            const std::vector<std::pair<double, double>>& keys,
                            const MaterialClasses& classes, const MaterialClasses::Share& share,
                            std::vector<std::string>& lines) {
  const LimitTable& table = *share.table;
  for (std::size_t n = 1; n < keys.size(); ++n) {
    const int shared = classes.class_of(keys[n].first, share.label);
    if (shared != classes.class_of(keys[n - 1].first, share.label)) continue;
    lines.push_back(name + ": key points " + std::to_string(n) + " and " + std::to_string(n + 1) +
                    " (densities " + number(keys[n - 1].first) + " and " + number(keys[n].first) +
                    ") share class " + std::to_string(shared) + ", one class spans " +
                    number((table.domain_hi - table.domain_lo) / (share.count - 1)));
  }
}

/// Limits at one place of the table's domain, 0…1.
LinkLimits limits_at(const LimitTable& table, int axis, double position) {
  const double density = table.domain_lo + position * (table.domain_hi - table.domain_lo);
  const auto& own_max = table.max_length_axis[axis];
  const auto& own_min = table.min_length_axis[axis];
  const Curve& longest = own_max ? *own_max : table.max_length;
  const Curve& shortest = own_min ? *own_min : table.min_length;
  return {shortest(density), longest(density), table.shear1(density), table.shear2(density)};
}

}  // namespace

std::int32_t fixed_slack(double length) {
  const double units = std::floor(length * 65536.0 + 1e-6);
  return std::int32_t(std::clamp(units, 0.0, double(kUnlimitedSlack)));
}

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

bool LimitTable::is_constant() const {
  const std::vector<NamedCurve> curves = curves_of(*this);
  return std::all_of(curves.begin(), curves.end(), [](const NamedCurve& named) {
    const auto& keys = named.curve->keys;
    return std::all_of(keys.begin(), keys.end(),
                       [&](const auto& key) { return key.second == keys.front().second; });
  });
}

void MaterialTable::validate(const std::string& file) const {
  validate_table(file, "", *this);
  validate_range(file, "active", active_lo, active_hi, true);
  if (components < 0) {
    throw InputError({file, "components", std::to_string(components), "0 (all) or a count >= 1"});
  }
  for (const auto& [label, table] : labels) {
    const std::string name = label_name(label);
    if (label < 1 || label > kMaxLabel) {
      throw InputError({file, name, "a table", "labels 1 to " + std::to_string(kMaxLabel)});
    }
    validate_table(file, name + ".", table);
  }
  try {
    MaterialClasses classes(*this);
  } catch (const InputError& error) {
    Problem problem = error.problem();
    problem.file = file;
    throw InputError(problem);
  }
}

std::vector<std::string> MaterialTable::warnings() const {
  std::vector<std::string> lines;
  const MaterialClasses classes(*this);
  for (const MaterialClasses::Share& share : classes.shares()) {
    if (share.count == 1) continue;
    const std::string prefix = share.label == 0 ? "" : label_name(share.label) + ".";
    for (const NamedCurve& named : curves_of(*share.table)) {
      warn_of_shared_classes(prefix + named.name, named.curve->keys, classes, share, lines);
    }
  }
  return lines;
}

std::uint8_t MaterialTable::class_of(double density) const {
  return std::uint8_t(step_of(*this, kClassMax, density));
}

MaterialClasses::MaterialClasses(const MaterialTable& material)
    : m_combines_limits(material.combines_limits()) {
  m_shares.push_back({0, &material, 0, 0});
  for (const auto& [label, table] : material.labels) m_shares.push_back({label, &table, 0, 0});
  int single = 0, varying = 0;
  for (Share& share : m_shares) {
    // The common table alone keeps all classes, so that states and warnings stay what they are.
    const bool one_is_enough = !material.labels.empty() && share.table->is_constant();
    share.count = one_is_enough ? 1 : 0;
    ++(one_is_enough ? single : varying);
  }
  const int needed = single + 2 * varying;
  if (needed > kClassMax + 1) {
    throw InputError({"", "label",
                      std::to_string(material.labels.size()) + " tables that need " +
                          std::to_string(needed) + " classes",
                      "at most " + std::to_string(kClassMax + 1) +
                          ": one for the common table and each label, two where limits vary"});
  }
  int next = 0;
  for (Share& share : m_shares) {
    if (share.count == 0) share.count = (kClassMax + 1 - single) / varying;
    share.first = next;
    next += share.count;
  }
  m_of_label.assign(material.labels.empty() ? 1 : std::size_t(m_shares.back().label) + 1, 0);
  for (std::size_t n = 0; n < m_shares.size(); ++n) {
    m_of_label[std::size_t(m_shares[n].label)] = std::int16_t(n);
  }
}

std::uint8_t MaterialClasses::class_of(double density, std::int32_t label) const {
  const bool has_table = label >= 0 && std::size_t(label) < m_of_label.size();
  const Share& share = m_shares[has_table ? std::size_t(m_of_label[std::size_t(label)]) : 0];
  return std::uint8_t(share.first + step_of(*share.table, share.count - 1, density));
}

LinkLimits MaterialClasses::limits_at_end(int axis, int end) const {
  std::size_t n = m_shares.size() - 1;
  while (m_shares[n].first > end) --n;
  const Share& share = m_shares[n];
  const int last = std::max(1, share.count - 1);
  return limits_at(*share.table, axis, std::min(end - share.first, last) / double(last));
}

LinkLimits MaterialClasses::limits(int axis, int class_a, int class_b) const {
  if (!m_combines_limits) {
    return limits_at(*m_shares.front().table, axis, (class_a + class_b) / (2.0 * kClassMax));
  }
  const LinkLimits a = limits_at_end(axis, class_a);
  const LinkLimits b = limits_at_end(axis, class_b);
  return {(a.min_length + b.min_length) / 2, (a.max_length + b.max_length) / 2,
          (a.shear1 + b.shear1) / 2, (a.shear2 + b.shear2) / 2};
}

LinkLimits limits_of(const MaterialTable& table, int axis, int class_a, int class_b) {
  return MaterialClasses(table).limits(axis, class_a, class_b);
}

SlackTable::SlackTable(const MaterialTable& table, const Vec3d& spacing_mm)
    : m_stride(table.combines_limits() ? kClassMax + 1 : 1),
      m_row_size(std::size_t(kClassMax) * m_stride + kClassMax + 1),
      m_upper(9 * m_row_size),
      m_lower(9 * m_row_size) {
  // In density mode only the sum of the classes counts: class_a 0 and 255 reach all 511 entries.
  const int step = table.combines_limits() ? 1 : kClassMax;
  const MaterialClasses classes(table);
  for (int axis = 0; axis < 3; ++axis) {
    const int transverse[2] = {axis == 0 ? 1 : 0, axis == 2 ? 1 : 2};
    for (int a = 0; a <= kClassMax; a += step) {
      for (int b = 0; b <= kClassMax; ++b) {
        const LinkLimits limits = classes.limits(axis, a, b);
        const std::size_t entry = std::size_t(a) * m_stride + b;
        const auto set = [&](int coordinate, double upper, double lower) {
          const std::size_t row = std::size_t(3 * axis + coordinate) * m_row_size;
          m_upper[row + entry] = fixed_slack(upper);
          m_lower[row + entry] = fixed_slack(lower);
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
