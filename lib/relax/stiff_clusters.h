// Elements that stiff links join. A relaxation that steps elements one by one moves a stiff part
// hardly at all, as each of its elements is held back by the others: passes grow with the contrast
// of stiffness. Stepped as one it moves at the pace of its surroundings. In one coordinate a shift
// is the only motion that costs a stiff part next to nothing, so shifts suffice.
#pragma once

#include <vector>

#include "lib/relax/clusters.h"
#include "lib/relax/movable.h"

namespace supple {

/// A link this much stiffer than another counts as stiff beside it.
constexpr double kStiffRatio = 30;

/// Joins the moving elements that axis links of at least `stiffness_n_m`, or rigid ones, join.
Joins joined_from(const Body& body, const LinkTable& table, const Movable& elements,
                  double stiffness_n_m);

/// Softest and stiffest axis link of these bricks, in N/m; 0 and 0 without links.
struct StiffnessRange {
  double least = 0, most = 0;
  void add(double stiffness_n_m);
};
StiffnessRange stiffness_range(const Body& body, const LinkTable& table,
                               const std::vector<std::uint32_t>& bricks);

/// Stiff clusters of a growing part of the body, as a relaxation spreads; of() extends them.
class StiffClusters {
 public:
  /// All must outlive this.
  StiffClusters(const Body& body, const LinkTable& table, const Movable& elements);

  /// Clusters in `bricks`, ascending, with those of the last time. One set per factor of
  /// kStiffRatio above the softest link, the softest first; none where all links are about as
  /// stiff.
  const std::vector<Clusters>& of(const std::vector<std::uint32_t>& bricks);
  std::size_t bytes() const;

 private:
  const Body& m_body;
  const LinkTable& m_table;
  const Movable& m_elements;
  std::vector<std::uint32_t> m_bricks;
  StiffnessRange m_range;
  std::vector<GrowingClusters> m_levels;
  std::vector<Clusters> m_found;
};

}  // namespace supple
