// Offsets that carry on smoothly beyond the material, for dense exports (`void extend`).
//
// Near the material the offsets are averaged ring by ring (ring_fill.h) and fade, ring by ring,
// into a coarse field: the mean offset of each block of 8^3 voxels, spread over empty blocks ring
// by ring and interpolated between block centres. Beyond the last block it is constant. Continuous
// everywhere; exactly zero where all offsets are zero. Memory: the bricks that touch the material,
// and at most 4 million blocks (they double in size until that holds).
#pragma once

#include <cstdint>
#include <vector>

#include "volumes/field/offset_field.h"

namespace supple {

class SmoothExtension {
 public:
  explicit SmoothExtension(const VectorBricks& offsets);

  /// Trilinear between voxels; defined everywhere, 0 where there are no offsets at all.
  Vec3d sample(const Vec3d& pos_index) const;
  /// Offset at a voxel.
  Vec3d at(const Vec3i& voxel) const;

 private:
  void average_blocks(const VectorBricks& offsets);
  void spread_blocks();
  Vec3d coarse(const Vec3d& pos_index) const;
  std::size_t block_index(const Vec3i& block) const;

  VectorBricks m_near;
  std::vector<std::uint8_t> m_ring;  // per voxel of m_near
  int m_block = kBrickDim;           // edge of a block in voxels
  Vec3i m_lo{0, 0, 0};               // first block
  Vec3i m_dims{0, 0, 0};             // blocks
  std::vector<Vec3d> m_mean;
  std::vector<int> m_count;  // voxels averaged, later 1 where a mean is known
};

}  // namespace supple
