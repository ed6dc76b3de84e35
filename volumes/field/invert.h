// Inversion of a displacement to an offset field: x + o(x) + u(x + o(x)) = x.
#pragma once

#include "volumes/base/progress.h"
#include "volumes/field/vector_bricks.h"

namespace supple {

struct InvertParams {
  double residual_tolerance_voxels = 1e-4;  // Newton stops at a hundredth of it
  int max_newton_steps = 20;
  /// The elements, so that folds in the air around them are counted apart; null: all is material.
  const BrickTopology* material = nullptr;
};

/// Inverts the extended displacement; u is trilinear on the cells whose eight corners are valid.
/// Deterministic and independent of the thread count; where deformed cells overlap the smallest |o|
/// wins (then the lower source voxel). Where u = 0 at all corners, o = 0 exactly. Nodes of occupied
/// output bricks that no material reaches stay invalid (the marcher extrapolates for itself).
///
/// A field without a complete cell (a single voxel, a sheet one voxel thick) gives no offsets until
/// it is extended; `certificate.cells` says so. A volume of one slice is inverted in its plane.
/// `certificate.unresolved` lists nodes inside a deformed cell's tetrahedra for which bisection
/// could show neither a solution nor its absence.
/// Throws InputError for values that are not finite or beyond 10^6 voxels and for a cell torn over
/// more than 2^24 nodes; Cancelled.
OffsetField invert(const Displacement& displacement, const InvertParams& params = {},
                   Progress* progress = nullptr);

/// Offsets at the invalid nodes of every occupied brick and of the bricks that touch it, extended
/// ring by ring from the valid ones, for trilinear look-up at the border of the material. Zero
/// offsets extend to exact zeros; 8 rings fill every occupied brick.
VectorBricks extrapolate_into_bricks(const VectorBricks& offsets, int rings);

}  // namespace supple
