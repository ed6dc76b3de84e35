// Rigid solid of voxels, such as the bone of a scan: signed distances at the voxels' centres,
// trilinear between. Exact distances are those of the nearest centre of the other side, less half a
// voxel [Felzenszwalb, Huttenlocher, Distance Transforms of Sampled Functions, Theory of Computing
// 8, 2012].
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "lib/instruments/round_cone.h"
#include "volumes/geometry/geometry.h"

namespace supple {

class VoxelSolid {
 public:
  /// Takes voxels of a grid whose axes are perpendicular to each other; there must be one. Cost:
  /// 0.1 us and 4 bytes per voxel of the box around them.
  VoxelSolid(const Geometry& geometry, const std::vector<Vec3i>& voxels);

  /// Finds how near a point is, negative inside; within a voxel of the voxels' faces. Beyond the
  /// box around the solid it is a lower bound.
  Approach distance_to(const Vec3d& place_mm) const;

  std::size_t bytes() const { return m_distances->size() * sizeof(float); }

 private:
  Geometry m_geometry;  // of the box
  std::shared_ptr<const std::vector<float>> m_distances;
};

}  // namespace supple
