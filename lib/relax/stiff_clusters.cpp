#include "lib/relax/stiff_clusters.h"

#include <algorithm>

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

StiffnessRange stiffness_range(const Body& body, const LinkTable& table,
                               const std::vector<std::uint32_t>& bricks) {
  StiffnessRange range;
  for (const std::uint32_t b : bricks) {
    for_each_link(body.elements, body.cuts, b, [&](int axis, Slot low, Slot high) {
      const double k = table.values(axis, body.classes[low], body.classes[high]).stiffness;
      if (k == 0) return;
      range.least = range.least == 0 ? k : std::min(range.least, k);
      range.most = std::max(range.most, k);
    });
  }
  return range;
}

std::vector<Clusters> find_stiff_clusters(const Body& body, const LinkTable& table,
                                          const Movable& elements,
                                          const std::vector<std::uint32_t>& bricks) {
  std::vector<Clusters> levels;
  const StiffnessRange range = stiffness_range(body, table, bricks);
  if (range.least == 0) return levels;
  for (double k = kStiffRatio * range.least; k <= range.most; k *= kStiffRatio) {
    levels.push_back(find_clusters(body, table, bricks, joined_from(body, table, elements, k)));
  }
  return levels;
}

}  // namespace supple
