// Positions of the points of one grid in the index frame of another.
#pragma once

#include <cmath>

#include "volumes/geometry/geometry.h"

namespace supple {

/// Points this close to a node, in voxels of the frame, count as lying on it.
constexpr double kNodeSnap = 1e-6;

class GridPositions {
 public:
  GridPositions(const Geometry& grid, const Geometry& frame)
      : m_origin(frame.index_from_world(grid.world_from_index(Vec3d(0)))) {
    for (int a = 0; a < 3; ++a) m_step[a] = frame.index_vector_from_world(grid.axes_mm()[a]);
  }

  /// Index position in the frame of grid point (i, j, k), snapped to nodes axis by axis.
  Vec3d at(int i, int j, int k) const {
    Vec3d pos = m_origin + m_step[0] * i + m_step[1] * j + m_step[2] * k;
    for (int a = 0; a < 3; ++a) {
      const double nearest = std::round(pos[a]);
      if (std::abs(pos[a] - nearest) < kNodeSnap) pos[a] = nearest;
    }
    return pos;
  }

 private:
  Vec3d m_origin;
  Vec3d m_step[3];
};

}  // namespace supple
