// A sparse vector field on voxels: one Vec3f per voxel of every occupied brick, valid where the
// topology is active. Bricks without a vector other than 0, where nothing moves, are not stored.
// Cost: 6 kB per stored brick, 108 bytes for any other.
#pragma once

#include <functional>

#include "volumes/grid/brick_values.h"

namespace supple {

struct VectorBricks {
  BrickTopology topology;  // active: the vector is valid
  BrickVectors vectors;    // of its bricks

  /// True and the vector, or false where invalid.
  bool at(const Vec3i& voxel, Vec3f& vector) const;
  /// Trilinear; false when any of the corners with a weight above 0 is invalid. At a voxel centre
  /// the vector of that voxel, exactly.
  bool sample(const Vec3d& pos_index, Vec3d& vector) const;
  std::size_t bytes() const;
};

/// One brick of a sparse vector field; null where there is none.
struct VectorBrickView {
  const BrickMask* mask = nullptr;
  const Vec3f* vectors = nullptr;  // 512, those of kZeroBrickOf where none are stored
};

/// The brick with this origin, wherever it is kept. May be asked by several threads at once.
using VectorBrickFinder = std::function<VectorBrickView(const Vec3i& origin)>;

/// A finder of the bricks of a field that outlives it.
VectorBrickFinder finder_of(const VectorBricks& field);

}  // namespace supple
