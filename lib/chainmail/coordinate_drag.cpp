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

CoordinateDrag::CoordinateDrag(Body& body, int coordinate, HeldVoxels& held,
                               const FreePieces& pieces, Propagator& propagator, UndoLog& undo,
                               Progress* progress)
    : m_body(body),
      m_coordinate(coordinate),
      m_held(held),
      m_pieces(pieces),
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

template <class Visit>
void CoordinateDrag::for_each_target(std::size_t h, Direction direction, Visit&& visit) const {
  const HeldHandle& handle = m_held.handles[h];
  const auto c = std::size_t(m_coordinate);
  if (handle.is_push()) {
    const auto& tool = direction == Direction::raise ? handle.below : handle.above;
    for (const ToolPlace& place : tool[c]) {
      visit(place.slot, place.value + scaled(place.by), m_values.at(place.slot), place.by);
    }
    return;
  }
  const bool as_one = handle.moves_as_one();
  std::int32_t by = handle.source->by_q[c], part = scaled(by);
  std::size_t n = 0;
  for (const SlotSet::Brick& entry : handle.slots.bricks()) {
    const std::int32_t* saved = m_undo.saved_of(entry.brick);
    const Slot first = entry.brick * kBrickVoxels;
    const std::int32_t* now = m_values.brick_or_zero(entry.brick);
    const std::int32_t* before = saved != nullptr ? saved : now;
    for_each_active(entry.mask, [&](int offset) {
      if (!as_one) {
        by = handle.by(n++)[c];
        part = scaled(by);
      }
      visit(first + Slot(offset), before[offset] + part, now[offset], by);
    });
  }
}

void CoordinateDrag::propagate(Direction direction, const std::vector<Seed>& seeds) {
  run(direction, seeds);
  if (m_pieces.empty()) return;
  const auto before = [&](std::size_t brick) {
    const std::int32_t* saved = m_undo.saved_of(brick);
    return saved != nullptr ? saved : m_values.brick_or_zero(brick);
  };
  for (;;) {
    const std::vector<Seed> more = m_pieces.lagging(m_values, before, direction);
    if (more.empty()) return;
    run(direction, more);
  }
}

void CoordinateDrag::run(Direction direction, const std::vector<Seed>& seeds) {
  const PropagationCounts counts =
      m_propagator.run({m_coordinate, direction, m_values, &m_undo, m_progress}, seeds);
  m_counts.visits += counts.visits;
  m_counts.max_queue = std::max(m_counts.max_queue, counts.max_queue);
}

/// The bounds that stop a move in that direction.
const std::vector<Bound>& CoordinateDrag::held_bounds(Direction direction) const {
  const Holds& rest = m_held.rest;
  return (direction == Direction::raise ? rest.at_most : rest.at_least)[std::size_t(m_coordinate)];
}

template <class Visit>
void CoordinateDrag::for_each_held(std::size_t brick, Direction direction, Visit&& visit) const {
  const Slot first = Slot(brick * kBrickVoxels);
  const std::int32_t* saved = m_undo.saved_of(brick);
  const std::int32_t* before = saved != nullptr ? saved : m_values.brick_or_zero(brick);
  const Holds& rest = m_held.rest;
  for (const SlotSet* anchored : {m_held.fixed, &rest.anchored}) {
    const BrickMask* mask = anchored->find(brick);
    if (mask == nullptr) continue;
    for_each_active(*mask, [&](int offset) { visit(first + Slot(offset), before[offset]); });
  }
  const auto& bounds = held_bounds(direction);
  for (auto bound = first_bound_from(bounds, first);
       bound != bounds.end() && bound->slot < first + kBrickVoxels; ++bound) {
    visit(bound->slot, bound->value);
  }
}

/// Finds how far held elements went too far. Only bricks that the run touched can hold any.
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

/// Rolls back, and seeds held elements. Only bricks that the run touched can hold any that limits.
std::vector<Seed> CoordinateDrag::pulled_back(Direction direction, std::int32_t shift) {
  const std::vector<std::size_t> touched = m_undo.bricks();
  roll_back();
  std::vector<Seed> seeds;
  for (const std::size_t brick : touched) {
    for_each_held(brick, direction, [&](Slot slot, std::int32_t limit) {
      seeds.push_back({slot, limit - shift});
    });
  }
  return seeds;
}

bool CoordinateDrag::let_edges_yield(Direction direction, std::int32_t furthest) {
  const std::int64_t sign = direction == Direction::raise ? 1 : -1;
  bool any = false;
  for (std::size_t h = 0; h < handle_count(); ++h) {
    if (!is_edge(h)) continue;
    HeldHandle& edge = m_held.handles[h];
    auto& places = (direction == Direction::raise ? edge.below : edge.above)[m_coordinate];
    for (ToolPlace& place : places) {
      const std::int64_t by = sign * place.by;
      if (by <= 0) continue;
      const std::int64_t followed = sign * (std::int64_t(place.value) - m_values.at(place.slot));
      const std::int64_t room = std::max<std::int64_t>(0, furthest - followed);
      if (room >= by) continue;
      place.by = std::int32_t(sign * room);
      any = true;
    }
  }
  return any;
}

void CoordinateDrag::throw_conflict(const Target& above, const Target& below,
                                    std::int64_t missing) const {
  const std::string names[2] = {m_held.handles[above.handle].source->region.name(),
                                m_held.handles[below.handle].source->region.name()};
  const std::string voxels[2] = {voxel_text(voxel_of(m_body.elements, above.slot)),
                                 voxel_text(voxel_of(m_body.elements, below.slot))};
  const bool within = above.handle == below.handle;
  const bool single = names[0] == voxels[0] && names[1] == voxels[1];
  const double missing_mm =
      double(missing) / kFixedOne * m_body.geometry.spacing_mm()[m_coordinate];
  throw InputError({"", "grab " + names[0] + (within ? "" : " and " + names[1]),
                    "targets " + number_text(missing_mm) + " mm further apart along axis " +
                        "ijk"[m_coordinate] + " than the links between " +
                        (single ? "them" : "voxels " + voxels[0] + " and " + voxels[1]) + " allow",
                    within ? "a motion that the links inside the handle can follow"
                           : "handles that agree with each other"});
}

template class DragAlgebra<CoordinateDrag>;

}  // namespace supple
