// Dense slices of a sparse vector field at the voxels of its own lattice. A brick keeps its vectors
// with k fastest, a slice wants i fastest: slabs of eight slices are turned at a time, so that
// every vector is read from memory once. Memory: eight slices. Cost: about 3 ns per voxel and core.
#pragma once

#include <functional>
#include <vector>

#include "volumes/field/offset_field.h"

namespace supple {

class VectorSlabs {
 public:
  /// Slices of the box of voxels `first` … `first` + `dims` - 1. Bricks whose origin `leaves_out`
  /// are invalid throughout. `field` must outlive this.
  VectorSlabs(const VectorBricks& field, const Vec3i& first, const Vec3i& dims,
              std::function<bool(const Vec3i& origin)> leaves_out);

  /// The vectors of slice k of the box, dims.x * dims.y of them, i fastest; x is NaN where the
  /// field is invalid. Valid until the next call. Cheap when asked for in order.
  const Vec3f* slice(int k);

 private:
  void turn(int slab);
  void turn_brick(const Vec3i& origin);

  const VectorBricks& m_field;
  Vec3i m_first, m_dims;
  std::function<bool(const Vec3i& origin)> m_leaves_out;
  int m_slab;                   // in bricks along k; where the box begins: none yet
  std::vector<Vec3f> m_slices;  // eight
};

}  // namespace supple
