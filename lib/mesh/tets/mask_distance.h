// Signed distance to the surface of a set of voxels, smoothed so that steps of voxels do not show.
//
// The distance of a voxel centre is that to the nearest centre of the other side, less half a
// voxel, and ends at a few voxels. It is smoothed by a Gaussian G as 2 G - G G, which leaves round
// surfaces where they are: G alone draws a sphere of radius R in by sigma^2 / R. Voxel centres stay
// on their side. Parts and gaps of fewer than three voxels across are not smoothed at all, since
// they would shrink.
// Source: A. Meijster et al., A general algorithm for computing distance transforms in linear time,
// 2000 (separable minima, here within the few voxels); J. W. Tukey, Exploratory data analysis, 1977
// (twicing). Cost: 8 bytes and some 15 ns of one core per voxel of the set's box.
#pragma once

#include <cstdint>
#include <vector>

#include "volumes/base/progress.h"
#include "volumes/geometry/geometry.h"
#include "volumes/grid/brick_topology.h"

namespace supple {

/// Voxels of a box, i fastest; none beyond the box belongs to the set.
struct VoxelMask {
  Geometry geometry;  // of the volume
  IndexBox box;
  std::vector<std::uint8_t> inside;  // 1: belongs to the set

  Vec3i dims() const { return box.hi - box.lo + Vec3i(1); }
  std::int64_t count() const;
  double volume_mm3() const;
  /// True if a voxel of the volume belongs to the set.
  bool holds(const Vec3i& voxel) const {
    if (!box.contains(voxel)) return false;
    const Vec3i at = voxel - box.lo, d = dims();
    const std::size_t row = std::size_t(at.z) * std::size_t(d.y) + std::size_t(at.y);
    return inside[row * std::size_t(d.x) + std::size_t(at.x)] != 0;
  }
};

/// The active voxels in the smallest box around them.
VoxelMask mask_of(const Geometry& geometry, const BrickTopology& voxels);

class MaskDistance {
 public:
  /// `sigma_voxels`: standard deviation of the Gaussian along every axis; 0: not smoothed.
  MaskDistance(const VoxelMask& mask, double sigma_voxels, Progress* progress = nullptr);

  /// Distance in mm at a place of the volume's grid, trilinear: negative inside, positive outside,
  /// and at most some four voxels.
  double at(const Vec3d& index) const;

  /// Moves the surface outwards, where it is negative inwards, by half a voxel in all at most.
  void move_surface(double outwards_mm);
  double outwards_mm() const { return m_outwards; }

 private:
  void find_distances(const VoxelMask& mask, const Vec3d& spacing_mm);
  void smooth(double sigma_voxels, double least_mm);

  Vec3i m_lo{0, 0, 0}, m_dims{0, 0, 0};  // of the box and a margin around it
  double m_reach = 0;
  double m_outwards = 0, m_most_outwards = 0;
  std::vector<float> m_values;
};

}  // namespace supple
