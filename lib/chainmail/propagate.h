// One-sided propagation through the links of one coordinate, by the engine that suits the body.
//
//   raise:  q_j = max(q_j, q_i - W(i -> j))   least solution above the seeds
//   lower:  q_j = min(q_j, q_i + W(j -> i))   greatest solution below the seeds
//
// Integers only, so the fixed point is unique: the bits depend neither on the engine nor on order,
// bucket width or threads. Propagation stops where the present value already satisfies the link.
#pragma once

#include <array>
#include <vector>

#include "lib/body/body.h"
#include "lib/chainmail/block_propagate.h"
#include "lib/chainmail/bucket_queue.h"
#include "lib/chainmail/drag.h"
#include "lib/chainmail/propagation.h"

namespace supple {

// The flat engine on the lattice of a voxel body. About 100 ns per moved node on one core; it wins
// over the block engine where bricks hold few voxels: thin and 2D bodies.

class FlatPropagator {
 public:
  explicit FlatPropagator(const Body& body) : m_body(body) {}

  /// Runs as Propagator::run. `bucket_shift`: nodes within 2^bucket_shift units count as equal.
  void run(const PropagationTask& task, const std::vector<Seed>& seeds, int bucket_shift,
           PropagationCounts& counts);

  std::size_t bytes() const { return m_queue.bytes(); }

 private:
  const Body& m_body;
  BucketQueue m_queue{2048};
};

/// Keeps queues and tables between runs, so that a local run costs what it moves.
class Propagator {
 public:
  /// Refers to the body, whose elements, classes and slacks must not change meanwhile; cuts may.
  /// `bucket_shift`: width of the queue's buckets, 2^bucket_shift units; negative: fitted to the
  /// body's slack. It changes the time, never the result.
  explicit Propagator(const Body& body, Engine engine = Engine::automatic, int bucket_shift = -1);

  /// Moves the values to the envelope of the seeds. A seed that lies at the present value spreads
  /// from there, which matters where links are broken. Seeds may lie beyond the range of offsets by
  /// as much again, for results that are rolled back. Throws Cancelled.
  PropagationCounts run(const PropagationTask& task, const std::vector<Seed>& seeds);
  /// The same with every element as a seed at its present value: the envelope of an invalid start.
  PropagationCounts close(const PropagationTask& task);

  /// The engine in use, block or flat.
  Engine engine() const { return m_engine; }
  std::size_t bytes() const { return m_block.bytes() + m_flat.bytes(); }

 private:
  int bucket_shift(Engine engine, int coordinate);

  const Body& m_body;
  Engine m_engine;
  BlockPropagator m_block;
  FlatPropagator m_flat;
  int m_bucket_shift;
  std::array<int, 3> m_slack_bits{-1, -1, -1};  // per coordinate, once asked for
};

}  // namespace supple
