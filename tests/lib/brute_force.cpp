#include "tests/lib/brute_force.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace supple::test {

namespace {

using Real = long double;

Real evaluate(const Curve& curve, Real density) {
  const auto& keys = curve.keys;
  for (std::size_t n = 0; n < keys.size(); ++n) {
    if (density > keys[n].first) continue;
    if (n == 0) return keys[0].second;
    const Real t = (density - keys[n - 1].first) / (Real(keys[n].first) - keys[n - 1].first);
    return (1 - t) * keys[n - 1].second + t * keys[n].second;
  }
  return keys.back().second;
}

int class_by_hand(const MaterialTable& table, double density) {
  const Real t = (Real(density) - table.domain_lo) / (Real(table.domain_hi) - table.domain_lo);
  return int(std::floor(255 * std::min(Real(1), std::max(Real(0), t)) + Real(0.5)));
}

/// Curve at the mean of two classes, or the mean of the curve at both.
Real at_link(const MaterialTable& table, const Curve& curve, int a, int b) {
  const Real width = Real(table.domain_hi) - table.domain_lo;
  const auto at = [&](Real position) {
    return evaluate(curve, table.domain_lo + position * width);
  };
  if (table.combine == Combine::limits) return (at(Real(a) / 255) + at(Real(b) / 255)) / 2;
  return at(Real(a + b) / 510);
}

Wide units_below(Real voxels) {
  const Real units = std::floor(voxels * 65536 + Real(1e-7));
  if (units >= Real(1 << 30)) return kNoPath;
  return std::max<Wide>(0, Wide(units));
}

}  // namespace

BruteForce::BruteForce(const Block& block) : m_nodes(block.size()) {
  for (auto& coordinate : q) coordinate.assign(m_nodes, 0);
  const int dims[3] = {block.dims.x, block.dims.y, block.dims.z};
  const int step[3] = {1, dims[0], dims[0] * dims[1]};
  const double h[3] = {block.spacing_mm.x, block.spacing_mm.y, block.spacing_mm.z};
  for (int low = 0; low < m_nodes; ++low) {
    const int position[3] = {low % dims[0], low / dims[0] % dims[1], low / dims[0] / dims[1]};
    for (int axis = 0; axis < 3; ++axis) {
      if (position[axis] + 1 == dims[axis]) continue;
      if (!block.cut.empty() && (block.cut[low] >> axis & 1)) continue;
      const int high = low + step[axis];
      if (!block.element[low] || !block.element[high]) continue;
      const MaterialTable& table = block.table;
      const int a = class_by_hand(table, block.density[low]);
      const int b = class_by_hand(table, block.density[high]);
      Link link{low, high, {}, {}};
      const Curve& longest =
          table.max_length_axis[axis] ? *table.max_length_axis[axis] : table.max_length;
      const Curve& shortest =
          table.min_length_axis[axis] ? *table.min_length_axis[axis] : table.min_length;
      link.upper[axis] = units_below(at_link(table, longest, a, b) - 1);
      link.lower[axis] = units_below(1 - at_link(table, shortest, a, b));
      bool first = true;
      for (int c = 0; c < 3; ++c) {
        if (c == axis) continue;
        const Curve& shear = first ? table.shear1 : table.shear2;
        link.upper[c] = link.lower[c] = units_below(at_link(table, shear, a, b) * h[axis] / h[c]);
        first = false;
      }
      m_links.push_back(link);
    }
  }
}

std::vector<Wide> BruteForce::relax(int c, int source, bool from) const {
  std::vector<Wide> distance(m_nodes, kNoPath);
  distance[source] = 0;
  bool changed = true;
  const auto lower_to = [&](int node, Wide value) {
    if (value >= distance[node]) return;
    distance[node] = value;
    changed = true;
  };
  const auto visit = [&](const Link& link) {
    // T_low - q_high <= lower and T_high - q_low <= upper.
    const Wide up = from ? link.lower[c] : link.upper[c];
    const Wide down = from ? link.upper[c] : link.lower[c];
    lower_to(link.high, distance[link.low] + up);
    lower_to(link.low, distance[link.high] + down);
  };
  while (changed) {
    changed = false;
    for (auto link = m_links.begin(); link != m_links.end(); ++link) visit(*link);
    for (auto link = m_links.rbegin(); link != m_links.rend(); ++link) visit(*link);
  }
  return distance;
}

int BruteForce::broken_links() const {
  int broken = 0;
  for (const Link& link : m_links) {
    for (int c = 0; c < 3; ++c) {
      const Wide stretch = q[c][link.high] - q[c][link.low];
      broken += stretch > link.upper[c] || -stretch > link.lower[c];
    }
  }
  return broken;
}

Wide BruteForce::missing(int c, const Grab& a, const Grab& b) const {
  return q[c][a.node] + a.by[c] - q[c][b.node] - b.by[c] - distances_from(c, a.node)[b.node];
}

BruteForce::Outcome BruteForce::drag(const std::vector<Grab>& grabs,
                                     const std::vector<int>& anchors) {
  std::vector<Grab> held = grabs;
  for (const int node : anchors) held.push_back({node, {0, 0, 0}});
  const std::size_t handles = grabs.size();
  Outcome outcome;
  for (int c = 0; c < 3 && !outcome.conflict; ++c) {
    for (std::size_t a = 0; a < held.size(); ++a) {
      const std::vector<Wide> distance = distances_from(c, held[a].node);
      for (std::size_t b = 0; b < held.size(); ++b) {
        const Wide spread = held[a].by[c] - held[b].by[c];
        const Wide room = distance[held[b].node] - (q[c][held[a].node] - q[c][held[b].node]);
        if (spread <= room) continue;
        if (a < handles && b < handles) {
          outcome.conflict = true;
          outcome.conflict_axis = c;
          outcome.missing = std::max(outcome.missing, spread - room);
        } else if (__int128(room) * outcome.denominator < __int128(outcome.numerator) * spread) {
          const Wide divisor = std::gcd(room, spread);
          outcome.numerator = room / divisor;
          outcome.denominator = spread / divisor;
        }
      }
    }
  }
  if (outcome.conflict) return outcome;

  std::vector<int> nodes;
  for (const Grab& grab : held) nodes.push_back(grab.node);
  for (int c = 0; c < 3; ++c) {
    std::vector<Wide> targets;
    for (const Grab& grab : held) {
      const Wide sign = grab.by[c] < 0 ? -1 : 1;
      targets.push_back(q[c][grab.node] +
                        sign * (sign * grab.by[c] * outcome.numerator / outcome.denominator));
    }
    move_between(c, nodes, targets);
  }
  return outcome;
}

/// q = median(L, q, U) with the envelopes of all held nodes.
void BruteForce::move_between(int c, const std::vector<int>& held,
                              const std::vector<Wide>& targets) {
  std::vector<Wide> least(m_nodes, -kNoPath * 4), greatest(m_nodes, kNoPath * 4);
  for (std::size_t a = 0; a < held.size(); ++a) {
    const std::vector<Wide> from = distances_from(c, held[a]), to = distances_to(c, held[a]);
    for (int j = 0; j < m_nodes; ++j) {
      if (from[j] < kNoPath) least[j] = std::max(least[j], targets[a] - from[j]);
      if (to[j] < kNoPath) greatest[j] = std::min(greatest[j], targets[a] + to[j]);
    }
  }
  for (int j = 0; j < m_nodes; ++j) q[c][j] = std::clamp(q[c][j], least[j], greatest[j]);
}

}  // namespace supple::test
