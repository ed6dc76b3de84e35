// The nodes of a deformed haze as its rays read them: densities of the source, ways of its elements
// and packed offsets, kept up to date where elements went on or are gone.
//
// Ways below half of 1/32 voxel change nothing. What did change marks the nodes around its old and
// its new place, and only these are solved anew: no inversion, and no certificate of one.
#pragma once

#include <vector>

#include "raycast/microscope/deformed_haze.h"
#include "raycast/microscope/haze_lanes.h"
#include "volumes/grid/density_grid.h"

namespace supple {

class HazeNodes {
 public:
  HazeNodes() = default;
  /// At rest; `largest` density is 255.
  HazeNodes(const Vec3i& dims, const DensityGrid& density, double largest);

  void follow(const std::vector<HazeElements>& bricks);
  const HazeTables& tables() const { return m_tables; }

 private:
  struct Change {
    std::uint32_t node, before, now;  // of the source; packed ways
  };
  std::vector<Change> changes_of(const HazeElements& brick) const;
  void mark_around(std::uint32_t node, std::uint32_t way, bool starts_there);
  void find_kind(std::size_t brick);
  void set_density(const Vec3i& voxel, std::uint32_t density);
  Vec3i voxel_at(std::uint32_t node) const;

  HazeTables m_tables;
  std::vector<std::uint8_t> m_is_marked;  // per node
  std::vector<std::uint32_t> m_marked;    // nodes
};

}  // namespace supple
