// The nodes of a deformed haze as its rays read them: densities of the source and packed offsets,
// kept up to date brick by brick.
#pragma once

#include <vector>

#include "raycast/microscope/haze_lanes.h"
#include "volumes/field/offset_field.h"
#include "volumes/grid/density_grid.h"

namespace supple {

class HazeNodes {
 public:
  HazeNodes() = default;
  /// At rest; `largest` density is 255.
  HazeNodes(const Vec3i& dims, const DensityGrid& density, double largest);

  /// Takes over the offsets in the bricks at these origins.
  void follow(const std::vector<Vec3i>& origins, const VectorBrickFinder& offsets);
  void remove(const std::vector<Vec3i>& voxels);
  const HazeTables& tables() const { return m_tables; }

 private:
  struct Range {
    Vec3i lo, hi;  // hi is beyond
  };
  Range nodes_of(const Vec3i& origin) const;
  void take_offsets(const Vec3i& origin, const VectorBrickView& view);
  void extend_offsets(const Vec3i& origin);
  void find_kind(const Vec3i& origin);
  std::uint32_t mean_around(const Vec3i& node) const;
  void set_density(const Vec3i& voxel, std::uint32_t density);

  HazeTables m_tables;
};

}  // namespace supple
