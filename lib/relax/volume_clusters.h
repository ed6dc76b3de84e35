// Rigid clusters among cells that keep their volume: a cluster moves as one, and so changes the
// volume of the cells that only some of its elements span.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lib/body/body.h"
#include "lib/body/region.h"
#include "lib/body/slot_set.h"
#include "lib/relax/cell_moduli.h"
#include "lib/relax/movable.h"

namespace supple {

/// The clusters of one coordinate.
class VolumeClusters {
 public:
  /// `weight`: moduli.kpa * rest volume / spacing^2 of the coordinate, N/m.
  VolumeClusters(const Body& body, int coordinate, const Movable& elements, const Holds& held,
                 const CellModuli& moduli, double weight);

  /// Every cluster near a brick that is `due` steps, one after the other, each to where its links
  /// and cells balance (times `relaxation`), no further than limits and bounds allow. Marks the
  /// bricks of those that did; returns the largest step, 2^-32 voxel.
  double step(std::array<BrickArray<double>, 3>& offsets, double relaxation,
              const std::vector<char>& due, std::vector<char>& changed) const;
  std::size_t bytes() const;

 private:
  struct PartCell {
    std::array<Slot, 8> corners;
    float share;           // share_of_cell()
    std::uint8_t members;  // bit per corner
  };
  void find_cells_of_clusters(const CellModuli& moduli);
  bool is_due(std::size_t cluster, const std::vector<char>& due) const;
  double step_of(std::size_t cluster, const std::array<BrickArray<double>, 3>& offsets,
                 double relaxation) const;

  const Body& m_body;
  const Movable& m_elements;
  const std::vector<Bound>& m_at_least;
  const std::vector<Bound>& m_at_most;
  std::size_t m_coordinate;
  double m_weight;
  std::vector<PartCell> m_cells;            // by cluster
  std::vector<std::uint32_t> m_first_cell;  // of each cluster; one more at the end
  std::vector<std::uint32_t> m_bricks;      // by cluster: where its own and its links' elements lie
  std::vector<std::uint32_t> m_first_brick;  // of each cluster; one more at the end
};

}  // namespace supple
