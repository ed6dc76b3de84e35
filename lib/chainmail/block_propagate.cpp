#include "lib/chainmail/block_propagate.h"

#include <algorithm>

#include "lib/body/brick_faces.h"
#include "lib/chainmail/brick_kernel.h"
#include "lib/chainmail/diagonal_visit.h"
#include "volumes/base/parallel.h"

namespace supple {

namespace {

/// Fewer bricks than this are visited faster than other threads wake up.
constexpr std::size_t kParallelBricks = 12;
constexpr std::size_t kBricksPerTask = 4;

/// One visit of a brick: reads its neighbours, writes its own values.
class BrickVisit {
 public:
  static constexpr int kNeighbours = 6;
  /// Entrance besides the faces 0…5: a seed was set inside.
  static constexpr int kSeeded = 6;

  BrickVisit(const VisitContext& context, std::size_t b)
      : m_body(context.body),
        m_costs(context.costs),
        m_values(context.task.values),
        m_direction(context.task.direction),
        m_brick(b) {
    load_levels(offsets(b), m_direction, m_levels);
  }

  static std::size_t neighbour(const VisitContext& context, std::size_t brick, int face) {
    return std::size_t(context.body.elements.neighbour(brick, face));
  }
  static int opposite(int face) { return opposite_face(face); }

  /// Draws in the levels that the neighbour across a face sends.
  void draw(int face) {
    const std::int32_t other = m_body.elements.neighbour(m_brick, face);
    alignas(64) Level own[kFaceVoxels];
    alignas(64) std::int32_t sent[kFaceVoxels];
    take_face(offsets(std::size_t(other)), opposite_face(face), sent);
    take_face(m_levels, face, own);
    look_up_face(face, std::size_t(other), !is_high_face(face));
    for (int n = 0; n < kFaceVoxels; ++n) {
      const std::int32_t level = std::int32_t(level_of(sent[n], m_direction) - m_face_costs[n]);
      own[n] = Level(std::max(level, std::int32_t(own[n])));
    }
    put_face(own, face, m_levels);
  }

  void close() {
    BrickCosts costs;
    const BrickLinks links =
        links_inside(m_body.elements.mask(m_brick), m_body.cuts.brick(m_brick));
    look_up_costs(m_costs, classes(m_brick), links, costs);
    close_brick(costs, m_levels);
  }

  /// Stores the values; returns the faces whose values changed, as bits.
  unsigned store(std::int32_t* q) const { return store_levels(m_levels, m_direction, q); }

  /// The largest level that crosses a face and changes the neighbour; 0: none does.
  Level send(int face) {
    const std::int32_t other = m_body.elements.neighbour(m_brick, face);
    if (other < 0) return 0;
    alignas(64) Level own[kFaceVoxels];
    alignas(64) std::int32_t present[kFaceVoxels];
    take_face(m_levels, face, own);
    take_face(offsets(std::size_t(other)), opposite_face(face), present);
    look_up_face(face, std::size_t(other), is_high_face(face));
    std::int32_t largest = 0;
    for (int n = 0; n < kFaceVoxels; ++n) {
      const std::int32_t level = std::int32_t(own[n] - m_face_costs[n]);
      const std::int32_t there = std::int32_t(level_of(present[n], m_direction));
      largest = std::max(largest, level > there ? level : 0);
    }
    return Level(largest);
  }

 private:
  const std::int32_t* offsets(std::size_t brick) const { return m_values.brick_or_zero(brick); }
  const std::uint8_t* classes(std::size_t brick) const {
    return m_body.classes.data() + brick * kBrickVoxels;
  }

  /// Costs of the links across a face, for levels that travel towards higher or lower voxels.
  void look_up_face(int face, std::size_t other, bool upward) {
    const int axis = axis_of_face(face);
    const BrickTopology& elements = m_body.elements;
    std::uint64_t links = face_bits(elements.mask(m_brick), face) &
                          face_bits(elements.mask(other), opposite_face(face));
    const std::size_t low_brick = is_high_face(face) ? m_brick : other;
    const LinkCuts::BrickCuts* cuts = m_body.cuts.brick(low_brick);
    if (cuts != nullptr) links &= ~face_bits((*cuts)[axis], 2 * axis + 1);
    alignas(64) std::uint8_t own[kFaceVoxels], others[kFaceVoxels];
    take_face(classes(m_brick), face, own);
    take_face(classes(other), opposite_face(face), others);
    look_up_face_costs(m_costs.row(axis, upward), m_costs.stride(), own, others, links,
                       m_face_costs);
  }

