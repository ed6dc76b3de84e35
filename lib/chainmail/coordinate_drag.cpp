#include "lib/chainmail/coordinate_drag.h"

#include <algorithm>

#include "volumes/base/error.h"

namespace supple {

namespace {

std::vector<Bound>::const_iterator first_bound_from(const std::vector<Bound>& bounds, Slot slot) {
  return std::lower_bound(bounds.begin(), bounds.end(), slot,
                          [](const Bound& bound, Slot wanted) { return bound.slot < wanted; });
}

}  // namespace

CoordinateDrag::CoordinateDrag(Body& body, int coordinate, const HeldVoxels& held,
                               Propagator& propagator, UndoLog& undo, Progress* progress)
    : m_body(body),
      m_coordinate(coordinate),
      m_held(held),
      m_values(body.q[coordinate]),
      m_undo(undo),
      m_propagator(propagator),
      m_progress(progress) {
  m_values.resize(body.elements.brick_count());
}

CoordinateDrag::~CoordinateDrag() {
  if (!m_committed) m_undo.roll_back(m_values);
  if (m_values.empty()) m_values.clear();
}

void CoordinateDrag::commit() {
  m_committed = true;
  for (const std::size_t brick : m_undo.bricks()) {
    m_body.drop_fractions(m_coordinate, brick, m_undo.saved_of(brick));
  }
}

void CoordinateDrag::try_whole(Fraction& fraction) {
  const Excess excess = solve();
  require_agreement();
  if (excess.up > 0) limit_by_held(Direction::raise, excess.up, fraction);
  if (excess.down > 0) limit_by_held(Direction::lower, excess.down, fraction);
}

void CoordinateDrag::redo(const Fraction& fraction) {
  m_undo.roll_back(m_values);
  m_fraction = fraction;
  const Excess excess = solve();
  require_agreement();
  if (excess.up > 0 || excess.down > 0) {
    throw Error("ECM: something held moved after the drag was shortened");
  }
}

template <class Visit>
void CoordinateDrag::for_each_target(const HeldHandle& handle, Direction direction,
                                     Visit&& visit) const {
  const std::int32_t by = m_fraction.scale(handle.by(m_coordinate));
  if (handle.is_push()) {
    const auto& tool = direction == Direction::raise ? handle.below : handle.above;
    for (const Bound& place : tool[std::size_t(m_coordinate)]) {
      visit(place.slot, place.value + by, m_values.at(place.slot));
    }
    return;
  }
  for (const SlotSet::Brick& entry : handle.slots.bricks()) {
    const std::int32_t* saved = m_undo.saved_of(entry.brick);
    const Slot first = entry.brick * kBrickVoxels;
    const std::int32_t* now = m_values.brick_or_zero(entry.brick);
    const std::int32_t* before = saved != nullptr ? saved : now;
    for_each_active(entry.mask, [&](int offset) {
      visit(first + Slot(offset), before[offset] + by, now[offset]);
    });
  }
}

/// The elements that a handle takes beyond their present place.
std::vector<Seed> CoordinateDrag::seeds(Direction direction) const {
  std::vector<Seed> seeds;
  for (const HeldHandle& handle : m_held.handles) {
    for_each_target(handle, direction, [&](Slot slot, std::int32_t target, std::int32_t present) {
      if (direction == Direction::raise ? target > present : target < present) {
        seeds.push_back({slot, target});
      }
    });
  }
  return seeds;
}

void CoordinateDrag::propagate(Direction direction, const std::vector<Seed>& seeds) {
  const PropagationCounts counts =
      m_propagator.run({m_coordinate, direction, m_values, &m_undo, m_progress}, seeds);
  m_counts.visits += counts.visits;
  m_counts.max_queue = std::max(m_counts.max_queue, counts.max_queue);
}

/// median(L, q, U): up to L from the lower bounds, then down to U from the upper ones.
CoordinateDrag::Excess CoordinateDrag::solve() {
  Excess excess;
  propagate(Direction::raise, seeds(Direction::raise));
  excess.up = excess_of_held(Direction::raise);
  propagate(Direction::lower, seeds(Direction::lower));
  excess.down = excess_of_held(Direction::lower);
  return excess;
}

/// What stops a move in that direction.
const std::vector<Bound>& CoordinateDrag::held_bounds(Direction direction) const {
  const Holds& rest = m_held.rest;
  return (direction == Direction::raise ? rest.at_most : rest.at_least)[std::size_t(m_coordinate)];
}

template <class Visit>
void CoordinateDrag::for_each_held(std::size_t brick, Direction direction, Visit&& visit) const {
  const Slot first = Slot(brick * kBrickVoxels);
  const std::int32_t* saved = m_undo.saved_of(brick);
  const std::int32_t* before = saved != nullptr ? saved : m_values.brick_or_zero(brick);
  for (const SlotSet* still : {m_held.fixed, &m_held.rest.still}) {
    const BrickMask* mask = still->find(brick);
    if (mask == nullptr) continue;
    for_each_active(*mask, [&](int offset) { visit(first + Slot(offset), before[offset]); });
  }
  const auto& bounds = held_bounds(direction);
  for (auto bound = first_bound_from(bounds, first);
       bound != bounds.end() && bound->slot < first + kBrickVoxels; ++bound) {
    visit(bound->slot, bound->value);
  }
}

/// Only bricks that the run touched can hold any.
std::int64_t CoordinateDrag::excess_of_held(Direction direction) const {
  const std::int64_t sign = direction == Direction::raise ? 1 : -1;
  std::int64_t excess = 0;
  for (const std::size_t brick : m_undo.bricks()) {
    const std::int32_t* now = m_values.brick_or_zero(brick);
    for_each_held(brick, direction, [&](Slot slot, std::int32_t limit) {
      excess = std::max(excess, sign * (std::int64_t(now[slot % kBrickVoxels]) - limit));
    });
  }
  return excess;
}

/// The smallest (dist(a, b) - (q_a - u_b)) / D_a over handles a that rise (D_a > 0) and held upper
/// bounds b. When all rise by the same D, the excess of the whole drag is D minus the smallest
/// numerator. Otherwise one run serves all pairs: held elements pulled down to u_b - max D_a lower
/// a handle by max D_a minus its smallest numerator, unless that is negative. What the whole drag
/// did not reach limits nothing. Sinking handles: mirrored.
void CoordinateDrag::limit_by_held(Direction direction, std::int64_t excess, Fraction& fraction) {
  const int sign = direction == Direction::raise ? 1 : -1;
  std::int32_t furthest = 0, nearest = INT32_MAX;
  for (const HeldHandle& handle : m_held.handles) {
    const std::int32_t by = sign * handle.by(m_coordinate);
    if (by <= 0) continue;
    furthest = std::max(furthest, by);
    nearest = std::min(nearest, by);
  }
  if (nearest == furthest) return fraction.limit_to(furthest - excess, furthest);

  const std::vector<std::size_t> touched = m_undo.bricks();
  m_undo.roll_back(m_values);
  std::vector<Seed> seeds;
  for (const std::size_t brick : touched) {
    for_each_held(brick, direction, [&](Slot slot, std::int32_t limit) {
      seeds.push_back({slot, limit - sign * furthest});
    });
  }
  propagate(sign > 0 ? Direction::lower : Direction::raise, seeds);
  for (const HeldHandle& handle : m_held.handles) {
    const std::int32_t by = sign * handle.by(m_coordinate);
    if (by <= 0) continue;
    std::int64_t room = furthest;
    for_each_target(handle, direction, [&](Slot, std::int32_t target, std::int32_t present) {
      // sign * (target - present) = by + how far the handle followed.
      room = std::min(room, furthest + by - sign * (std::int64_t(target) - present));
    });
    fraction.limit_to(room, by);
  }
}

/// Every conflict between handles leaves the upper one of a pair below its lower bound: U of the
/// other one reaches it, since the configuration before the lowering is valid.
void CoordinateDrag::require_agreement() {
  std::int64_t worst = 0;
  Target above{};
  for (const HeldHandle& handle : m_held.handles) {
    for_each_target(handle, Direction::raise,
                    [&](Slot slot, std::int32_t target, std::int32_t present) {
                      const std::int64_t missing = std::int64_t(target) - present;
                      if (missing <= worst) return;
                      worst = missing;
                      above = {&handle, slot, target};
                    });
  }
  if (worst > 0) report_conflict(above, worst);
}

/// Raising the upper element alone from the present (valid, low) configuration lifts its partner
/// above the partner's upper bound by the same missing distance.
void CoordinateDrag::report_conflict(const Target& above, std::int64_t missing) {
  propagate(Direction::raise, {{above.slot, above.value}});
  Target below = above;
  for (const HeldHandle& handle : m_held.handles) {
    for_each_target(handle, Direction::lower,
                    [&](Slot slot, std::int32_t target, std::int32_t present) {
                      if (below.slot != above.slot || slot == above.slot) return;
                      if (present - std::int64_t(target) >= missing)
                        below = {&handle, slot, target};
                    });
  }
  throw_conflict(above, below, missing);
}

void CoordinateDrag::throw_conflict(const Target& above, const Target& below,
                                    std::int64_t missing) const {
  const std::string names[2] = {above.handle->source->region.name(),
                                below.handle->source->region.name()};
  const std::string voxels[2] = {voxel_text(voxel_of(m_body.elements, above.slot)),
                                 voxel_text(voxel_of(m_body.elements, below.slot))};
  const bool single = names[0] == voxels[0] && names[1] == voxels[1];
  const double missing_mm =
      double(missing) / kFixedOne * m_body.geometry.spacing_mm()[m_coordinate];
  throw InputError({"", "grab " + names[0] + " and " + names[1],
                    "targets " + number_text(missing_mm) + " mm further apart along axis " +
                        "ijk"[m_coordinate] + " than the links between " +
                        (single ? "them" : "voxels " + voxels[0] + " and " + voxels[1]) + " allow",
                    "handles that agree with each other"});
}

}  // namespace supple
