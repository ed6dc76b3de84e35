#include "lib/material/material.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "volumes/base/error.h"

namespace supple {

namespace {

constexpr const char* kAxisName = "ijk";

void validate_curve(const std::string& file, const LimitTable& table, const NamedCurve& named) {
  const auto& keys = named.curve->keys;
  if (keys.empty()) {
    throw InputError({file, named.name, "no key points", "at least one [density, value]"});
  }
  for (std::size_t n = 0; n < keys.size(); ++n) {
    const double density = keys[n].first, value = keys[n].second;
    const auto fail = [&](const std::string& expected) {
      throw InputError({file, named.name + " key point " + std::to_string(n + 1),
                        "[" + number_text(density, 10) + ", " + number_text(value, 10) + "]",
                        expected});
    };
    if (!std::isfinite(density) || !std::isfinite(value)) fail("finite numbers");
    if (density < table.domain_lo || density > table.domain_hi) {
      fail("a density inside the domain [" + number_text(table.domain_lo, 10) + ", " +
           number_text(table.domain_hi, 10) + "]");
    }
    if (n > 0 && density <= keys[n - 1].first) {
      fail("a density above " + number_text(keys[n - 1].first, 10) + " of the key point before");
    }
    if (value < named.lo || value > named.hi || (named.open && value == named.lo)) {
      fail(named.expected);
    }
  }
}

void validate_range(const std::string& file, const std::string& name, double lo, double hi,
                    bool equal) {
  if (std::isfinite(lo) && std::isfinite(hi) && (equal ? lo <= hi : lo < hi)) return;
  throw InputError({file, name, "[" + number_text(lo, 10) + ", " + number_text(hi, 10) + "]",
                    equal ? "lower <= upper, finite" : "lower < upper, finite"});
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

/// Adds a line per key point that falls into the class of the one before.
void warn_of_shared_classes(const std::string& name,
                            const std::vector<std::pair<double, double>>& keys,
                            const MaterialClasses& classes, const MaterialClasses::Share& share,
                            std::vector<std::string>& lines) {
  const LimitTable& table = *share.table;
  for (std::size_t n = 1; n < keys.size(); ++n) {
    const int shared = classes.class_of(keys[n].first, share.label);
    if (shared != classes.class_of(keys[n - 1].first, share.label)) continue;
    lines.push_back(name + ": key points " + std::to_string(n) + " and " + std::to_string(n + 1) +
                    " (densities " + number_text(keys[n - 1].first, 10) + " and " +
                    number_text(keys[n].first, 10) + ") share class " + std::to_string(shared) +
                    ", one class spans " +
                    number_text((table.domain_hi - table.domain_lo) / (share.count - 1), 10));
  }
}

/// Adds a line per table that leaves to a default what another table gives: a rigid label among
/// tissues would be the softest of them.
void warn_of_missing_column(const std::string& column, std::optional<Curve> LimitTable::*curve,
                            const std::string& value, const MaterialClasses& classes,
                            std::vector<std::string>& lines) {
  const auto& shares = classes.shares();
  const auto gives = [&](const MaterialClasses::Share& share) {
    return (share.table->*curve).has_value();
  };
  if (std::none_of(shares.begin(), shares.end(), gives)) return;
  for (const MaterialClasses::Share& share : shares) {
    if (gives(share)) continue;
    lines.push_back((share.label == 0 ? "common table" : label_name(share.label)) + ": no " +
                    column + " as other tables have, counts as " + value);
  }
}

}  // namespace

const std::array<PhysicalColumn, 5> kPhysicalColumns = {{
    {"stiffness", &LimitTable::stiffness, true, HUGE_VAL, "stiffness > 0 kPa"},
    {"poisson", &LimitTable::poisson, false, kLargestPoisson, "poisson from 0 to 0.4999"},
    {"density", &LimitTable::mass_density, true, HUGE_VAL, "density > 0 kg/m³"},
    {"damping", &LimitTable::rayleigh_beta_ms, false, HUGE_VAL, "damping >= 0 ms"},
    {"plastic", &LimitTable::yield_strain, true, HUGE_VAL, "plastic > 0"},
}};

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
  for (const PhysicalColumn& column : kPhysicalColumns) {
    if (const auto& curve = table.*column.curve) {
      curves.push_back(
          {column.name, &*curve, 0, column.largest, column.is_above_zero, column.expected});
    }
  }
  return curves;
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

bool MaterialTable::has(std::optional<Curve> LimitTable::*column) const {
  return (this->*column).has_value() ||
         std::any_of(labels.begin(), labels.end(),
                     [&](const auto& entry) { return (entry.second.*column).has_value(); });
}

void MaterialTable::validate(const std::string& file) const {
  validate_table(file, "", *this);
  validate_range(file, "active", active_lo, active_hi, true);
  if (components < 0) {
    throw InputError({file, "components", std::to_string(components), "0 (all) or a count >= 1"});
  }
  if (links != 6 && links != 18 && links != 26) {
    throw InputError({file, "links", std::to_string(links), "6, 18 or 26"});
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
  warn_of_missing_column("stiffness", &LimitTable::stiffness,
                         number_text(kDefaultStiffnessKpa, 10) + " kPa", classes, lines);
  warn_of_missing_column("density", &LimitTable::mass_density,
                         number_text(kDefaultMassDensity, 10) + " kg/m³", classes, lines);
  return lines;
}

}  // namespace supple
