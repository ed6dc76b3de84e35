// One coordinate of a drag: targets, envelopes, conflicts and the part that anchors allow.
//
// Let A be the elements with a lower bound l_a, B those with an upper bound u_b, and dist(a, b) the
// shortest path on static slack: q_a - q_b <= dist(a, b) in every valid configuration. The bounds
// can be met iff l_a - u_b <= dist(a, b) for all a in A, b in B (design.md section 3). Then
//   L_j = max over A (l_a - dist(a, j)),   U_j = min over B (u_b + dist(j, b)),
// L <= U by the triangle inequality, and q_j <- median(L, q, U) is valid, meets every bound and
// moves least. L is only needed above q and U only below. Who bounds what, with D the displacement
// of a handle, f the fraction of the drag and q the offsets before it:
//   two-sided handle     in A and B   l = u = q + f D
//   push handle          in A or B    l = t + f D or u = t + f D
//   anchor, held voxel   in A and B   l = u = q
//   held push            in A or B    l = t or u = t
// A push handle is a tool at the place t: on elements that it does not hold yet t = q, and it is in
// A when D > 0, in B when D < 0, in neither when D = 0; later it stays on its side, t <= q in A and
// t >= q in B, so that withdrawing it moves nothing.
// Handles must agree at f = 1. Two push handles of one direction always do, as A meets no B.
// At f = 0 the bounds are met, so what is held only limits f: for a handle a in A that rises and a
// held upper bound b, f D_a <= dist(a, b) - (l_a - u_b), l_a before the drag; and mirrored for
// sinking handles. Truncating
// the targets toward zero keeps them feasible: trunc(f D_a) - trunc(f D_b) <= max(0, D_a - D_b)
// where both fit at f = 1, and it only shortens moves against what is held.
//
// Conflicts show in the same runs: a held element above its upper bound after the raise, below its
// lower bound after the lowering, or a handle that ends below its lower bound.
#pragma once

#include <cstdint>

#include "lib/chainmail/fraction.h"
#include "lib/chainmail/held_voxels.h"
#include "lib/chainmail/propagate.h"

namespace supple {

class CoordinateDrag {
 public:
  /// Gives the coordinate its table of bricks if it never moved; the destructor rolls back unless
  /// commit() was called.
  /// `undo` must be empty.
  CoordinateDrag(Body& body, int coordinate, const HeldVoxels& held, Propagator& propagator,
                 UndoLog& undo, Progress* progress);
  ~CoordinateDrag();
  CoordinateDrag(const CoordinateDrag&) = delete;
  CoordinateDrag& operator=(const CoordinateDrag&) = delete;

  /// Moves the handles by the whole and tightens `fraction` by what is held. Throws InputError when
  /// handles contradict each other, whatever the anchors say.
  void try_whole(Fraction& fraction);
  /// Starts over and moves the handles by that part.
  void redo(const Fraction& fraction);
  /// Keeps the result.
  void commit();

  const UndoLog& undo() const { return m_undo; }
  const BrickValues& values() const { return m_values; }
  const PropagationCounts& counts() const { return m_counts; }

 private:
  /// How far held elements were moved beyond their bounds, upwards and downwards.
  struct Excess {
    std::int64_t up = 0, down = 0;
  };
  struct Target {
    const HeldHandle* handle;
    Slot slot;
    std::int32_t value;
  };

  void propagate(Direction direction, const std::vector<Seed>& seeds);
  Excess solve();
  std::vector<Seed> seeds(Direction direction) const;
  const std::vector<Bound>& held_bounds(Direction direction) const;
  std::int64_t excess_of_held(Direction direction) const;
  void limit_by_held(Direction direction, std::int64_t excess, Fraction& fraction);
  void require_agreement();
  [[noreturn]] void report_conflict(const Target& above, std::int64_t missing);
  [[noreturn]] void throw_conflict(const Target& above, const Target& below,
                                   std::int64_t missing) const;

  /// Calls `visit(slot, target, present)` for the elements that a handle keeps from sinking below
  /// their target (raise) or from rising above it (lower).
  template <class Visit>
  void for_each_target(const HeldHandle& handle, Direction direction, Visit&& visit) const;

  /// Calls `visit(slot, limit)` for what is held in a brick and may not rise above its limit
  /// (raise) or sink below it (lower).
  template <class Visit>
  void for_each_held(std::size_t brick, Direction direction, Visit&& visit) const;

  Body& m_body;
  const int m_coordinate;
  const HeldVoxels& m_held;
  BrickValues& m_values;
  bool m_committed = false;
  Fraction m_fraction;  // of the targets
  UndoLog& m_undo;
  Propagator& m_propagator;
  Progress* m_progress;
  PropagationCounts m_counts;
};

}  // namespace supple
