// One-sided propagation through the links of one coordinate: Dijkstra on static slack with a
// bucket queue (design.md section 3, thesis section 4.2.2 "largest constraint violation first").
//
//   raise:  q_j = max(q_j, q_i - W(i -> j))   least solution above the seeds
//   lower:  q_j = min(q_j, q_i + W(j -> i))   greatest solution below the seeds
//
// Integers only, so the fixed point is unique: the bits do not depend on the order. Propagation
// stops where the present value already satisfies the link, so a valid body is visited only where
// it moves. About 100 ns per moved node on one core.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/body/body.h"
#include "lib/chainmail/bucket_queue.h"
#include "lib/chainmail/undo_log.h"
#include "volumes/base/progress.h"

namespace supple {

enum class Direction { raise, lower };

/// A slot and the value that it is to take (when that lies in the direction of the run).
struct Seed {
  Slot slot;
  std::int32_t value;
};

class Propagator {
 public:
  /// `bucket_shift`: buckets are 2^bucket_shift units wide; negative: fitted to the body's slack.
  /// The width changes the time, never the result.
  Propagator(const Body& body, int coordinate, Progress* progress, int bucket_shift = -1);

  /// Moves `values` to the envelope of the seeds. A seed that lies at the present value spreads
  /// from there, which matters where links are broken. `undo` may be null.
  void run(Direction direction, const std::vector<Seed>& seeds, BrickValues& values, UndoLog* undo);

  std::int64_t visited() const { return m_visited; }
  std::int64_t max_queue() const { return m_max_queue; }

 private:
  template <bool kRaise>
  void start(const std::vector<Seed>& seeds, BrickValues& values, UndoLog* undo);
  template <bool kRaise>
  void drain(BrickValues& values, UndoLog* undo);
  template <bool kRaise>
  void spread(QueueEntry from, BrickValues& values, UndoLog* undo);
  int fitted_shift() const;

  const Body& m_body;
  int m_coordinate;
  Progress* m_progress;
  int m_bucket_shift;
  BucketQueue m_queue;
  std::int64_t m_visited = 0;
  std::int64_t m_max_queue = 0;
};

}  // namespace supple
