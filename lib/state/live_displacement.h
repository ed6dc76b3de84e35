// The extended displacement of a body that is being dragged: kept, and brought up to date where the
// offsets changed, with the bits that extended_displacement_of() would give.
// Cost of an update: one comparison per voxel of the bricks that ever moved, and 100 ns per voxel
// of the shell around the changed ones. Memory: 12 bytes per voxel of the bricks.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "volumes/field/displacement.h"
#include "volumes/field/ring_fill.h"
#include "volumes/geometry/geometry.h"
#include "volumes/grid/brick_values.h"

namespace supple {

class LiveDisplacement {
 public:
  /// Begins at rest. `shell`: elements and shell, such as the voxels of State::density.
  LiveDisplacement(const Geometry& geometry, const BrickTopology& elements,
                   const BrickTopology& shell);

  /// Takes over q, on the bricks of the elements as in State; returns, ascending, the bricks of
  /// displacement() in which a vector changed.
  std::vector<std::int32_t> update(const std::array<BrickValues, 3>& q);

  const Displacement& displacement() const { return m_extended; }

 private:
  bool take_over(const std::array<BrickValues, 3>& q, std::size_t b);

  BrickTopology m_elements;
  Displacement m_extended;
  RingOrder m_order;                     // of the shell
  std::vector<std::int32_t> m_brick_of;  // of the displacement, per brick of the elements
  std::vector<std::uint8_t> m_is_moved;  // per brick of the elements
};

}  // namespace supple
