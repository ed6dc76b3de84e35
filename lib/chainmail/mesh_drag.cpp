#include "lib/chainmail/mesh_drag.h"

#include <algorithm>
#include <string>

#include "volumes/base/error.h"
#include "volumes/state/state.h"

namespace supple {

MeshDrag::MeshDrag(MeshValues& values, const HeldNodes& held, Progress* progress)
    : m_values(values), m_progress(progress) {
  for (std::size_t h = 0; h < held.handles.size(); ++h) {
    const HeldNodes::Handle& handle = held.handles[h];
    const std::int32_t by = handle.by[std::size_t(values.coordinate())];
    for (const Slot node : handle.nodes) {
      const Bound bound{node, values.value(node), by, h};
      if (!handle.is_push || by > 0) m_lower.push_back(bound);
      if (!handle.is_push || by < 0) m_upper.push_back(bound);
    }
  }
  m_anchors.reserve(held.fixed.size());
  for (const Slot node : held.fixed) m_anchors.push_back({node, values.value(node)});
}

MeshDrag::~MeshDrag() {
  if (!m_committed) m_values.roll_back();
}

void MeshDrag::try_whole(Fraction& fraction) {
  solve();
  require_agreement();
  const std::int64_t up = m_excess_up, down = m_excess_down;
  if (up > 0) limit_by_anchors(Direction::raise, up, fraction);
  if (down > 0) limit_by_anchors(Direction::lower, down, fraction);
}

void MeshDrag::redo(const Fraction& fraction) {
  m_values.roll_back();
  m_fraction = fraction;
  solve();
  require_agreement();
  if (m_excess_up > 0 || m_excess_down > 0) {
    throw Error("ECM: an anchor moved after the drag was shortened");
  }
}

void MeshDrag::propagate(Direction direction, const std::vector<Seed>& seeds) {
  const PropagationCounts counts = m_values.run(direction, seeds, m_progress);
  m_counts.visits += counts.visits;
  m_counts.max_queue = std::max(m_counts.max_queue, counts.max_queue);
}

/// median(L, q, U): up to L from the lower bounds, then down to U from the upper ones.
void MeshDrag::solve() {
  for (const Direction direction : {Direction::raise, Direction::lower}) {
    std::vector<Seed> seeds;
    for (const Bound& bound : bounds(direction)) {
      const std::int32_t wanted = target(bound), present = m_values.value(bound.node);
      if (direction == Direction::raise ? wanted > present : wanted < present) {
        seeds.push_back({bound.node, wanted});
      }
    }
    propagate(direction, seeds);
    (direction == Direction::raise ? m_excess_up : m_excess_down) = excess_of_anchors(direction);
  }
}

std::int64_t MeshDrag::excess_of_anchors(Direction direction) const {
  const std::int64_t sign = direction == Direction::raise ? 1 : -1;
  std::int64_t excess = 0;
  for (const Anchor& anchor : m_anchors) {
    excess = std::max(excess, sign * (std::int64_t(m_values.value(anchor.node)) - anchor.at));
  }
  return excess;
}

/// The smallest (dist(a, b) - (q_a - q_b)) / D_a over handles a that rise (D_a > 0) and anchors b.
/// When all rise by the same D, the excess of the whole drag is D minus the smallest numerator.
/// Otherwise one run serves all pairs: anchors pulled down to q_b - max D_a lower a handle by
/// max D_a minus its smallest numerator, unless that is negative. Sinking handles: mirrored.
void MeshDrag::limit_by_anchors(Direction direction, std::int64_t excess, Fraction& fraction) {
  const int sign = direction == Direction::raise ? 1 : -1;
  std::int32_t furthest = 0, nearest = INT32_MAX;
  for (const Bound& bound : bounds(direction)) {
    if (sign * bound.by <= 0) continue;
    furthest = std::max(furthest, sign * bound.by);
    nearest = std::min(nearest, sign * bound.by);
  }
  if (nearest == furthest) return fraction.limit_to(furthest - excess, furthest);

  m_values.roll_back();
  std::vector<Seed> seeds;
  for (const Anchor& anchor : m_anchors) {
    seeds.push_back({anchor.node, anchor.at - sign * furthest});
  }
  propagate(sign > 0 ? Direction::lower : Direction::raise, seeds);
  for (const Bound& bound : bounds(direction)) {
    if (sign * bound.by <= 0) continue;
    const std::int64_t followed = sign * (std::int64_t(bound.at) - m_values.value(bound.node));
    fraction.limit_to(furthest - followed, sign * bound.by);
  }
}

/// Every conflict between handles leaves the upper one of a pair below its lower bound: U of the
/// other one reaches it, since the configuration before the lowering is valid.
void MeshDrag::require_agreement() {
  std::int64_t worst = 0;
  const Bound* above = nullptr;
  for (const Bound& bound : m_lower) {
    const std::int64_t missing = std::int64_t(target(bound)) - m_values.value(bound.node);
    if (missing <= worst) continue;
    worst = missing;
    above = &bound;
  }
  if (above != nullptr) report_conflict(*above, worst);
}

/// Raising the upper node alone from the present (valid, low) configuration lifts its partner above
/// the partner's upper bound by the same missing distance.
void MeshDrag::report_conflict(const Bound& above, std::int64_t missing) {
  propagate(Direction::raise, {{above.node, target(above)}});
  const Bound* below = &above;
  for (const Bound& bound : m_upper) {
    if (bound.node == above.node) continue;
    if (std::int64_t(m_values.value(bound.node)) - target(bound) >= missing) {
      below = &bound;
      break;
    }
  }
  throw InputError(
      {"", "handles " + std::to_string(above.handle) + " and " + std::to_string(below->handle),
       "targets " + number_text(double(missing) / kFixedOne) + " mm further apart along " +
           "xyz"[m_values.coordinate()] + " than the links between nodes " +
           std::to_string(above.node) + " and " + std::to_string(below->node) + " allow",
       "handles that agree with each other"});
}

}  // namespace supple
