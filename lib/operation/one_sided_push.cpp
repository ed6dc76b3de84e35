#include "lib/operation/one_sided_push.h"

#include <algorithm>

#include "volumes/base/parallel.h"

namespace supple {

namespace {

constexpr std::int32_t kNowhere = kMaxOffset / 2;  // beyond what anchors allow

/// The envelope of the anchors in one direction.
BrickValues envelope_of(const Body& body, const SlotSet& anchors, int coordinate,
                        Direction direction, Propagator& propagator) {
  const std::int32_t from = direction == Direction::raise ? -kNowhere : kNowhere;
  BrickValues values(body.elements.brick_count());
  for_each_element(body.elements, [&](Slot slot) { values.set(slot, from); });
  std::vector<Seed> seeds;
  anchors.for_each([&](Slot slot) {
    seeds.push_back({slot, body.q[std::size_t(coordinate)].at(slot)});
  });
  propagator.run({coordinate, direction, values}, seeds);
  return values;
}

/// Leaves the seeds that ask for a change, no further than `limits`.
void shorten(std::vector<Seed>& seeds, Direction direction, const BrickValues& limits,
             const BrickValues& values) {
  const bool raises = direction == Direction::raise;
  std::size_t kept = 0;
  for (Seed seed : seeds) {
    const std::int32_t limit = limits.at(seed.slot), now = values.at(seed.slot);
    seed.value = raises ? std::min(seed.value, limit) : std::max(seed.value, limit);
    if (raises ? seed.value > now : seed.value < now) seeds[kept++] = seed;
  }
  seeds.resize(kept);
}

std::int32_t floor_mean(std::int32_t a, std::int32_t b) {
  return std::int32_t((std::int64_t(a) + b) >> 1);
}

}  // namespace

OneSidedPush::OneSidedPush(Body& body, const SlotSet& anchors) : m_body(body) {
  parallel_for(std::size_t(3), [&](std::size_t c) {
    Coordinate& own = m_coordinates[c];
    body.q[c].resize(body.elements.brick_count());
    own.propagator = std::make_unique<Propagator>(body);
    own.least = envelope_of(body, anchors, int(c), Direction::raise, *own.propagator);
    own.most = envelope_of(body, anchors, int(c), Direction::lower, *own.propagator);
    own.changed.assign(body.elements.brick_count(), {});
  });
}

std::vector<std::size_t> OneSidedPush::push(OneSidedAsks asks) {
  parallel_for(std::size_t(3),
               [&](std::size_t c) { push_along(c, asks.at_least[c], asks.at_most[c]); });
  std::vector<std::size_t> touched;
  for (const Coordinate& own : m_coordinates) {
    touched.insert(touched.end(), own.touched.begin(), own.touched.end());
  }
  std::sort(touched.begin(), touched.end());
  touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
  return touched;
}

void OneSidedPush::push_along(std::size_t c, std::vector<Seed>& at_least,
                              std::vector<Seed>& at_most) {
  Coordinate& own = m_coordinates[c];
  BrickValues& values = m_body.q[c];
  shorten(at_least, Direction::raise, own.most, values);
  shorten(at_most, Direction::lower, own.least, values);
  const auto run = [&](Direction direction) {
    own.propagator->run({int(c), direction, values, &own.undo},
                        direction == Direction::raise ? at_least : at_most);
  };
  if (!at_least.empty()) run(Direction::raise);
  if (!at_most.empty()) run(Direction::lower);
  const auto is_met = [&](const Seed& seed) { return values.at(seed.slot) >= seed.value; };
  if (!at_most.empty() && !std::all_of(at_least.begin(), at_least.end(), is_met)) {
    own.touched = own.undo.bricks();
    own.first.clear();
    for (const std::size_t brick : own.touched) {
      const std::int32_t* now = values.brick_or_zero(brick);
      own.first.insert(own.first.end(), now, now + kBrickVoxels);
    }
    own.undo.roll_back(values);
    run(Direction::lower);
    run(Direction::raise);
    take_mean(own, values);
  }
  note_changes(c);
}

/// Mean of the result of the first order and of the present one.
void OneSidedPush::take_mean(Coordinate& own, BrickValues& values) {
  // Bricks that only one order touched hold what they held before in the other one.
  std::vector<std::size_t> only_now;
  for (const std::size_t brick : own.undo.bricks()) {
    if (std::find(own.touched.begin(), own.touched.end(), brick) == own.touched.end()) {
      only_now.push_back(brick);
    }
  }
  for (std::size_t n = 0; n < own.touched.size(); ++n) {
    own.undo.before_change(own.touched[n], values);
    std::int32_t* now = values.touch(own.touched[n]);
    const std::int32_t* first = own.first.data() + n * kBrickVoxels;
    for (int i = 0; i < kBrickVoxels; ++i) now[i] = floor_mean(now[i], first[i]);
  }
  for (const std::size_t brick : only_now) {
    std::int32_t* now = values.touch(brick);
    const std::int32_t* before = own.undo.saved_of(brick);
    for (int i = 0; i < kBrickVoxels; ++i) now[i] = floor_mean(now[i], before[i]);
  }
}

void OneSidedPush::note_changes(std::size_t c) {
  Coordinate& own = m_coordinates[c];
  for (const std::size_t brick : own.undo.bricks()) {
    const std::int32_t* before = own.undo.saved_of(brick);
    const std::int32_t* now = m_body.q[c].brick_or_zero(brick);
    for (int i = 0; i < kBrickVoxels; ++i) {
      if (now[i] != before[i]) mask_set(own.changed[brick], i);
    }
    m_body.drop_fractions(int(c), brick, before);
  }
  own.touched = own.undo.bricks();
  own.undo.clear();
}

void OneSidedPush::set_adrift(const SlotSet& elements) {
  for (Coordinate& own : m_coordinates) {
    elements.for_each([&](Slot slot) {
      own.least.set(slot, -kNowhere);
      own.most.set(slot, kNowhere);
    });
  }
}

std::vector<SlotSet::Brick> OneSidedPush::changes() const {
  std::vector<SlotSet::Brick> list;
  for (std::size_t b = 0; b < m_body.elements.brick_count(); ++b) {
    BrickMask mask{};
    for (const Coordinate& own : m_coordinates) {
      for (std::size_t word = 0; word < mask.size(); ++word) mask[word] |= own.changed[b][word];
    }
    if (mask != BrickMask{}) list.push_back({std::uint32_t(b), mask});
  }
  return list;
}

void OneSidedPush::clear_changes() {
  for (Coordinate& own : m_coordinates) {
    std::fill(own.changed.begin(), own.changed.end(), BrickMask{});
  }
}

}  // namespace supple
