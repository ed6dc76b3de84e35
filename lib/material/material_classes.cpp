#include <algorithm>
#include <cmath>

#include "lib/material/material.h"
#include "volumes/base/error.h"

namespace supple {

namespace {

/// The nearest of the places 0…steps over the table's domain.
int step_of(const LimitTable& table, int steps, double density) {
  const double inside =
      density > table.domain_lo ? std::min(density, table.domain_hi) : table.domain_lo;
  return int(std::round(steps * (inside - table.domain_lo) / (table.domain_hi - table.domain_lo)));
}

/// The density at one place of the table's domain, 0…1.
double density_at(const LimitTable& table, double position) {
  return table.domain_lo + position * (table.domain_hi - table.domain_lo);
}

LinkLimits limits_at(const LimitTable& table, int axis, double position) {
  const double density = density_at(table, position);
  const auto& own_max = table.max_length_axis[axis];
  const auto& own_min = table.min_length_axis[axis];
  const Curve& longest = own_max ? *own_max : table.max_length;
  const Curve& shortest = own_min ? *own_min : table.min_length;
  return {shortest(density), longest(density), table.shear1(density), table.shear2(density)};
}

LinkPhysics physics_at(const LimitTable& table, double position) {
  const double density = density_at(table, position);
  return {table.stiffness ? (*table.stiffness)(density) : kDefaultStiffnessKpa,
          table.rayleigh_beta_ms ? (*table.rayleigh_beta_ms)(density) : 0,
          table.yield_strain ? (*table.yield_strain)(density) : HUGE_VAL};
}

}  // namespace

std::uint8_t MaterialTable::class_of(double density) const {
  return std::uint8_t(step_of(*this, kLastClass, density));
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
  if (needed > kLastClass + 1) {
    throw InputError({"", "label",
                      std::to_string(material.labels.size()) + " tables that need " +
                          std::to_string(needed) + " classes",
                      "at most " + std::to_string(kLastClass + 1) +
                          ": one for the common table and each label, two where limits vary"});
  }
  int next = 0;
  for (Share& share : m_shares) {
    if (share.count == 0) share.count = (kLastClass + 1 - single) / varying;
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

MaterialClasses::TablePosition MaterialClasses::position_of(int end) const {
  std::size_t n = m_shares.size() - 1;
  while (m_shares[n].first > end) --n;
  const Share& share = m_shares[n];
  const int last = std::max(1, share.count - 1);
  return {share.table, std::min(end - share.first, last) / double(last)};
}

LinkLimits MaterialClasses::limits(int axis, int class_a, int class_b) const {
  if (!m_combines_limits) {
    return limits_at(*m_shares.front().table, axis, (class_a + class_b) / (2.0 * kLastClass));
  }
  const TablePosition end_a = position_of(class_a), end_b = position_of(class_b);
  return mean_of(limits_at(*end_a.table, axis, end_a.position),
                 limits_at(*end_b.table, axis, end_b.position));
}

LinkPhysics MaterialClasses::physics(int class_a, int class_b) const {
  if (!m_combines_limits) {
    return physics_at(*m_shares.front().table, (class_a + class_b) / (2.0 * kLastClass));
  }
  const TablePosition end_a = position_of(class_a), end_b = position_of(class_b);
  const LinkPhysics a = physics_at(*end_a.table, end_a.position);
  const LinkPhysics b = physics_at(*end_b.table, end_b.position);
  return {(a.stiffness_kpa + b.stiffness_kpa) / 2, (a.rayleigh_beta_ms + b.rayleigh_beta_ms) / 2,
          (a.yield_strain + b.yield_strain) / 2};
}

double MaterialClasses::value_of_class(int of, std::optional<Curve> LimitTable::*column,
                                       double without) const {
  const auto [table, position] = position_of(of);
  const std::optional<Curve>& curve = table->*column;
  return curve ? (*curve)(density_at(*table, position)) : without;
}

double MaterialClasses::mass_density_of_class(int of) const {
  return value_of_class(of, &LimitTable::mass_density, kDefaultMassDensity);
}

double MaterialClasses::poisson_of_class(int of) const {
  return value_of_class(of, &LimitTable::poisson, kDefaultPoisson);
}

LinkLimits limits_of(const MaterialTable& table, int axis, int class_a, int class_b) {
  return MaterialClasses(table).limits(axis, class_a, class_b);
}

}  // namespace supple
