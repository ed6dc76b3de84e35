#include "lib/chainmail/piece_bounds.h"

#include <algorithm>

#include "lib/chainmail/free_pieces.h"

namespace supple {

namespace {

/// Choice among the bounds that are in force: those that last through a search, or the others.
struct SeedChoice {
  const LastingBounds& lasting;
  bool is_lasting;

  bool has_handle(std::size_t n) const { return (n < lasting.handle_count) == is_lasting; }
  bool has(Slot slot) const { return lasting.loose.contains(slot) != is_lasting; }
};

/// Lower bounds of held elements (raise), or upper ones.
std::vector<Seed> bounds_of_held(const Body& body, const HeldVoxels& held, int coordinate,
                                 Direction direction, const SeedChoice& choice) {
  const auto c = std::size_t(coordinate);
  const BrickValues& q = body.q[c];
  std::vector<Seed> seeds;
  const auto add_still = [&](Slot slot) { seeds.push_back({slot, q.at(slot)}); };
  if (choice.is_lasting) held.fixed->for_each(add_still);
  SlotSet anchored = held.rest.anchored;
  if (choice.is_lasting) {
    anchored.remove(choice.lasting.loose);
    anchored.for_each(add_still);
  } else {
    choice.lasting.loose.for_each([&](Slot slot) {
      if (anchored.contains(slot)) add_still(slot);
    });
  }
  const bool is_raise = direction == Direction::raise;
  for (const Bound& bound : (is_raise ? held.rest.at_least : held.rest.at_most)[c]) {
    if (choice.has(bound.slot)) seeds.push_back({bound.slot, bound.value});
  }
  for (std::size_t h = 0; h < held.handles.size(); ++h) {
    if (!choice.has_handle(h)) continue;
    const HeldHandle& handle = held.handles[h];
    if (handle.is_push()) {
      for (const ToolPlace& place : (is_raise ? handle.below : handle.above)[c]) {
        seeds.push_back({place.slot, place.value + place.by});
      }
      continue;
    }
    std::size_t n = 0;
    handle.slots.for_each([&](Slot slot) {
      seeds.push_back({slot, q.at(slot) + handle.by(n++)[c]});
    });
  }
  return seeds;
}

std::int32_t start_of(std::int32_t q, std::int64_t by) {
  return std::int32_t(std::clamp<std::int64_t>(q + by, -kMaxOffset, kMaxOffset));
}

/// Finds the envelope of the seeds, as far as it lies beyond offsets that are `by` from the present
/// ones. `values` serve again.
void find_envelope(const Body& body, int coordinate, Direction direction, std::int64_t by,
                   const std::vector<Seed>& seeds, Propagator& propagator, Progress* progress,
                   BrickValues& values) {
  values.resize(body.elements.brick_count());
  for (std::size_t b = 0; b < body.elements.brick_count(); ++b) {
    const std::int32_t* from = body.q[std::size_t(coordinate)].brick_or_zero(b);
    std::int32_t* to = values.touch(b);
    for (int n = 0; n < kBrickVoxels; ++n) to[n] = start_of(from[n], by);
  }
  propagator.run({coordinate, direction, values, nullptr, progress}, seeds);
}

std::int64_t reach_along(Direction direction, std::int32_t reach_q) {
  return direction == Direction::raise ? -std::int64_t(reach_q) : reach_q;
}

/// The value that lies further in the direction.
std::int32_t further(std::int32_t a, std::int32_t b, Direction direction) {
  return direction == Direction::raise ? std::max(a, b) : std::min(a, b);
}

SlotSet loose_elements(const Body& body, const HeldVoxels& held) {
  std::vector<const SlotSet*> sets = {held.fixed, &held.rest.anchored};
  for (const HeldHandle& handle : held.handles) {
    if (!handle.is_push()) sets.push_back(&handle.slots);
  }
  return FreePieces(body, sets).elements();
}

/// The lasting envelope of an element.
class LastingAt {
 public:
  explicit LastingAt(const LastingBounds& lasting) : m_lasting(lasting) {
    lasting.loose.for_each([&](Slot slot) { m_slots.push_back(slot); });
  }
  std::int32_t operator()(Slot slot, int coordinate, Direction direction) const {
    const auto at = std::lower_bound(m_slots.begin(), m_slots.end(), slot) - m_slots.begin();
    return m_lasting
        .envelopes[std::size_t(coordinate)][direction == Direction::lower][std::size_t(at)];
  }

 private:
  const LastingBounds& m_lasting;
  std::vector<Slot> m_slots;
};

}  // namespace

void find_lasting_bounds(const Body& body, const HeldVoxels& held, std::int32_t reach_q,
                         LastingBounds& lasting, Propagator& propagator, Progress* progress) {
  lasting.loose = loose_elements(body, held);
  lasting.reach_q = std::max(reach_q, lasting.least_reach_q);
  BrickValues values;
  for (int c = 0; c < 3; ++c) {
    for (const Direction direction : {Direction::raise, Direction::lower}) {
      find_envelope(body, c, direction, reach_along(direction, lasting.reach_q),
                    bounds_of_held(body, held, c, direction, {lasting, true}), propagator, progress,
                    values);
      std::vector<std::int32_t>& known =
          lasting.envelopes[std::size_t(c)][direction == Direction::lower];
      known.clear();
      lasting.loose.for_each([&](Slot slot) { known.push_back(values.at(slot)); });
    }
  }
}

std::vector<std::vector<ElementBounds>> bounds_of_pieces(
    const Body& body, const std::vector<const RigidPiece*>& pieces, const HeldVoxels& held,
    std::int32_t reach_q, const LastingBounds& lasting, Propagator& propagator,
    Progress* progress) {
  constexpr std::int32_t kNone = ElementBounds::kNone;
  std::vector<std::vector<ElementBounds>> all(pieces.size());
  for (std::size_t n = 0; n < pieces.size(); ++n) {
    pieces[n]->elements->for_each([&](Slot slot) {
      all[n].push_back({slot, {-kNone, -kNone, -kNone}, {kNone, kNone, kNone}});
    });
  }
  const LastingAt lasting_at(lasting);
  BrickValues values;
  for (int c = 0; c < 3; ++c) {
    const BrickValues& q = body.q[std::size_t(c)];
    for (const Direction direction : {Direction::raise, Direction::lower}) {
      const std::int64_t by = reach_along(direction, reach_q);
      const std::vector<Seed> seeds = bounds_of_held(body, held, c, direction, {lasting, false});
      if (!seeds.empty()) {
        find_envelope(body, c, direction, by, seeds, propagator, progress, values);
      }
      for (std::vector<ElementBounds>& bounds : all) {
        for (ElementBounds& element : bounds) {
          const Slot slot = element.slot;
          std::int32_t value =
              further(start_of(q.at(slot), by), lasting_at(slot, c, direction), direction);
          if (!seeds.empty()) value = further(value, values.at(slot), direction);
          if (value == q.at(slot) + by) continue;
          (direction == Direction::raise ? element.least : element.most)[std::size_t(c)] = value;
        }
      }
    }
  }
  for (std::vector<ElementBounds>& bounds : all) {
    const auto is_free = [](const ElementBounds& element) {
      return element.least == std::array<std::int32_t, 3>{-kNone, -kNone, -kNone} &&
             element.most == std::array<std::int32_t, 3>{kNone, kNone, kNone};
    };
    bounds.erase(std::remove_if(bounds.begin(), bounds.end(), is_free), bounds.end());
  }
  return all;
}

}  // namespace supple
