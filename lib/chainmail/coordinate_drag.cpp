#include "lib/chainmail/coordinate_drag.h"

#include <algorithm>
#include <cstdio>
#include <numeric>

#include "volumes/base/error.h"

namespace supple {

void Fraction::limit_to(std::int64_t other_numerator, std::int64_t other_denominator) {
  if (other_numerator * denominator >= numerator * other_denominator) return;
  const std::int64_t divisor = std::gcd(other_numerator, other_denominator);
  numerator = other_numerator / divisor;
  denominator = other_denominator / divisor;
}

std::int32_t Fraction::scale(std::int32_t value) const {
  return std::int32_t(value * numerator / denominator);
}

CoordinateDrag::CoordinateDrag(Body& body, int coordinate, const HeldVoxels& held,
                               Progress* progress)
    : m_body(body),
      m_coordinate(coordinate),
      m_held(held),
      m_values(body.q[coordinate]),
      m_was_empty(body.q[coordinate].empty()),
      m_undo(body.elements.brick_count()),
      m_propagator(body, coordinate, progress) {
  if (m_was_empty) m_values.assign(slot_count(body.elements), 0);
  for (const Slot slot : held.slots) m_start.push_back(m_values[slot]);
}

CoordinateDrag::~CoordinateDrag() {
  if (m_committed) return;
  if (m_was_empty) {
    m_values = {};
  } else {
    m_undo.roll_back(m_values);
  }
}

void CoordinateDrag::commit() {
  m_committed = true;
  if (m_was_empty && m_undo.bricks().empty()) m_values = {};
}

void CoordinateDrag::try_whole(Fraction& fraction) {
  set_targets({});
  bool pulled_up = false, pushed_down = false;
  solve(pulled_up, pushed_down);
  require_agreement();
  if (pulled_up) limit_by_anchors(Direction::raise, fraction);
  if (pushed_down) limit_by_anchors(Direction::lower, fraction);
}

void CoordinateDrag::redo(const Fraction& fraction) {
  m_undo.roll_back(m_values);
  set_targets(fraction);
  bool pulled_up = false, pushed_down = false;
  solve(pulled_up, pushed_down);
  require_agreement();
  if (pulled_up || pushed_down) throw Error("ECM: an anchor moved after the drag was shortened");
}

void CoordinateDrag::set_targets(const Fraction& fraction) {
  m_targets.clear();
  for (std::size_t h = 0; h < m_start.size(); ++h) {
    m_targets.push_back(m_start[h] + fraction.scale(m_held.by_q[h][m_coordinate]));
  }
}

/// median(L, q, U): up to L from the handles that rise, then down to U from those that sink.
void CoordinateDrag::solve(bool& pulled_up, bool& pushed_down) {
  for (const Direction direction : {Direction::raise, Direction::lower}) {
    std::vector<Seed> seeds;
    for (std::size_t h = 0; h < m_targets.size(); ++h) {
      const std::int32_t present = m_values[m_held.slots[h]];
      if (direction == Direction::raise ? m_targets[h] > present : m_targets[h] < present) {
        seeds.push_back({m_held.slots[h], m_targets[h]});
      }
    }
    m_propagator.run(direction, seeds, m_values, &m_undo);
    (direction == Direction::raise ? pulled_up : pushed_down) = anchors_moved(direction);
  }
}

bool CoordinateDrag::anchors_moved(Direction direction) const {
  for (std::size_t n = 0; n < m_held.anchor_bricks.size(); ++n) {
    const std::size_t brick = m_held.anchor_bricks[n];
    const std::int32_t* before = m_undo.saved_of(brick);
    if (before == nullptr) continue;
    const std::int32_t* now = m_values.data() + brick * kBrickVoxels;
    bool moved = false;
    for_each_active(m_held.anchor_masks[n], [&](int offset) {
      moved |= direction == Direction::raise ? now[offset] > before[offset]
                                             : now[offset] < before[offset];
    });
    if (moved) return true;
  }
  return false;
}

/// The smallest (dist(a, b) - (q_a - q_b)) / D_a over handles a that rise (D_a > 0) and anchors b.
/// One run serves all pairs: anchors pulled down by D = max D_a lower a handle by
/// D - min_b (dist(a, b) - (q_a - q_b)), unless that is negative. Sinking handles: mirrored.
void CoordinateDrag::limit_by_anchors(Direction direction, Fraction& fraction) {
  const int sign = direction == Direction::raise ? 1 : -1;
  std::int32_t furthest = 0;
  for (const auto& by : m_held.by_q) furthest = std::max(furthest, sign * by[m_coordinate]);

  m_undo.roll_back(m_values);
  std::vector<Seed> seeds;
  m_held.for_each_anchor([&](Slot slot) {
    seeds.push_back({slot, m_values[slot] - sign * furthest});
  });
  m_propagator.run(sign > 0 ? Direction::lower : Direction::raise, seeds, m_values, &m_undo);
  for (std::size_t h = 0; h < m_start.size(); ++h) {
    const std::int32_t by = sign * m_held.by_q[h][m_coordinate];
    if (by <= 0) continue;
    const std::int64_t followed = sign * (std::int64_t(m_start[h]) - m_values[m_held.slots[h]]);
    fraction.limit_to(furthest - followed, by);
  }
}

/// Every conflict between handles leaves the upper one of a pair below its target: U of the lower
/// one reaches it, since the configuration before the lowering is valid.
void CoordinateDrag::require_agreement() {
  std::int64_t worst = 0;
  std::size_t handle_above = 0;
  for (std::size_t h = 0; h < m_targets.size(); ++h) {
    const std::int64_t missing = std::int64_t(m_targets[h]) - m_values[m_held.slots[h]];
    if (missing <= worst) continue;
    worst = missing;
    handle_above = h;
  }
  if (worst > 0) report_conflict(handle_above, worst);
}

/// Raising the upper handle alone from the present (valid, low) configuration lifts its partner
/// above the partner's target by the same missing distance.
void CoordinateDrag::report_conflict(std::size_t handle_above, std::int64_t missing) {
  m_propagator.run(Direction::raise, {{m_held.slots[handle_above], m_targets[handle_above]}},
                   m_values, &m_undo);
  std::size_t handle_below = handle_above;
  for (std::size_t h = 0; h < m_targets.size(); ++h) {
    if (h == handle_above || m_values[m_held.slots[h]] - std::int64_t(m_targets[h]) < missing) {
      continue;
    }
    handle_below = h;
    break;
  }
  const double missing_mm =
      double(missing) / kFixedOne * m_body.geometry.spacing_mm()[m_coordinate];
  char found[128];
  std::snprintf(found, sizeof found,
                "targets %.6g mm further apart along axis %c than the links between them allow",
                missing_mm, "ijk"[m_coordinate]);
  const BrickTopology& elements = m_body.elements;
  throw InputError({"",
                    "grab " + voxel_text(voxel_of(elements, m_held.slots[handle_above])) + " and " +
                        voxel_text(voxel_of(elements, m_held.slots[handle_below])),
                    found, "handles that agree with each other"});
}

}  // namespace supple
