// The flat engine: one-sided propagation from voxel to voxel, Dijkstra on static slack with a
// bucket queue (design.md section 3, thesis section 4.2.2 "largest constraint violation first").
//
//   raise:  q_j = max(q_j, q_i - W(i -> j))   least solution above the seeds
//   lower:  q_j = min(q_j, q_i + W(j -> i))   greatest solution below the seeds
//
// Propagation stops where the present value already satisfies the link. About 100 ns per moved node
// on one core; it wins over the block engine where bricks hold few voxels: thin and 2D bodies.
#pragma once

#include <vector>

#include "lib/body/body.h"
#include "lib/chainmail/bucket_queue.h"
#include "lib/chainmail/propagation.h"

namespace supple {

class FlatPropagator {
 public:
  explicit FlatPropagator(const Body& body) : m_body(body) {}

  /// As Propagator::run. `bucket_shift`: nodes within 2^bucket_shift units count as equal.
  void run(const PropagationTask& task, const std::vector<Seed>& seeds, int bucket_shift,
           PropagationCounts& counts);

  std::size_t bytes() const { return m_queue.bytes(); }

 private:
  template <bool kRaise>
  void start(const PropagationTask& task, const std::vector<Seed>& seeds, int bucket_shift);
  template <bool kRaise>
  void drain(const PropagationTask& task, PropagationCounts& counts);
  template <bool kRaise>
  void spread(const PropagationTask& task, QueueEntry from);

  const Body& m_body;
  BucketQueue m_queue{2048};
};

}  // namespace supple
