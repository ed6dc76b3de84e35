// The present place of the tissue of a state. Pictures, slices and exports find its sources by the
// inverse, or each sample by itself.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "lib/state/state.h"
#include "volumes/base/progress.h"

namespace supple {

class RingOrder;

/// Extended displacement and its inverse, which renderer and exports read.
struct Pose {
  Displacement displacement;
  OffsetField offsets;
};

/// The inverse of a state's extended displacement; warns of folded cells and unresolved voxels.
/// `wants`: the bricks in which offsets are wanted (InvertParams); of a body with cuts all are.
OffsetField invert_displacement(const State& state, const Displacement& extended,
                                Progress* progress = nullptr,
                                const std::function<bool(const Vec3i& origin)>& wants = {});
/// Returns the extended displacement and its inverse.
Pose invert_state(const State& state, Progress* progress = nullptr);

/// u on the elements alone, without the air around them; null: at rest.
Displacement on_elements(const Geometry& geometry, const BrickTopology& elements,
                         const Displacement* displacement);

/// True if a cut of the body has opened, so that the displacement jumps: samples cannot solve for
/// themselves then.
bool has_open_cuts(const State& state, const Displacement& extended);

/// The extended displacement of a body that is being dragged: kept, and brought up to date where
/// the offsets changed, with the bits that extended_displacement_of() would give. Cost of an
/// update: one comparison per voxel of the bricks that ever moved, and 100 ns per voxel of the
/// shell around the changed ones. Memory: 12 bytes per voxel of the bricks.
class LiveDisplacement {
 public:
  /// Begins at rest. `shell`: elements and shell, such as the voxels of State::density.
  LiveDisplacement(const Geometry& geometry, const BrickTopology& elements,
                   const BrickTopology& shell);
  ~LiveDisplacement();

  /// Takes over q, on the bricks of the elements as in State; returns, ascending, the bricks of
  /// displacement() in which a vector changed.
  std::vector<std::int32_t> update(const std::array<BrickValues, 3>& q);

  const Displacement& displacement() const { return m_extended; }

 private:
  bool take_over(const std::array<BrickValues, 3>& q, std::size_t b);

  BrickTopology m_elements;
  Displacement m_extended;
  std::unique_ptr<RingOrder> m_order;    // of the shell
  std::vector<std::int32_t> m_brick_of;  // of the displacement, per brick of the elements
  std::vector<std::uint8_t> m_is_moved;  // per brick of the elements
};

}  // namespace supple
