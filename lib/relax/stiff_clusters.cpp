#include "lib/relax/stiff_clusters.h"

#include <algorithm>
#include <iterator>

namespace supple {

Joins joined_from(const Body& body, const LinkTable& table, const Movable& elements,
                  double stiffness_n_m) {
  return [&body, &table, &elements, stiffness_n_m](int kind, Slot low, Slot high) {
    if (!elements.moves(low) || !elements.moves(high)) return false;
    const std::uint8_t a = body.classes[low], b = body.classes[high];
    if (table.is_rigid(kind, a, b)) return true;
    return kind < kAxisKinds && table.values(kind, a, b).stiffness >= stiffness_n_m;
  };
}

void StiffnessRange::add(double stiffness_n_m) {
  if (stiffness_n_m == 0) return;
  least = least == 0 ? stiffness_n_m : std::min(least, stiffness_n_m);
  most = std::max(most, stiffness_n_m);
}

StiffnessRange stiffness_range(const Body& body, const LinkTable& table,
                               const std::vector<std::uint32_t>& bricks) {
  StiffnessRange range;
  for (const std::uint32_t b : bricks) {
    for_each_link(body.elements, body.cuts, b, [&](int axis, Slot low, Slot high) {
      range.add(table.values(axis, body.classes[low], body.classes[high]).stiffness);
    });
  }
  return range;
}

StiffClusters::StiffClusters(const Body& body, const LinkTable& table, const Movable& elements)
    : m_body(body), m_table(table), m_elements(elements) {}

const std::vector<Clusters>& StiffClusters::of(const std::vector<std::uint32_t>& bricks) {
  std::vector<std::uint32_t> fresh;
  std::set_difference(bricks.begin(), bricks.end(), m_bricks.begin(), m_bricks.end(),
                      std::back_inserter(fresh));
  if (fresh.empty()) return m_found;
  m_bricks = bricks;
  const StiffnessRange of_fresh = stiffness_range(m_body, m_table, fresh);
  const double least = m_range.least;
  m_range.add(of_fresh.least);
  m_range.add(of_fresh.most);
  if (m_range.least != least) m_levels.clear();
  for (GrowingClusters& level : m_levels) level.add(fresh);
  const std::size_t known = m_levels.size();
  double k = kStiffRatio * m_range.least;
  for (std::size_t level = 0; k > 0 && k <= m_range.most; ++level, k *= kStiffRatio) {
    if (level < known) continue;
    m_levels.emplace_back(m_body, m_table, joined_from(m_body, m_table, m_elements, k));
    m_levels.back().add(bricks);
  }
  m_found.clear();
  for (GrowingClusters& level : m_levels) m_found.push_back(level.find());
  return m_found;
}

std::size_t StiffClusters::bytes() const {
  std::size_t total = m_bricks.capacity() * sizeof(std::uint32_t);
  for (const GrowingClusters& level : m_levels) total += level.bytes();
  for (const Clusters& level : m_found) total += level.bytes();
  return total;
}

}  // namespace supple
