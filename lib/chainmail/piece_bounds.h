// Bounds that held elements put on each element of a rigid piece by itself: between the envelopes
//   L_j = max over A (l_a - dist(a, j)),   U_j = min over B (u_b + dist(j, b))
// of drag_algebra.h, through tissue alone.
//
// The envelope of two sets of bounds is the larger (smaller) of both at every element, where the
// body is valid. A search for the poses of several pieces therefore finds once what its handles and
// all that is held ask for, and for every pose that it tries only what the other pieces do.
#pragma once

#include <array>
#include <vector>

#include "lib/body/smallest_motion.h"
#include "lib/chainmail/held_voxels.h"

namespace supple {

/// Envelopes of bounds that do not change in a search, at the elements of pieces that nothing holds
/// as a whole. All are of one body that stays as it is.
struct LastingBounds {
  LastingBounds(std::size_t handle_count_, std::int32_t least_reach_q_)
      : handle_count(handle_count_), least_reach_q(least_reach_q_) {}

  std::size_t handle_count;    // the first ones of every drag of the search; poses come after
  std::int32_t least_reach_q;  // that the search will want
  std::int32_t reach_q = -1;   // as far as the envelopes are known; -1: not at all
  SlotSet loose;               // those elements
  std::array<std::array<std::vector<std::int32_t>, 2>, 3> envelopes;  // [coordinate][raise, lower]
};

/// Finds them to that reach or further. `held`: the first handles alone, at their targets.
void find_lasting_bounds(const Body& body, const HeldVoxels& held, std::int32_t reach_q,
                         LastingBounds& lasting, Propagator& propagator, Progress* progress);

/// Does EcmSolver::bounds_of(); `held`: all handles at their targets; `lasting` is known that far.
std::vector<std::vector<ElementBounds>> bounds_of_pieces(
    const Body& body, const std::vector<const RigidPiece*>& pieces, const HeldVoxels& held,
    std::int32_t reach_q, const LastingBounds& lasting, Propagator& propagator, Progress* progress);

}  // namespace supple
