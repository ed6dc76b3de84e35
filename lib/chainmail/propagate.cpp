#include "lib/chainmail/propagate.h"

#include <algorithm>

namespace supple {

namespace {

/// Queue pops between two looks at the cancel flag.
constexpr std::int64_t kPollMask = (1 << 17) - 1;

/// Bricks whose links are sampled to choose the bucket width.
constexpr std::size_t kSampledBricks = 16;

template <bool kRaise>
bool lies_beyond(std::int32_t value, std::int32_t present) {
  return kRaise ? value > present : value < present;
}

}  // namespace

Propagator::Propagator(const Body& body, int coordinate, Progress* progress, int bucket_shift)
    : m_body(body), m_coordinate(coordinate), m_progress(progress), m_bucket_shift(bucket_shift) {
  if (m_bucket_shift < 0) m_bucket_shift = fitted_shift();
}

/// A quarter of the geometric mean of the sampled slacks: narrow enough that few labels are
/// corrected, wide enough that few buckets are empty, and unmoved by a few very wide links.
int Propagator::fitted_shift() const {
  const std::size_t bricks = m_body.elements.brick_count();
  const std::size_t step = std::max<std::size_t>(1, bricks / kSampledBricks);
  std::int64_t sum_of_logs = 0, count = 0;
  for (std::size_t b = 0; b < bricks; b += step) {
    for_each_link(m_body.elements, m_body.cuts, b, [&](int axis, Slot low, Slot high) {
      const std::uint8_t low_class = m_body.classes[low], high_class = m_body.classes[high];
      for (const std::int32_t slack :
           {m_body.slacks.upper(axis, m_coordinate, low_class, high_class),
            m_body.slacks.lower(axis, m_coordinate, low_class, high_class)}) {
        if (slack == 0 || slack >= kUnlimitedSlack) continue;
        sum_of_logs += 31 - __builtin_clz(unsigned(slack));
        ++count;
      }
    });
  }
  return count == 0 ? kFixedBits : int(std::max<std::int64_t>(0, sum_of_logs / count - 2));
}

void Propagator::run(Direction direction, const std::vector<Seed>& seeds, BrickValues& values,
                     UndoLog* undo) {
  if (seeds.empty()) return;
  if (direction == Direction::raise) {
    start<true>(seeds, values, undo);
    drain<true>(values, undo);
  } else {
    start<false>(seeds, values, undo);
    drain<false>(values, undo);
  }
  m_max_queue = std::max(m_max_queue, std::int64_t(m_queue.max_size()));
}

template <bool kRaise>
void Propagator::start(const std::vector<Seed>& seeds, BrickValues& values, UndoLog* undo) {
  // The first bucket is that of the seed which moves furthest.
  std::int32_t first = seeds.front().value;
  for (const Seed& seed : seeds) {
    if (lies_beyond<kRaise>(seed.value, first)) first = seed.value;
  }
  m_queue.reset(first, kRaise, m_bucket_shift);
  for (const Seed& seed : seeds) {
    if (lies_beyond<kRaise>(seed.value, values.at(seed.slot))) {
      if (undo != nullptr) undo->before_change(seed.slot / kBrickVoxels, values);
      values.set(seed.slot, seed.value);
    }
    if (values.at(seed.slot) == seed.value) m_queue.push(seed.slot, seed.value);
  }
}

template <bool kRaise>
void Propagator::drain(BrickValues& values, UndoLog* undo) {
  QueueEntry entry;
  while (m_queue.pop(entry)) {
    if ((++m_visited & kPollMask) == 0 && m_progress != nullptr && m_progress->cancelled()) {
      throw Cancelled();
    }
    // A later push of the same slot has superseded this entry.
    if (values.at(entry.slot) != entry.value) continue;
    spread<kRaise>(entry, values, undo);
  }
}

template <bool kRaise>
void Propagator::spread(QueueEntry from, BrickValues& values, UndoLog* undo) {
  const SlackTable& slacks = m_body.slacks;
  const std::uint8_t from_class = m_body.classes[from.slot];
  for (int axis = 0; axis < 3; ++axis) {
    for (const bool positive : {false, true}) {
      Slot to;
      if (!neighbour_slot(m_body.elements, m_body.cuts, from.slot, axis, positive, to)) continue;
      const std::int32_t present = values.at(to);
      if (!lies_beyond<kRaise>(from.value, present)) continue;

      // Raising the low end lifts the high end once `lower` is used up; and so on, mirrored.
      const std::uint8_t to_class = m_body.classes[to];
      const std::int32_t slack = kRaise == positive
                                     ? slacks.lower(axis, m_coordinate, from_class, to_class)
                                     : slacks.upper(axis, m_coordinate, from_class, to_class);
      if (slack >= kUnlimitedSlack) continue;
      const std::int32_t bound = kRaise ? from.value - slack : from.value + slack;
      if (!lies_beyond<kRaise>(bound, present)) continue;

      if (undo != nullptr) undo->before_change(to / kBrickVoxels, values);
      values.set(to, bound);
      m_queue.push(to, bound);
    }
  }
}

}  // namespace supple
