// The flat engine over any graph: one-sided propagation from node to node, Dijkstra on static slack
// with a bucket queue (design.md section 3, thesis section 4.2.2 "largest constraint violation
// first").
//
//   raise:  q_j = max(q_j, q_i - W(i -> j))   least solution above the seeds
//   lower:  q_j = min(q_j, q_i + W(j -> i))   greatest solution below the seeds
//
// Propagation stops where the present value already satisfies the link. Integers only: the fixed
// point is unique, whatever the order of the graph's links.
//
// A Graph is one coordinate of a body:
//   std::int32_t value(Slot) const;
//   void set(Slot, std::int32_t);             also records the value for undoing
//   template <bool kRaise, class Visit>
//   void for_each_link(Slot from, Visit&&) const;
// for_each_link calls visit(to, slack) for the links of a node; `slack` is a function of no
// arguments, since most neighbours hold already and need no look-up. It returns W(from -> to) when
// kRaise, W(to -> from) otherwise; kUnlimitedSlack or more is no limit.
#pragma once

#include <algorithm>
#include <vector>

#include "lib/chainmail/bucket_queue.h"
#include "lib/chainmail/propagation.h"
#include "lib/material/material.h"
#include "volumes/base/progress.h"

namespace supple {

template <class Graph>
class FlatEngine {
 public:
  /// Keeps the queue's memory for the next run.
  explicit FlatEngine(BucketQueue& queue) : m_queue(queue) {}

  /// Moves the values to the envelope of the seeds; seeds that lie at the present value spread from
  /// there. `bucket_shift`: nodes within 2^bucket_shift units count as equal. Throws Cancelled.
  void run(Graph& graph, Direction direction, const std::vector<Seed>& seeds, int bucket_shift,
           Progress* progress, PropagationCounts& counts) {
    if (seeds.empty()) return;
    if (direction == Direction::raise) {
      start<true>(graph, seeds, bucket_shift);
      drain<true>(graph, progress, counts);
    } else {
      start<false>(graph, seeds, bucket_shift);
      drain<false>(graph, progress, counts);
    }
    counts.max_queue = std::max(counts.max_queue, std::int64_t(m_queue.max_size()));
  }

 private:
  /// Queue pops between two looks at the cancel flag.
  static constexpr std::int64_t kPollMask = (1 << 17) - 1;

  template <bool kRaise>
  static bool lies_beyond(std::int32_t value, std::int32_t present) {
    return kRaise ? value > present : value < present;
  }

  template <bool kRaise>
  void start(Graph& graph, const std::vector<Seed>& seeds, int bucket_shift) {
    // The first bucket is that of the seed which moves furthest.
    std::int32_t first = seeds.front().value;
    for (const Seed& seed : seeds) {
      if (lies_beyond<kRaise>(seed.value, first)) first = seed.value;
    }
    m_queue.reset(first, kRaise, bucket_shift);
    for (const Seed& seed : seeds) {
      if (lies_beyond<kRaise>(seed.value, graph.value(seed.slot))) graph.set(seed.slot, seed.value);
      if (graph.value(seed.slot) == seed.value) m_queue.push(seed.slot, seed.value);
    }
  }

  template <bool kRaise>
  void drain(Graph& graph, Progress* progress, PropagationCounts& counts) {
    QueueEntry entry;
    while (m_queue.pop(entry)) {
      if ((++counts.visits & kPollMask) == 0 && progress != nullptr && progress->cancelled()) {
        throw Cancelled();
      }
      // A later push of the same slot has superseded this entry.
      if (graph.value(entry.slot) != entry.value) continue;
      spread<kRaise>(graph, entry);
    }
  }

  template <bool kRaise>
  void spread(Graph& graph, QueueEntry from) {
    graph.template for_each_link<kRaise>(from.slot, [&](Slot to, auto&& slack_of_link) {
      const std::int32_t present = graph.value(to);
      if (!lies_beyond<kRaise>(from.value, present)) return;
      const std::int32_t slack = slack_of_link();
      if (slack >= kUnlimitedSlack) return;
      const std::int32_t bound = kRaise ? from.value - slack : from.value + slack;
      if (!lies_beyond<kRaise>(bound, present)) return;
      graph.set(to, bound);
      m_queue.push(to, bound);
    });
  }

  BucketQueue& m_queue;
};

}  // namespace supple
