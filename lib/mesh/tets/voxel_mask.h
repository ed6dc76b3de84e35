// Sets of voxels as boxes of flags, whole, per label, and their thin parts.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <vector>

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
  /// The place of a voxel of the box.
  std::size_t number(const Vec3i& voxel) const {
    const Vec3i at = voxel - box.lo, d = dims();
    return (std::size_t(at.z) * std::size_t(d.y) + std::size_t(at.y)) * std::size_t(d.x) +
           std::size_t(at.x);
  }
  /// True if a voxel of the volume belongs to the set.
  bool holds(const Vec3i& voxel) const { return box.contains(voxel) && inside[number(voxel)] != 0; }
};

/// The label of a voxel of the mask.
using VoxelLabel = std::function<std::int32_t(const Vec3i& voxel)>;

/// The active voxels in the smallest box around them.
VoxelMask mask_of(const Geometry& geometry, const BrickTopology& voxels);

/// The voxels of every label, each in the smallest box around them.
std::map<std::int32_t, VoxelMask> masks_of_labels(const VoxelMask& mask,
                                                  const VoxelLabel& label_of);

/// Voxels of parts of a label that are thinner than so many mm, but for bumps of less than a voxel.
VoxelMask thin_voxels(const VoxelMask& mask, const VoxelLabel& label_of, double thinner_mm);

/// Those of a part of the mask that are farther than so many mm from the rest of their label, and
/// what of the part is as near to these.
VoxelMask without_rims(const VoxelMask& part, const VoxelMask& mask, const VoxelLabel& label_of,
                       double rim_mm);

}  // namespace supple
