#include "lib/chainmail/flat_propagate.h"

#include <algorithm>

namespace supple {

namespace {

/// Queue pops between two looks at the cancel flag.
constexpr std::int64_t kPollMask = (1 << 17) - 1;

template <bool kRaise>
bool lies_beyond(std::int32_t value, std::int32_t present) {
  return kRaise ? value > present : value < present;
}

}  // namespace

void FlatPropagator::run(const PropagationTask& task, const std::vector<Seed>& seeds,
                         int bucket_shift, PropagationCounts& counts) {
  if (seeds.empty()) return;
  if (task.direction == Direction::raise) {
    start<true>(task, seeds, bucket_shift);
    drain<true>(task, counts);
  } else {
    start<false>(task, seeds, bucket_shift);
    drain<false>(task, counts);
  }
  counts.max_queue = std::max(counts.max_queue, std::int64_t(m_queue.max_size()));
}

template <bool kRaise>
void FlatPropagator::start(const PropagationTask& task, const std::vector<Seed>& seeds,
                           int bucket_shift) {
  BrickValues& values = task.values;
  // The first bucket is that of the seed which moves furthest.
  std::int32_t first = seeds.front().value;
  for (const Seed& seed : seeds) {
    if (lies_beyond<kRaise>(seed.value, first)) first = seed.value;
  }
  m_queue.reset(first, kRaise, bucket_shift);
  for (const Seed& seed : seeds) {
    if (lies_beyond<kRaise>(seed.value, values.at(seed.slot))) {
      if (task.undo != nullptr) task.undo->before_change(seed.slot / kBrickVoxels, values);
      values.set(seed.slot, seed.value);
    }
    if (values.at(seed.slot) == seed.value) m_queue.push(seed.slot, seed.value);
  }
}

template <bool kRaise>
void FlatPropagator::drain(const PropagationTask& task, PropagationCounts& counts) {
  QueueEntry entry;
  while (m_queue.pop(entry)) {
    if ((++counts.visits & kPollMask) == 0 && task.progress != nullptr &&
        task.progress->cancelled()) {
      throw Cancelled();
    }
    // A later push of the same slot has superseded this entry.
    if (task.values.at(entry.slot) != entry.value) continue;
    spread<kRaise>(task, entry);
  }
}

template <bool kRaise>
void FlatPropagator::spread(const PropagationTask& task, QueueEntry from) {
  BrickValues& values = task.values;
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
                                     ? slacks.lower(axis, task.coordinate, from_class, to_class)
                                     : slacks.upper(axis, task.coordinate, from_class, to_class);
      if (slack >= kUnlimitedSlack) continue;
      const std::int32_t bound = kRaise ? from.value - slack : from.value + slack;
      if (!lies_beyond<kRaise>(bound, present)) continue;

      if (task.undo != nullptr) task.undo->before_change(to / kBrickVoxels, values);
      values.set(to, bound);
      m_queue.push(to, bound);
    }
  }
}

}  // namespace supple
