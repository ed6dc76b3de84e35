#include "tests/lib/brute_force.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <utility>

#include <gtest/gtest.h>

namespace supple::test {

namespace {

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

/// Limits of a material as one end of a link sees them.
struct End {
  const LimitTable* table;
  Real position;  // of its class in the table's domain, 0…1
};

bool varies(const Curve& curve) {
  for (const auto& key : curve.keys) {
    if (key.second != curve.keys[0].second) return true;
  }
  return false;
}

bool varies(const LimitTable& table) {
  bool any = varies(table.max_length) || varies(table.min_length) || varies(table.shear1) ||
             varies(table.shear2);
  for (int axis = 0; axis < 3; ++axis) {
    any = any || (table.max_length_axis[axis] && varies(*table.max_length_axis[axis]));
    any = any || (table.min_length_axis[axis] && varies(*table.min_length_axis[axis]));
  }
  return any;
}

/// Classes of each table that varies, where labels have tables: what constant ones leave, shared.
int classes_of_each(const MaterialTable& material) {
  if (material.labels.empty()) return 256;
  int left = 256, sharing = 0;
  const auto count = [&](const LimitTable& table) {
    if (varies(table)) {
      ++sharing;
    } else {
      --left;
    }
  };
  count(material);
  for (const auto& entry : material.labels) count(entry.second);
  return sharing == 0 ? 1 : left / sharing;
}

End end_by_hand(const Block& block, int node, int classes) {
  const MaterialTable& material = block.table;
  const LimitTable* table = &material;
  if (!block.label.empty()) {
    const auto own = material.labels.find(block.label[std::size_t(node)]);
    if (own != material.labels.end()) table = &own->second;
  }
  if (!material.labels.empty() && !varies(*table)) return {table, 0};
  const double density = block.density[std::size_t(node)];
  const Real t = (Real(density) - table->domain_lo) / (Real(table->domain_hi) - table->domain_lo);
  const Real steps = classes - 1;
  return {table, std::floor(steps * std::min(Real(1), std::max(Real(0), t)) + Real(0.5)) / steps};
}

using CurveOf = const Curve& (*)(const LimitTable& table, int axis);

Real at_end(const End& end, const Curve& curve) {
  const LimitTable& table = *end.table;
  return evaluate(curve,
                  table.domain_lo + end.position * (Real(table.domain_hi) - table.domain_lo));
}

/// Curve at the mean of two classes, or the mean of the curves at both.
Real at_link(const MaterialTable& material, CurveOf curve, int axis, const End& a, const End& b) {
  if (material.combine == Combine::limits || !material.labels.empty()) {
    return (at_end(a, curve(*a.table, axis)) + at_end(b, curve(*b.table, axis))) / 2;
  }
  return at_end({a.table, (a.position + b.position) / 2}, curve(material, axis));
}

const Curve& longest_of(const LimitTable& table, int axis) {
  return table.max_length_axis[axis] ? *table.max_length_axis[axis] : table.max_length;
}
const Curve& shortest_of(const LimitTable& table, int axis) {
  return table.min_length_axis[axis] ? *table.min_length_axis[axis] : table.min_length;
}
const Curve& shear1_of(const LimitTable& table, int) {
  return table.shear1;
}
const Curve& shear2_of(const LimitTable& table, int) {
  return table.shear2;
}

Wide units_below(Real voxels) {
  const Real units = std::floor(voxels * 65536 + Real(1e-7));
  if (units >= Real(1 << 30)) return kNoPath;
  return std::max<Wide>(0, Wide(units));
}

struct Bounds {
  Wide upper, lower;
};
/// Bounds of coordinate c across a link along an axis.
Bounds bounds_by_hand(const Block& block, int axis, int c, const End& a, const End& b) {
  const MaterialTable& table = block.table;
  if (c == axis) {
    return {units_below(at_link(table, longest_of, axis, a, b) - 1),
            units_below(1 - at_link(table, shortest_of, axis, a, b))};
  }
  const double h[3] = {block.spacing_mm.x, block.spacing_mm.y, block.spacing_mm.z};
  const bool first = c == (axis == 0 ? 1 : 0);
  const Wide shear =
      units_below(at_link(table, first ? shear1_of : shear2_of, axis, a, b) * h[axis] / h[c]);
  return {shear, shear};
}

}  // namespace

BruteForce::BruteForce(const Block& block) : m_nodes(block.size()) {
  for (auto& coordinate : q) coordinate.assign(m_nodes, 0);
  const int dims[3] = {block.dims.x, block.dims.y, block.dims.z};
  const int step[3] = {1, dims[0], dims[0] * dims[1]};
  const int classes = classes_of_each(block.table);
  for (int low = 0; low < m_nodes; ++low) {
    const int position[3] = {low % dims[0], low / dims[0] % dims[1], low / dims[0] / dims[1]};
    for (int axis = 0; axis < 3; ++axis) {
      if (position[axis] + 1 == dims[axis]) continue;
      if (!block.cut.empty() && (block.cut[low] >> axis & 1)) continue;
      const int high = low + step[axis];
      if (!block.element[low] || !block.element[high]) continue;
      const End a = end_by_hand(block, low, classes), b = end_by_hand(block, high, classes);
      Link link{low, high, {}, {}};
      for (int c = 0; c < 3; ++c) {
        const Bounds bounds = bounds_by_hand(block, axis, c, a, b);
        link.upper[c] = bounds.upper;
        link.lower[c] = bounds.lower;
      }
      m_links.push_back(link);
    }
  }
  if (block.table.links > 6) add_diagonals(block);
}

/// Every way to order the steps of every diagonal is tried, from link to link.
void BruteForce::add_diagonals(const Block& block) {
  const int size[3] = {block.dims.x, block.dims.y, block.dims.z};
  const int step[3] = {1, size[0], size[0] * size[1]};
  std::set<std::pair<int, int>> joined_nodes;
  for (const Link& link : m_links) joined_nodes.insert({link.low, link.high});
  const auto link_between = [&](int a, int b) { return joined_nodes.count(std::minmax(a, b)) > 0; };
  for (int from = 0; from < m_nodes; ++from) {
    const int position[3] = {from % size[0], from / size[0] % size[1], from / size[0] / size[1]};
    for (int code = 0; code < 27; ++code) {
      const int d[3] = {code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1};
      const int axes = std::abs(d[0]) + std::abs(d[1]) + std::abs(d[2]);
      if (axes < 2 || axes > (block.table.links == 18 ? 2 : 3)) continue;
      int to = from;
      bool within = true;
      for (int a = 0; a < 3; ++a) {
        within = within && position[a] + d[a] >= 0 && position[a] + d[a] < size[a];
        to += d[a] * step[a];
      }
      if (!within || from > to || !block.element[from] || !block.element[to]) continue;
      bool joined = false;
      int order[3] = {0, 1, 2};
      do {
        int at = from;
        bool path = true;
        for (const int a : order) {
          if (d[a] == 0) continue;
          path = path && link_between(at, at + d[a] * step[a]);
          at += d[a] * step[a];
        }
        joined = joined || path;
      } while (std::next_permutation(order, order + 3));
      if (!joined) continue;
      Link link{from, to, {}, {}};
      const int classes = classes_of_each(block.table);
      const End a = end_by_hand(block, from, classes), b = end_by_hand(block, to, classes);
      for (int c = 0; c < 3; ++c) {
        Real rise = 0, fall = 0;
        for (int axis = 0; axis < 3; ++axis) {
          if (d[axis] == 0) continue;
          const Bounds bounds = bounds_by_hand(block, axis, c, a, b);
          const Real up = Real(d[axis] > 0 ? bounds.upper : bounds.lower);
          const Real down = Real(d[axis] > 0 ? bounds.lower : bounds.upper);
          rise += up * up;
          fall += down * down;
        }
        const auto root = [](Real square) {
          return square >= Real(1 << 30) * Real(1 << 30) ? kNoPath : Wide(std::sqrt(square));
        };
        link.upper[c] = root(rise);
        link.lower[c] = root(fall);
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

void BruteForce::join(const std::vector<int>& nodes) {
  for (std::size_t n = 1; n < nodes.size(); ++n) {
    m_links.push_back({nodes[n - 1], nodes[n], {0, 0, 0}, {0, 0, 0}});
  }
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
  Wide largest = -kNoPath;
  for (const Limit& from : limits(c, true, {a}, {})) {
    if (!from.is_handle) continue;
    const std::vector<Wide> distance = distances_from(c, from.node);
    for (const Limit& to : limits(c, false, {b}, {})) {
      if (!to.is_handle) continue;
      largest = std::max(largest, from.at + from.by - to.at - to.by - distance[to.node]);
    }
  }
  return largest;
}

std::optional<Wide> BruteForce::tool_at(int c, bool lower, int node, Wide by) const {
  for (const Kept& kept : m_kept) {
    if (kept.node != node || kept.anchored) continue;
    const bool is_below = kept.least[c] > -kNoPath, is_above = kept.most[c] < kNoPath;
    if (!is_below && !is_above) break;
    if (lower != is_below) return {};
    return lower ? kept.least[c] : kept.most[c];
  }
  if (lower ? by > 0 : by < 0) return q[c][node];
  return {};
}

std::vector<BruteForce::Limit> BruteForce::limits(int c, bool lower, const std::vector<Grab>& grabs,
                                                  const std::vector<int>& anchors) const {
  std::vector<Limit> list;
  std::vector<char> grabbed(std::size_t(m_nodes), 0);
  for (const int node : anchors) list.push_back({node, q[c][node], 0, false});
  for (const Grab& grab : grabs) {
    for (std::size_t n = 0; n < grab.nodes.size(); ++n) {
      const int node = grab.nodes[n];
      const Wide by = grab.by_of(n)[c];
      grabbed[std::size_t(node)] = 1;
      const std::optional<Wide> at =
          grab.push ? tool_at(c, lower, node, by) : std::optional<Wide>(q[c][node]);
      if (at) list.push_back({node, *at, by, true});
    }
  }
  for (const Kept& kept : m_kept) {
    if (grabbed[std::size_t(kept.node)]) continue;
    const Wide bound = kept.anchored ? q[c][kept.node] : lower ? kept.least[c] : kept.most[c];
    if (bound > -kNoPath && bound < kNoPath) list.push_back({kept.node, bound, 0, false});
  }
  return list;
}

/// All pairs: handles must agree, everything else scales the drag.
void BruteForce::compare(int c, const std::vector<Limit>& lower, const std::vector<Limit>& upper,
                         Outcome& outcome) const {
  for (const Limit& a : lower) {
    const std::vector<Wide> distance = distances_from(c, a.node);
    for (const Limit& b : upper) {
      const Wide spread = a.by - b.by;
      const Wide room = distance[b.node] - (a.at - b.at);
      if (spread <= room) continue;
      if (a.is_handle && b.is_handle) {
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

BruteForce::Outcome BruteForce::drag(const std::vector<Grab>& grabs,
                                     const std::vector<int>& anchors, bool keep) {
  std::array<std::vector<Limit>, 3> lower, upper;
  Outcome outcome;
  for (int c = 0; c < 3; ++c) {
    lower[c] = limits(c, true, grabs, anchors);
    upper[c] = limits(c, false, grabs, anchors);
    compare(c, lower[c], upper[c], outcome);
    if (outcome.conflict) return outcome;
  }
  const std::vector<Kept> next = kept_after(grabs, outcome);
  for (int c = 0; c < 3; ++c) move_between(c, lower[c], upper[c], outcome);
  if (keep) m_kept = next;
  return outcome;
}

/// q = median(L, q, U) with the envelopes of all limits.
void BruteForce::move_between(int c, const std::vector<Limit>& lower,
                              const std::vector<Limit>& upper, const Outcome& outcome) {
  std::vector<Wide> least(m_nodes, -kNoPath * 4), greatest(m_nodes, kNoPath * 4);
  for (const Limit& a : lower) {
    const std::vector<Wide> from = distances_from(c, a.node);
    for (int j = 0; j < m_nodes; ++j) {
      if (from[j] < kNoPath) least[j] = std::max(least[j], a.at + part_of(a.by, outcome) - from[j]);
    }
  }
  for (const Limit& b : upper) {
    const std::vector<Wide> to = distances_to(c, b.node);
    for (int j = 0; j < m_nodes; ++j) {
      if (to[j] < kNoPath)
        greatest[j] = std::min(greatest[j], b.at + part_of(b.by, outcome) + to[j]);
    }
  }
  for (int j = 0; j < m_nodes; ++j) q[c][j] = std::clamp(q[c][j], least[j], greatest[j]);
}

std::vector<BruteForce::Kept> BruteForce::kept_after(const std::vector<Grab>& grabs,
                                                     const Outcome& outcome) const {
  std::vector<Kept> kept_nodes;
  std::vector<char> grabbed(std::size_t(m_nodes), 0);
  for (const Grab& grab : grabs) {
    for (std::size_t n = 0; n < grab.nodes.size(); ++n) {
      const int node = grab.nodes[n];
      Kept kept{node, !grab.push, {-kNoPath, -kNoPath, -kNoPath}, {kNoPath, kNoPath, kNoPath}};
      for (int c = 0; c < 3; ++c) {
        const Wide by = grab.by_of(n)[c], part = part_of(by, outcome);
        if (const auto at = tool_at(c, true, node, by)) kept.least[c] = *at + part;
        if (const auto at = tool_at(c, false, node, by)) kept.most[c] = *at + part;
      }
      kept_nodes.push_back(kept);
      grabbed[std::size_t(node)] = 1;
    }
  }
  for (const Kept& kept : m_kept) {
    if (!grabbed[std::size_t(kept.node)]) kept_nodes.push_back(kept);
  }
  return kept_nodes;
}

void expect_equal(const Body& body, const Block& block, const BruteForce& brute) {
  for (int n = 0; n < block.size(); ++n) {
    if (!block.element[n]) continue;
    for (int c = 0; c < 3; ++c) {
      ASSERT_EQ(body.offset(block.voxel(n), c), brute.q[c][n]) << "node " << n << " axis " << c;
    }
  }
}

}  // namespace supple::test
