#include "lib/springs/spring_matrix.h"

#include <algorithm>
#include <cmath>

namespace supple {

namespace {

/// along * n n^T + across * (I - n n^T).
SymmetricBlock spring_block(const Vec3d& n, double along, double across) {
  const double d = along - across;
  return {across + d * n.x * n.x, across + d * n.y * n.y, across + d * n.z * n.z,
          d * n.x * n.y,          d * n.x * n.z,          d * n.y * n.z};
}

void add(SymmetricBlock& sum, const SymmetricBlock& block, double factor) {
  for (int n = 0; n < 6; ++n) sum[n] += factor * block[n];
}

}  // namespace

SpringMatrix::Pattern SpringMatrix::analyse(const SpringSystem& system,
                                            const std::vector<char>& is_held) {
  Pattern pattern;
  pattern.row_of_node.assign(system.node_count(), -1);
  for (std::size_t n = 0; n < system.node_count(); ++n) {
    if (is_held[n]) continue;
    pattern.row_of_node[n] = int(pattern.node_of_row.size());
    pattern.node_of_row.push_back(int(n));
  }
  const auto pair_of = [](int a, int b) {
    return std::array<int, 2>{std::min(a, b), std::max(a, b)};
  };
  for (const Spring& s : system.springs) {
    const int a = pattern.row_of_node[s.a], b = pattern.row_of_node[s.b];
    pattern.places.push_back({a, b, -1});
    if (a >= 0 && b >= 0) pattern.couplings.push_back(pair_of(a, b));
  }
  auto& couplings = pattern.couplings;
  std::sort(couplings.begin(), couplings.end());
  couplings.erase(std::unique(couplings.begin(), couplings.end()), couplings.end());
  for (Place& place : pattern.places) {
    if (place.a < 0 || place.b < 0) continue;
    const auto at = std::lower_bound(couplings.begin(), couplings.end(), pair_of(place.a, place.b));
    place.coupling = int(at - couplings.begin());
  }
  return pattern;
}

SpringMatrix::SpringMatrix(Pattern pattern)
    : m_pattern(std::move(pattern)),
      m_factors(int(m_pattern.node_of_row.size()), m_pattern.couplings) {}

SpringMatrix::SpringMatrix(const SpringSystem& system, const std::vector<char>& is_held)
    : SpringMatrix(analyse(system, is_held)) {}

bool SpringMatrix::factorise(const SpringSystem& system, double mass_factor, double damping_factor,
                             const std::vector<Vec3d>& damping_pos) {
  m_diagonal.resize(m_pattern.node_of_row.size());
  for (std::size_t row = 0; row < m_diagonal.size(); ++row) {
    const double m = mass_factor * system.mass_kg[m_pattern.node_of_row[row]];
    m_diagonal[row] = {m, m, m, 0, 0, 0};
  }
  m_coupling.assign(m_pattern.couplings.size(), SymmetricBlock{});
  const auto add_block = [&](const Place& place, const SymmetricBlock& block) {
    if (place.a >= 0) add(m_diagonal[place.a], block, 1);
    if (place.b >= 0) add(m_diagonal[place.b], block, 1);
    if (place.coupling >= 0) add(m_coupling[place.coupling], block, -1);
  };
  for (std::size_t n = 0; n < system.springs.size(); ++n) {
    const Spring& s = system.springs[n];
    const Place& place = m_pattern.places[n];
    if (place.a < 0 && place.b < 0) continue;
    const Vec3d x = system.pos_mm[s.b] - system.pos_mm[s.a];
    const double length = std::sqrt(x.length2());
    if (length > 0) {
      const double across = std::max(0.0, 1 - s.rest_mm / length);
      add_block(place, spring_block(x / length, s.stiffness_n_m, across * s.stiffness_n_m));
    }
    if (damping_factor == 0 || s.damping_n_s_m == 0) continue;
    const Vec3d before = damping_pos[s.b] - damping_pos[s.a];
    const double length_before = std::sqrt(before.length2());
    if (length_before == 0) continue;
    add_block(place, spring_block(before / length_before, damping_factor * s.damping_n_s_m, 0));
  }
  return m_factors.factorise(m_diagonal, m_coupling);
}

void SpringMatrix::solve(std::vector<Vec3d>& x) {
  m_rows.resize(m_pattern.node_of_row.size());
  for (std::size_t row = 0; row < m_rows.size(); ++row) m_rows[row] = x[m_pattern.node_of_row[row]];
  m_factors.solve(m_rows);
  std::fill(x.begin(), x.end(), Vec3d(0.0));
  for (std::size_t row = 0; row < m_rows.size(); ++row) x[m_pattern.node_of_row[row]] = m_rows[row];
}

}  // namespace supple
