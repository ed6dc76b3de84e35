// Bricks of densities that were kept while a volume streamed past, until it is known which of their
// voxels become active. Cost: 2 kB per brick, 48 bytes for one that holds a single density.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "volumes/grid/density_grid.h"
#include "volumes/io/slab_reader.h"

namespace supple {

class BrickStore {
 public:
  /// Keeps the bricks of the slab that are wanted, but those without a finite voxel.
  void add(const Slab& slab, const std::function<bool(int bi, int bj)>& wants);

  /// Finite voxels above `threshold`, as a topology.
  BrickTopology above(float threshold) const;

  /// The grid of the finite stored voxels that are active in `where`. The store is empty
  /// afterwards: each brick is freed as soon as the grid has it.
  DensityGrid take_grid(const BrickTopology& where, float background);

 private:
  struct Brick {
    Vec3i origin;
    Vec3i extent{0, 0, 0};  // voxels inside the volume per axis
    float constant = 0;
    std::unique_ptr<float[]> values;  // null: `constant` all over the extent

    void copy_to(float* out) const;
    template <class Holds>
    BrickMask mask_where(const Holds& holds) const;
  };

  static Brick brick_of(const Slab& slab, int bi, int bj);

  std::vector<Brick> m_bricks;
};

}  // namespace supple
