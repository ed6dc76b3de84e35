#include "lib/fem/residual.h"

#include <cmath>

#include "lib/fem/node_vectors.h"

namespace supple {

namespace {

/// Norms over single nodes, found by ranges.
struct NodeNorms {
  double largest_free = 0, largest_held = 0, squares = 0;
  double free_lengths = 0, held_lengths = 0;
  Vec3d free_sum{0, 0, 0};
};

NodeNorms norms_of_range(const double* r, const double* within, const std::uint8_t* held,
                         std::size_t begin, std::size_t end) {
  NodeNorms norms;
  for (std::size_t n = begin / 3; n < end / 3; ++n) {
    double free = 0, reaction = 0;
    for (int a = 0; a < 3; ++a) {
      const bool is_held = (held[n] >> a & 1) != 0;
      const std::size_t at = 3 * n + std::size_t(a);
      const double value = r[at] + (is_held && within != nullptr ? within[at] : 0);
      (is_held ? reaction : free) += value * value;
      if (!is_held) norms.free_sum[a] += value;
    }
    norms.free_lengths += std::sqrt(free);
    norms.held_lengths += std::sqrt(reaction);
    norms.largest_free = std::max(norms.largest_free, free);
    norms.largest_held = std::max(norms.largest_held, reaction);
    norms.squares += free;
  }
  return norms;
}

/// `within`: forces at held nodes that do not count, three per node; may be empty.
NodeNorms node_norms(const std::vector<double>& r, const HeldBits& held,
                     const std::vector<double>& within) {
  static_assert(kVectorRange % 3 == 0, "ranges hold whole nodes");
  std::vector<NodeNorms> parts((r.size() + kVectorRange - 1) / kVectorRange);
  for_ranges(r.size(), [&](std::size_t begin, std::size_t end) {
    parts[begin / kVectorRange] =
        norms_of_range(r.data(), within.empty() ? nullptr : within.data(), held.data(), begin, end);
  });
  NodeNorms sum;
  for (const NodeNorms& part : parts) {
    sum.largest_free = std::max(sum.largest_free, part.largest_free);
    sum.largest_held = std::max(sum.largest_held, part.largest_held);
    sum.squares += part.squares;
    sum.free_lengths += part.free_lengths;
    sum.held_lengths += part.held_lengths;
    sum.free_sum += part.free_sum;
  }
  sum.largest_free = std::sqrt(sum.largest_free);
  sum.largest_held = std::sqrt(sum.largest_held);
  return sum;
}

}  // namespace

double decades_done(double value, double limit) {
  if (value <= limit) return 1;
  return limit >= 1 ? 0 : std::clamp(std::log(value) / std::log(limit), 0.0, 1.0);
}

double part_of_way(const ResidualSize& size, double tolerance, double reaction_tolerance) {
  const double residual = std::max({size.max, size.rms, size.balance});
  return std::min(decades_done(residual, tolerance),
                  decades_done(size.reaction_change, reaction_tolerance));
}

void set_to_forces(const NodalLoads& loads, std::vector<double>& r) {
  if (loads.force_mn.empty()) {
    fill(r.data(), r.size(), 0.0);
  } else {
    std::copy(loads.force_mn.begin(), loads.force_mn.end(), r.begin());
  }
}

ResidualMeter::ResidualMeter(const NodalLoads& loads)
    : m_loads(&loads), m_reactions(loads.nodes_of.size(), Vec3d(0)) {
  if (loads.force_mn.empty()) return;
  const NodeNorms norms = node_norms(loads.force_mn, loads.held, {});
  m_largest_load_mn = std::max(norms.largest_free, norms.largest_held);
  m_load_lengths_mn = norms.free_lengths + norms.held_lengths;
  m_seen_mn = m_largest_load_mn;
}

ResidualSize ResidualMeter::operator()(const std::vector<double>& r) {
  const NodeNorms norms = node_norms(r, m_loads->held, m_loads->within_held_mn);
  ResidualSize size;
  size.largest_mn = norms.largest_free;
  have_seen(std::max(norms.largest_free, norms.largest_held));
  size.seen_mn = m_seen_mn;
  const double least_force_mn = kLeastForce * m_seen_mn;
  size.largest_force_mn = std::max({m_largest_load_mn, norms.largest_held, least_force_mn});
  const double scale = size.largest_force_mn > 0 ? 1 / size.largest_force_mn : 0;
  size.max = norms.largest_free * scale;
  size.rms = std::sqrt(norms.squares / double(m_loads->held.size())) * scale;
  const double lengths = std::max(m_load_lengths_mn + norms.held_lengths, least_force_mn);
  size.balance = lengths > 0 ? norms.free_sum.length() / lengths : 0;
  const std::vector<double>& within = m_loads->within_held_mn;
  double change = 0, largest = 0;
  for (std::size_t s = 0; s < m_reactions.size(); ++s) {
    Vec3d sum(0);
    for (std::size_t of_held = 0; of_held < m_loads->nodes_of[s].size(); ++of_held) {
      const NodeIndex n = m_loads->nodes_of[s][of_held];
      const double share = m_loads->share(s, of_held);
      for (int a = 0; a < 3; ++a) {
        const std::size_t at = 3 * std::size_t(n) + std::size_t(a);
        if ((m_loads->held[n] >> a & 1) == 0) continue;
        sum[a] += share * (r[at] + (within.empty() ? 0 : within[at]));
      }
    }
    change = std::max(change, (sum - m_reactions[s]).length());
    largest = std::max(largest, sum.length());
    m_reactions[s] = sum;
  }
  // Reactions that balance each other to rounding count by the largest nodal force.
  largest = std::max(largest, size.largest_force_mn);
  size.reaction_change = largest > 0 ? change / largest : 0;
  size.reaction_change_mn = change;
  return size;
}

}  // namespace supple
