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
  std::uint8_t own_in(int x, int y, int z_eighth) const;
  std::uint8_t& own_row(int x, int y, int z_eighth);
  void set_density(const Vec3i& voxel, std::uint32_t density);

  HazeTables m_tables;
  int m_eighths = 0;  // of rows along z
  /// Nodes with an offset by the inversion: bit z % 8 of byte z / 8 of the rows in x and y.
  std::vector<std::uint8_t> m_own;
};

}  // namespace supple
