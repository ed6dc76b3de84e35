// The block engine: propagation through 8^3 bricks instead of voxels (design.md section 3).
//
// Bricks whose halo changed wait in a queue ordered by the largest level that reaches them. A round
// takes one bucket of it: every brick draws in the levels across its changed faces, closes itself
// (brick_kernel.h), and finds which neighbours that affects. Face neighbours differ in the parity
// of their brick coordinates, so the even and then the odd bricks of a round can be visited by all
// threads without one reading what another writes; with diagonals, whose links also lead across
// edges and corners, a round has 8 phases. The fixed point is unique and rounds do not
// depend on threads: values and visits are the same whatever their number.
//
//   rigid or stiff: 2 to 3 visits per brick reached, smooth material 1; about 1.5 us a visit
//   memory: 8 bytes per brick of the body, 116 with diagonals; 40 bytes per brick waiting
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lib/body/body.h"
#include "lib/body/link_masks.h"
#include "lib/chainmail/bucket_queue.h"
#include "lib/chainmail/link_costs.h"
#include "lib/chainmail/propagation.h"

namespace supple {

class BlockPropagator {
 public:
  /// Keeps a reference to the body, whose elements, classes and slacks must not change.
  explicit BlockPropagator(const Body& body);

  /// Runs as Propagator::run. `bucket_shift`: levels within 2^bucket_shift units share a round.
  void run(const PropagationTask& task, const std::vector<Seed>& seeds, int bucket_shift,
           PropagationCounts& counts);
  /// Closes as Propagator::close.
  void close(const PropagationTask& task, int bucket_shift, PropagationCounts& counts);

  std::size_t bytes() const;

 private:
  /// A brick that waits: the largest level that reaches it, and from where.
  struct Waiting {
    Level level = 0;  // 0: does not wait
    std::uint32_t entrances = 0;
  };

  const LinkCosts& costs_of(const PropagationTask& task);
  void find_neighbours();
  void start(const PropagationTask& task, Level first, int bucket_shift);
  void set_seeds(const PropagationTask& task, const std::vector<Seed>& seeds);
  void wait(std::size_t brick, Level level, int entrance);
  void drain(const PropagationTask& task, PropagationCounts& counts);
  void forget_waiting();
  /// Entrance of a brick beside its neighbours: a seed was set inside.
  int seeded() const;
  template <class Visit>
  void visit_phase(const PropagationTask& task, std::vector<std::uint32_t>& bricks);

  const Body& m_body;
  std::array<std::array<LinkCosts, 2>, 3> m_costs;  // [coordinate][direction], built when asked for
  std::vector<BrickNeighbours> m_neighbours;        // per brick; empty with 6 links
  std::vector<Waiting> m_waiting;
  BucketQueue m_queue{256};
  std::vector<QueueEntry> m_round;
  std::array<std::vector<std::uint32_t>, 8> m_phases;  // bricks of a round that share no link
  /// Per brick of a phase and neighbour, the largest level that a visit sends there and that
  /// changes it; 0: none.
  std::vector<Level> m_outgoing;
  bool m_running = false;  // still true in start(): an exception ended the last run
};

}  // namespace supple
