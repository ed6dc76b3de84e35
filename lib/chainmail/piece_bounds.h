// Bounds that held elements put on each element of a rigid piece by itself: between the envelopes
//   L_j = max over A (l_a - dist(a, j)),   U_j = min over B (u_b + dist(j, b))
// of drag_algebra.h, through tissue alone.
#pragma once

#include <vector>

#include "lib/body/smallest_motion.h"
#include "lib/chainmail/held_voxels.h"

namespace supple {

/// EcmSolver::bounds_of(): `held` with its handles at their targets.
std::vector<std::vector<ElementBounds>> bounds_of_pieces(
    const Body& body, const std::vector<const RigidPiece*>& pieces, const HeldVoxels& held,
    std::int32_t reach_q, Propagator& propagator, Progress* progress);

}  // namespace supple
