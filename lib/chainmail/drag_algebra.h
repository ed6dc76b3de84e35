// One coordinate of a drag of voxels or of mesh nodes: targets, envelopes, conflicts and the part
// that anchors allow.
//
// Let A be the elements with a lower bound l_a, B those with an upper bound u_b, and dist(a, b) the
// shortest path on static slack: q_a - q_b <= dist(a, b) in every valid configuration. The bounds
// can be met iff l_a - u_b <= dist(a, b) for all a in A, b in B (design.md section 3). Then
//   L_j = max over A (l_a - dist(a, j)),   U_j = min over B (u_b + dist(j, b)),
// L <= U by the triangle inequality, and q_j <- median(L, q, U) is valid, meets every bound and
// moves least. L is only needed above q and U only below. The bounds of each kind of element
// follow, with D the displacement of an element of a handle, f the fraction of the drag and q the
// offsets before it:
//   two-sided handle     in A and B   l = u = q + f D
//   push handle          in A or B    l = t + f D or u = t + f D
//   anchor, held voxel   in A and B   l = u = q
//   held push            in A or B    l = t or u = t
// A push handle is a tool at the place t: on elements that it does not hold yet t = q, and it is in
// A when D > 0, in B when D < 0, in neither when D = 0; later it stays on its side, t <= q in A and
// t >= q in B, so that withdrawing it moves nothing. Handles must agree at f = 1. Two push handles
// of one direction always do, as A meets no B.
// At f = 0 the bounds are met, so held elements only limit f: for a handle a in A that rises and a
// held upper bound b, f D_a <= dist(a, b) - (l_a - u_b), l_a before the drag; and mirrored for
// sinking handles. Truncating the targets toward zero keeps them feasible: trunc(f D_a) - trunc(f
// D_b) <= max(0, D_a - D_b) where both fit at f = 1, and it only shortens moves against held
// elements.
//
// Conflicts show in the same runs: a held element above its upper bound after the raise, below its
// lower bound after the lowering, or a handle that ends below its lower bound.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "lib/chainmail/fraction.h"
#include "lib/chainmail/propagate.h"
#include "volumes/base/error.h"

namespace supple {

/// `Drag` derives from it and knows where elements are, who holds them, and how to propagate:
///   std::size_t handle_count() const
///   void for_each_target(handle, direction, visit)     visit(slot, target, present, by) for
///       elements that the handle keeps from sinking below their target (raise) or rising above it
///       (lower); by is the element's displacement D, target its place after scaled(by)
///   std::int64_t excess_of_held(direction)             how far held elements are beyond bounds
///   std::vector<Seed> pulled_back(direction, shift)    rolls back; held upper bounds (raise) or
///       lower ones (lower), shifted; those that the run before did not reach may be left out
///   void propagate(direction, seeds), void roll_back()
///   [[noreturn]] void throw_conflict(above, below, missing)
///   bool is_edge(handle) const                         of a soft handle: its displacements are
///       shortened to the part that anchors allow
///   bool let_edges_yield(direction, furthest)          after pulled_back() by `furthest` was
///       propagated: cuts displacements of edges down to their room; whether any was
template <class Drag>
class DragAlgebra {
 public:
  /// Moves the handles by the whole and tightens `fraction` by the elements that are held. Throws
  /// InputError when handles contradict each other, whatever the anchors say.
  void try_whole(Fraction& fraction);

  /// True where try_whole() cut displacements of edges, so that redo() must follow.
  bool edges_yielded() const { return m_edges_yielded; }

  /// Starts over and moves the handles by that part.
  void redo(const Fraction& fraction);

 protected:
  /// An element that a handle takes to a place.
  struct Target {
    std::size_t handle;
    Slot slot;
    std::int32_t value;
  };

  /// The part of a displacement that is performed.
  std::int32_t scaled(std::int32_t by) const { return m_fraction.scale(by); }

 private:
  /// How far held elements were moved beyond their bounds, upwards and downwards.
  struct Excess {
    std::int64_t up = 0, down = 0;
  };

  Drag& drag() { return static_cast<Drag&>(*this); }
  const Drag& drag() const { return static_cast<const Drag&>(*this); }

  /// median(L, q, U): up to L from the lower bounds, then down to U from the upper ones.
  Excess solve() {
    Excess excess;
    drag().propagate(Direction::raise, seeds(Direction::raise));
    excess.up = drag().excess_of_held(Direction::raise);
    drag().propagate(Direction::lower, seeds(Direction::lower));
    excess.down = drag().excess_of_held(Direction::lower);
    return excess;
  }

