// The voxels of a block for which something holds.
#pragma once

#include <vector>

#include "volumes/base/parallel.h"
#include "volumes/grid/brick_topology.h"

namespace supple::tools {

/// Voxels 0 … size - 1; `is_active` is called from many threads.
template <class IsActive>
BrickTopology block_topology(const Vec3i& size, IsActive&& is_active) {
  std::vector<Vec3i> origins;
  for (int i = 0; i < size.x; i += kBrickDim) {
    for (int j = 0; j < size.y; j += kBrickDim) {
      for (int k = 0; k < size.z; k += kBrickDim) origins.emplace_back(i, j, k);
    }
  }
  std::vector<BrickMask> masks(origins.size(), BrickMask{});
  parallel_for(origins.size(), [&](std::size_t b) {
    for (int offset = 0; offset < kBrickVoxels; ++offset) {
      const Vec3i voxel = origins[b] + brick_local(offset);
      const bool inside = voxel.x < size.x && voxel.y < size.y && voxel.z < size.z;
      if (inside && is_active(voxel)) mask_set(masks[b], offset);
    }
  });
  return {std::move(origins), std::move(masks)};
}

}  // namespace supple::tools
