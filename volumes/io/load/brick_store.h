// Bricks of densities that were kept while a volume streamed past, until it is known which of their
// voxels become active. Cost: that of the bricks of slabs.
#pragma once

#include <vector>

#include "volumes/grid/density_leaf.h"
#include "volumes/io/load/slab_reader.h"

namespace supple {

// The bricks of a slab, cut out by all threads. A brick is gathered into the memory in which the
// grid will hold it; one of a single density is but a note of it. Cost: 2 kB per brick of several
// densities, 112 bytes for all others.

struct SlabBrick {
  Vec3i origin{0, 0, 0};
  Vec3i extent{0, 0, 0};  // voxels inside the volume per axis; 0: none of them is finite
  float constant = 0;     // all over the extent where there is no leaf
  DensityLeaf leaf;       // NaN outside the volume

  bool is_void() const { return extent.x == 0; }
  /// True where all voxels inside the volume have the density, down to the sign of a zero.
  bool is_all(float density) const;
  /// The voxels inside the volume whose density is within [lo, hi]; a NaN never is.
  BrickMask within(double lo, double hi) const;
  /// The voxels inside the volume whose density is above the threshold; a NaN never is.
  BrickMask above(float threshold) const;
  /// Notes extremes in the leaf, if there is one (density_leaf.h).
  void note_extremes(const BrickMask& active) {
    if (leaf) leaf.note_extremes(active);
  }
  /// Takes the leaf, made where there was none; the brick is left without it.
  DensityLeaf take_leaf();
};

/// A brick of one density in a volume of these dimensions.
SlabBrick constant_brick(const Vec3i& origin, const Vec3i& dims, float density);

/// All bricks of the slab, those along i next to each other.
std::vector<SlabBrick> bricks_of(const Slab& slab);

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
