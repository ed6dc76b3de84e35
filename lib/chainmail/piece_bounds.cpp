#include "lib/chainmail/piece_bounds.h"

#include <algorithm>

namespace supple {

namespace {

/// Lower bounds of what is held (raise), or upper ones.
std::vector<Seed> bounds_of_held(const Body& body, const HeldVoxels& held, int coordinate,
                                 Direction direction) {
  const auto c = std::size_t(coordinate);
  const BrickValues& q = body.q[c];
  std::vector<Seed> seeds;
  for (const SlotSet* still : {held.fixed, &held.rest.anchored}) {
    still->for_each([&](Slot slot) { seeds.push_back({slot, q.at(slot)}); });
  }
  const bool is_raise = direction == Direction::raise;
  for (const Bound& bound : (is_raise ? held.rest.at_least : held.rest.at_most)[c]) {
    seeds.push_back({bound.slot, bound.value});
  }
  for (const HeldHandle& handle : held.handles) {
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

/// The envelope of the seeds, as far as it lies beyond offsets that are `by` from the present ones.
BrickValues envelope(const Body& body, int coordinate, Direction direction, std::int64_t by,
                     const std::vector<Seed>& seeds, Propagator& propagator, Progress* progress) {
  BrickValues values;
  values.resize(body.elements.brick_count());
  for (std::size_t b = 0; b < body.elements.brick_count(); ++b) {
    const std::int32_t* from = body.q[std::size_t(coordinate)].brick_or_zero(b);
    std::int32_t* to = values.touch(b);
    for (int n = 0; n < kBrickVoxels; ++n) {
      to[n] = std::int32_t(std::clamp<std::int64_t>(from[n] + by, -kMaxOffset, kMaxOffset));
    }
  }
  propagator.run({coordinate, direction, values, nullptr, progress}, seeds);
  return values;
}

}  // namespace

std::vector<std::vector<ElementBounds>> bounds_of_pieces(
    const Body& body, const std::vector<const RigidPiece*>& pieces, const HeldVoxels& held,
    std::int32_t reach_q, Propagator& propagator, Progress* progress) {
  constexpr std::int32_t kNone = ElementBounds::kNone;
  std::vector<std::vector<ElementBounds>> all(pieces.size());
  for (std::size_t n = 0; n < pieces.size(); ++n) {
    pieces[n]->elements->for_each([&](Slot slot) {
      all[n].push_back({slot, {-kNone, -kNone, -kNone}, {kNone, kNone, kNone}});
    });
  }
  for (int c = 0; c < 3; ++c) {
    const BrickValues& q = body.q[std::size_t(c)];
    for (const Direction direction : {Direction::raise, Direction::lower}) {
      const std::int64_t by = direction == Direction::raise ? -std::int64_t(reach_q) : reach_q;
      const BrickValues reached = envelope(
          body, c, direction, by, bounds_of_held(body, held, c, direction), propagator, progress);
      for (std::vector<ElementBounds>& bounds : all) {
        for (ElementBounds& element : bounds) {
          const std::int32_t value = reached.at(element.slot);
          if (value == q.at(element.slot) + by) continue;
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
