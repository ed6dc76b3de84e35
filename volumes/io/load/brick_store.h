// Bricks of densities that were kept while a volume streamed past, until it is known which of their
// voxels become active. Cost: that of slab_bricks.h.
#pragma once

#include <vector>

#include "volumes/io/load/slab_bricks.h"

namespace supple {

class BrickStore {
 public:
  void keep(SlabBrick brick) { m_bricks.push_back(std::move(brick)); }

  /// The grid of the stored voxels above the background. The store is empty afterwards.
  DensityGrid take_above(float background);

  /// The grid of the finite stored voxels that are active in `where`. The store is empty
  /// afterwards.
  DensityGrid take_grid(const BrickTopology& where, float background);

 private:
  DensityGrid take_masked(std::vector<BrickMask> masks, float background);

  std::vector<SlabBrick> m_bricks;
};

}  // namespace supple
