// One coordinate of a drag: targets, envelopes, conflicts and the part that anchors allow.
//
// With T the targets of the handles and dist(a, b) the shortest path on static slack, the targets
// are feasible iff T_a - T_b <= dist(a, b) for all ordered pairs (design.md section 3). Then
//   L_j = max_a (T_a - dist(a, j)),   U_j = min_a (T_a + dist(j, a)),   q_j <- median(L, q, U),
// where L is only needed above q and U only below. Conflicts show in the same runs: an anchor that
// moved, or a handle that ends below its target.
#pragma once

#include <cstdint>

#include "lib/chainmail/held_voxels.h"
#include "lib/chainmail/propagate.h"

namespace supple {

/// A part of the whole, 0…1, reduced.
struct Fraction {
  std::int64_t numerator = 1;
  std::int64_t denominator = 1;

  bool is_whole() const { return numerator == denominator; }
  /// The smaller of both; the parts of each are below 2^31.
  void limit_to(std::int64_t other_numerator, std::int64_t other_denominator);
  /// `value` times the fraction, truncated toward zero.
  std::int32_t scale(std::int32_t value) const;
};

class CoordinateDrag {
 public:
  /// Gives the coordinate its array if it never moved; the destructor rolls back unless commit()
  /// was called.
  CoordinateDrag(Body& body, int coordinate, const HeldVoxels& held, Progress* progress);
  ~CoordinateDrag();
  CoordinateDrag(const CoordinateDrag&) = delete;
  CoordinateDrag& operator=(const CoordinateDrag&) = delete;

  /// Moves the handles by the whole and tightens `fraction` by what the anchors allow. Throws
  /// InputError when handles contradict each other, whatever the anchors say.
  void try_whole(Fraction& fraction);
  /// Starts over and moves the handles by that part.
  void redo(const Fraction& fraction);
  /// Keeps the result.
  void commit();

  const UndoLog& undo() const { return m_undo; }
  const std::vector<std::int32_t>& values() const { return m_values; }
  const Propagator& propagator() const { return m_propagator; }

 private:
  void set_targets(const Fraction& fraction);
  void solve(bool& pulled_up, bool& pushed_down);
  bool anchors_moved(Direction direction) const;
  void limit_by_anchors(Direction direction, Fraction& fraction);
  void require_agreement();
  [[noreturn]] void report_conflict(std::size_t handle_above, std::int64_t missing);

  Body& m_body;
  const int m_coordinate;
  const HeldVoxels& m_held;
  std::vector<std::int32_t>& m_values;
  const bool m_was_empty;
  bool m_committed = false;
  std::vector<std::int32_t> m_start;    // value of each handle before the drag
  std::vector<std::int32_t> m_targets;  // and after it
  UndoLog m_undo;
  Propagator m_propagator;
};

}  // namespace supple
