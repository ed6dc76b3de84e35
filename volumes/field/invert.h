// Inversion of a displacement to an offset field: x + o(x) + u(x + o(x)) = x.
#pragma once

#include "volumes/base/progress.h"
#include "volumes/field/vector_bricks.h"

namespace supple {

struct InvertParams {
  double residual_tolerance_voxels = 1e-4;
  int max_newton_steps = 20;
};

/// Inverts the extended displacement. Deterministic and independent of the thread count; where
/// deformed cells overlap the smallest |o| wins (then the lower source voxel). Nodes of occupied
/// output bricks that no material reaches stay invalid (the marcher extrapolates for itself).
OffsetField invert(const Displacement& displacement, const InvertParams& params = {},
                   Progress* progress = nullptr);

/// Offsets at the invalid nodes of every occupied brick and of the bricks that touch it, extended
/// ring by ring from the valid ones, for trilinear look-up at the border of the material.
VectorBricks extrapolate_into_bricks(const VectorBricks& offsets, int rings);

}  // namespace supple