  const Body& m_body;
  const LinkCosts& m_costs;
  const BrickValues& m_values;
  const Direction m_direction;
  const std::size_t m_brick;
  alignas(64) Level m_levels[kBrickVoxels];
  alignas(64) Level m_face_costs[kFaceVoxels];
};

/// Bricks of one phase share no link: face neighbours differ in parity; where diagonals lead across
/// edges and corners, all neighbours differ in the parity of some coordinate.
int phase_of(const Vec3i& origin, int links) {
  const int i = origin.x >> 3 & 1, j = origin.y >> 3 & 1, k = origin.z >> 3 & 1;
  return links == 6 ? i ^ j ^ k : 4 * i + 2 * j + k;
}

}  // namespace

BlockPropagator::BlockPropagator(const Body& body)
    : m_body(body), m_waiting(body.elements.brick_count()) {}

/// Finds the neighbours of all bricks, where links lead across edges and corners.
void BlockPropagator::find_neighbours() {
  if (m_body.slacks.links() == 6 || !m_neighbours.empty()) return;
  m_neighbours.resize(m_body.elements.brick_count());
  parallel_for(m_neighbours.size(), Grain{256},
               [&](std::size_t b) { m_neighbours[b] = neighbours_of(m_body.elements, b); });
}

int BlockPropagator::seeded() const {
  return m_body.slacks.links() == 6 ? BrickVisit::kSeeded : DiagonalVisit::kSeeded;
}

const LinkCosts& BlockPropagator::costs_of(const PropagationTask& task) {
  LinkCosts& costs = m_costs[task.coordinate][task.direction == Direction::lower];
  if (costs.empty()) costs = LinkCosts(m_body.slacks, task.coordinate, task.direction);
  return costs;
}

void BlockPropagator::start(const PropagationTask& task, Level first, int bucket_shift) {
  if (m_running) forget_waiting();
  m_running = true;
  costs_of(task);
  find_neighbours();
  task.values.resize(m_body.elements.brick_count());
  m_queue.reset(std::int32_t(first), true, bucket_shift);
}

void BlockPropagator::run(const PropagationTask& task, const std::vector<Seed>& seeds,
                          int bucket_shift, PropagationCounts& counts) {
  Level first = 0;
  for (const Seed& seed : seeds) first = std::max(first, level_of(seed.value, task.direction));
  start(task, first, bucket_shift);
  set_seeds(task, seeds);
  drain(task, counts);
}

/// Sets the seeds, neighbouring ones of one brick together.
void BlockPropagator::set_seeds(const PropagationTask& task, const std::vector<Seed>& seeds) {
  for (std::size_t n = 0; n < seeds.size();) {
    const std::size_t brick = seeds[n].slot / kBrickVoxels;
    const std::int32_t* present = task.values.brick_or_zero(brick);
    std::int32_t* values = nullptr;  // the same, once one of them changes
    Level largest = 0;
    for (; n < seeds.size() && seeds[n].slot / kBrickVoxels == brick; ++n) {
      const Seed& seed = seeds[n];
      const Level level = level_of(seed.value, task.direction);
      const Level before = level_of(present[seed.slot % kBrickVoxels], task.direction);
      if (level > before && values == nullptr) {
        if (task.undo != nullptr) task.undo->before_change(brick, task.values);
        present = values = task.values.touch(brick);
      }
      if (level > before) values[seed.slot % kBrickVoxels] = seed.value;
      if (level >= before) largest = std::max(largest, level);
    }
    if (largest > 0) wait(brick, largest, seeded());
  }
}

void BlockPropagator::close(const PropagationTask& task, int bucket_shift,
                            PropagationCounts& counts) {
  find_neighbours();
  // Bricks at rest matter only beside stored ones.
  std::vector<Level> largest(m_body.elements.brick_count(), 0);
  Level first = 0;
  for (std::size_t b = 0; b < largest.size(); ++b) {
    const std::int32_t* q = task.values.brick(b);
    if (q == nullptr) continue;
    for_each_active(m_body.elements.mask(b), [&](int offset) {
      largest[b] = std::max(largest[b], level_of(q[offset], task.direction));
    });
    const auto touch = [&](std::int32_t other) {
      if (other >= 0) largest[other] = std::max(largest[other], kLevelBias);
    };
    if (m_body.slacks.links() == 6) {
      for (int face = 0; face < 6; ++face) touch(m_body.elements.neighbour(b, face));
    } else {
      for (const std::int32_t other : m_neighbours[b]) touch(other);
    }
    first = std::max({first, largest[b], kLevelBias});
  }
  start(task, first, bucket_shift);
  for (std::size_t b = 0; b < largest.size(); ++b) {
    if (largest[b] != 0) wait(b, largest[b], seeded());
  }
  drain(task, counts);
}

/// Lets a brick wait for what enters by a neighbour or was set inside; a larger level moves it
/// forward.
void BlockPropagator::wait(std::size_t brick, Level level, int entrance) {
  Waiting& waiting = m_waiting[brick];
  waiting.entrances |= 1u << entrance;
  if (level <= waiting.level) return;
  waiting.level = level;
  m_queue.push(Slot(brick), std::int32_t(level));
}

void BlockPropagator::drain(const PropagationTask& task, PropagationCounts& counts) {
  const int links = m_body.slacks.links();
  while (m_queue.take_bucket(m_round)) {
    if (task.progress != nullptr && task.progress->cancelled()) throw Cancelled();
    for (const QueueEntry& entry : m_round) {
      // A larger level has moved the brick forward, or it was visited already.
      if (m_waiting[entry.slot].level != Level(entry.value)) continue;
      m_phases[phase_of(m_body.elements.origin(entry.slot), links)].push_back(entry.slot);
    }
    for (auto& bricks : m_phases) {
      if (bricks.empty()) continue;
      counts.visits += std::int64_t(bricks.size());
      if (links == 6) {
        visit_phase<BrickVisit>(task, bricks);
      } else {
        visit_phase<DiagonalVisit>(task, bricks);
      }
      bricks.clear();
    }
  }
  m_running = false;
  counts.max_queue = std::max(counts.max_queue, std::int64_t(m_queue.max_size()));
}

/// Forgets the bricks that wait after a run that an exception ended.
void BlockPropagator::forget_waiting() {
  std::fill(m_waiting.begin(), m_waiting.end(), Waiting{});
  for (auto& bricks : m_phases) bricks.clear();
}

/// Visits bricks of one phase; only the last loop depends on their order.
template <class Visit>
void BlockPropagator::visit_phase(const PropagationTask& task, std::vector<std::uint32_t>& bricks) {
  const VisitContext context = {m_body, costs_of(task), task, m_neighbours};
  for (const std::uint32_t brick : bricks) {
    if (task.undo != nullptr) task.undo->before_change(brick, task.values);
    task.values.touch(brick);
  }
  constexpr int kNeighbours = Visit::kNeighbours;
  m_outgoing.resize(bricks.size() * kNeighbours);
  const auto visit = [&](std::size_t n) {
    const std::size_t brick = bricks[n];
    const unsigned entered = m_waiting[brick].entrances;
    m_waiting[brick] = {};
    Visit here(context, brick);
    for (int side = 0; side < kNeighbours; ++side) {
      if (entered >> side & 1) here.draw(side);
    }
    here.close();
    const unsigned changed = here.store(task.values.touch(brick));
    const unsigned leaving = entered >> Visit::kSeeded & 1 ? ~0u : changed;
    Level* const outgoing = m_outgoing.data() + n * kNeighbours;
    for (int side = 0; side < kNeighbours; ++side) {
      outgoing[side] = leaving >> side & 1 ? here.send(side) : 0;
    }
  };
  if (bricks.size() < kParallelBricks || threads_here() == 1) {
    for (std::size_t n = 0; n < bricks.size(); ++n) visit(n);
  } else {
    parallel_for(bricks.size(), Grain{kBricksPerTask}, visit);
  }
  for (std::size_t n = 0; n < bricks.size(); ++n) {
    const Level* const outgoing = m_outgoing.data() + n * kNeighbours;
    for (int side = 0; side < kNeighbours; ++side) {
      if (outgoing[side] == 0) continue;
      wait(Visit::neighbour(context, bricks[n], side), outgoing[side], Visit::opposite(side));
    }
  }
}

std::size_t BlockPropagator::bytes() const {
  std::size_t total = m_neighbours.capacity() * sizeof(BrickNeighbours) +
                      m_waiting.capacity() * sizeof(Waiting) + m_queue.bytes() +
                      m_round.capacity() * sizeof(QueueEntry) +
                      m_outgoing.capacity() * sizeof(Level);
  for (const auto& bricks : m_phases) total += bricks.capacity() * sizeof(std::uint32_t);
  for (const auto& coordinate : m_costs) {
    for (const LinkCosts& costs : coordinate) total += costs.bytes();
  }
  return total;
}

}  // namespace supple