  /// The elements that a handle takes beyond their present place.
  std::vector<Seed> seeds(Direction direction) const {
    std::vector<Seed> seeds;
    for (std::size_t h = 0; h < drag().handle_count(); ++h) {
      drag().for_each_target(
          h, direction, [&](Slot slot, std::int32_t target, std::int32_t present, std::int32_t) {
            if (direction == Direction::raise ? target > present : target < present) {
              seeds.push_back({slot, target});
            }
          });
    }
    return seeds;
  }

  /// Limits `fraction` to the smallest (dist(a, b) - (q_a - u_b)) / D_a over elements a of handles
  /// that rise (D_a > 0) and held upper bounds b. When all rise by the same D, the excess of the
  /// whole drag is D minus the smallest numerator. Otherwise one run serves all pairs: held
  /// elements pulled down to u_b - max D_a lower an element by max D_a minus its smallest
  /// numerator, unless that is negative. Elements that the whole drag did not reach limit nothing.
  /// Sinking handles: mirrored. Elements of edges limit nothing either: each by itself goes no
  /// further than its numerator.
  void limit_by_held(Direction direction, std::int64_t excess, Fraction& fraction) {
    const int sign = direction == Direction::raise ? 1 : -1;
    std::int32_t furthest = 0, nearest = INT32_MAX;
    bool has_edges = false;
    for (std::size_t h = 0; h < drag().handle_count(); ++h) has_edges |= drag().is_edge(h);
    const auto for_each_rising = [&](bool with_edges, auto&& visit) {
      for (std::size_t h = 0; h < drag().handle_count(); ++h) {
        if (!with_edges && drag().is_edge(h)) continue;
        drag().for_each_target(
            h, direction, [&](Slot, std::int32_t target, std::int32_t present, std::int32_t by) {
              if (sign * by > 0) visit(target, present, sign * by);
            });
      }
    };
    for_each_rising(true, [&](std::int32_t, std::int32_t, std::int32_t by) {
      furthest = std::max(furthest, by);
      nearest = std::min(nearest, by);
    });
    if (nearest == furthest && !has_edges) return fraction.limit_to(furthest - excess, furthest);

    const std::vector<Seed> pulled = drag().pulled_back(direction, sign * furthest);
    drag().propagate(sign > 0 ? Direction::lower : Direction::raise, pulled);
    if (has_edges && drag().let_edges_yield(direction, furthest)) m_edges_yielded = true;
    for_each_rising(false, [&](std::int32_t target, std::int32_t present, std::int32_t by) {
      // sign * (target - present) = by + how far the element followed.
      const std::int64_t room = furthest + by - sign * (std::int64_t(target) - present);
      if (room < by) fraction.limit_to(room, by);
    });
  }

  /// Throws where handles conflict, which leaves the upper one of a pair below its lower bound: U
  /// of the other one reaches it, since the configuration before the lowering is valid.
  void require_agreement() {
    std::int64_t worst = 0;
    Target above{};
    for (std::size_t h = 0; h < drag().handle_count(); ++h) {
      drag().for_each_target(
          h, Direction::raise,
          [&](Slot slot, std::int32_t target, std::int32_t present, std::int32_t) {
            const std::int64_t missing = std::int64_t(target) - present;
            if (missing <= worst) return;
            worst = missing;
            above = {h, slot, target};
          });
    }
    if (worst > 0) report_conflict(above, worst);
  }

  /// Raising the upper element alone from the present (valid, low) configuration lifts its partner
  /// above the partner's upper bound by the same missing distance.
  [[noreturn]] void report_conflict(const Target& above, std::int64_t missing) {
    drag().propagate(Direction::raise, {{above.slot, above.value}});
    Target below = above;
    for (std::size_t h = 0; h < drag().handle_count(); ++h) {
      drag().for_each_target(
          h, Direction::lower,
          [&](Slot slot, std::int32_t target, std::int32_t present, std::int32_t) {
            if (below.slot != above.slot || slot == above.slot) return;
            if (present - std::int64_t(target) >= missing) below = {h, slot, target};
          });
    }
    drag().throw_conflict(above, below, missing);
  }

  Fraction m_fraction;  // of the targets
  bool m_edges_yielded = false;
};

// Not inline: instantiated where for_each_target is, in the source of each drag.
template <class Drag>
void DragAlgebra<Drag>::try_whole(Fraction& fraction) {
  const Excess excess = solve();
  require_agreement();
  if (excess.up > 0) limit_by_held(Direction::raise, excess.up, fraction);
  if (excess.down > 0) limit_by_held(Direction::lower, excess.down, fraction);
}

template <class Drag>
void DragAlgebra<Drag>::redo(const Fraction& fraction) {
  drag().roll_back();
  m_fraction = fraction;
  const Excess excess = solve();
  require_agreement();
  if (excess.up > 0 || excess.down > 0) {
    throw Error("ECM: something held moved after the drag was shortened");
  }
}

}  // namespace supple
