#include "lib/chainmail/propagate.h"

#include <algorithm>

#include "lib/body/diagonals.h"
#include "lib/body/link_masks.h"
#include "lib/chainmail/flat_engine.h"

namespace supple {

namespace {

/// One coordinate of a voxel body: values in bricks, neighbours by the links of a slot.
class LatticeGraph {
 public:
  LatticeGraph(const Body& body, const PropagationTask& task) : m_body(body), m_task(task) {}

  std::int32_t value(Slot slot) const { return m_task.values.at(slot); }

  void set(Slot slot, std::int32_t value) {
    if (m_task.undo != nullptr) m_task.undo->before_change(slot / kBrickVoxels, m_task.values);
    m_task.values.set(slot, value);
  }

  template <bool kRaise, class Visit>
  void for_each_link(Slot from, Visit&& visit) const {
    const SlackTable& slacks = m_body.slacks;
    const std::uint8_t from_class = m_body.classes[from];
    if (slacks.links() != 6) {
      for_each_linked(m_body.elements, m_body.cuts, slacks.links(), from,
                      [&](int direction, Slot to) {
                        visit(to, [&] {
                          return slacks.fall(kRaise ? direction : opposite_direction(direction),
                                             m_task.coordinate, from_class, m_body.classes[to]);
                        });
                      });
      return;
    }
    for (int axis = 0; axis < 3; ++axis) {
      for (const bool positive : {false, true}) {
        Slot to;
        if (!neighbour_slot(m_body.elements, m_body.cuts, from, axis, positive, to)) continue;
        visit(to, [&] {
          // Raising the low end lifts the high end once `lower` is used up; and so on, mirrored.
          const std::uint8_t to_class = m_body.classes[to];
          return kRaise == positive ? slacks.lower(axis, m_task.coordinate, from_class, to_class)
                                    : slacks.upper(axis, m_task.coordinate, from_class, to_class);
        });
      }
    }
  }

 private:
  const Body& m_body;
  const PropagationTask& m_task;
};

}  // namespace

void FlatPropagator::run(const PropagationTask& task, const std::vector<Seed>& seeds,
                         int bucket_shift, PropagationCounts& counts) {
  LatticeGraph graph(m_body, task);
  FlatEngine<LatticeGraph>(m_queue).run(graph, task.direction, seeds, bucket_shift, task.progress,
                                        counts);
}

namespace {

/// Fewer elements per brick than this, and visiting them one by one is faster.
constexpr std::int64_t kFlatElements = 24;

/// Bricks whose links are sampled to choose the bucket width.
constexpr std::size_t kSampledBricks = 16;

Engine fitting_engine(const BrickTopology& elements) {
  const std::int64_t bricks = std::int64_t(elements.brick_count());
  return elements.active_count() < kFlatElements * bricks ? Engine::flat : Engine::block;
}

/// The geometric mean of the sampled slacks, as a power of two: unmoved by a few very wide links.
int typical_slack_bits(const Body& body, int coordinate) {
  const std::size_t bricks = body.elements.brick_count();
  const std::size_t step = std::max<std::size_t>(1, bricks / kSampledBricks);
  std::int64_t sum_of_logs = 0, count = 0;
  for (std::size_t b = 0; b < bricks; b += step) {
    for_each_link(body.elements, body.cuts, b, [&](int axis, Slot low, Slot high) {
      const std::uint8_t low_class = body.classes[low], high_class = body.classes[high];
      for (const std::int32_t slack :
           {body.slacks.upper(axis, coordinate, low_class, high_class),
            body.slacks.lower(axis, coordinate, low_class, high_class)}) {
        if (slack == 0 || slack >= kUnlimitedSlack) continue;
        sum_of_logs += 31 - __builtin_clz(unsigned(slack));
        ++count;
      }
    });
  }
  return count == 0 ? kFixedBits : int(sum_of_logs / count);
}

/// True where a brick or one that its links lead to holds offsets.
bool near_stored(const BrickTopology& elements, const BrickValues& values, std::size_t b) {
  const BrickNeighbours bricks = neighbours_of(elements, b);
  return std::any_of(bricks.begin(), bricks.end(), [&](std::int32_t other) {
    return other >= 0 && values.brick(std::size_t(other)) != nullptr;
  });
}

/// Seeds every element that may have a broken link, at its value; only those that have one will
/// spread. Links between bricks that are not stored hold, since both ends are at rest.
std::vector<Seed> present_values(const Body& body, const BrickValues& values) {
  std::vector<Seed> seeds;
  for (std::size_t b = 0; b < body.elements.brick_count(); ++b) {
    if (!near_stored(body.elements, values, b)) continue;
    const std::int32_t* present = values.brick_or_zero(b);
    for_each_active(body.elements.mask(b), [&](int offset) {
      seeds.push_back({Slot(b * kBrickVoxels + std::size_t(offset)), present[offset]});
    });
  }
  return seeds;
}

/// True where seeds are within the range, the only offsets that levels of the block engine hold.
bool within_range(const std::vector<Seed>& seeds) {
  return std::all_of(seeds.begin(), seeds.end(), [](const Seed& seed) {
    return seed.value >= -kMaxOffset && seed.value <= kMaxOffset;
  });
}

}  // namespace

const char* name_of(Engine engine) {
  return engine == Engine::block ? "block" : engine == Engine::flat ? "flat" : "automatic";
}

Propagator::Propagator(const Body& body, Engine engine, int bucket_shift)
    : m_body(body),
      m_engine(engine == Engine::automatic ? fitting_engine(body.elements) : engine),
      m_block(body),
      m_flat(body),
      m_bucket_shift(bucket_shift) {}

/// Buckets of the flat engine are a quarter of a typical slack wide: narrow enough that few labels
/// are corrected, wide enough that few are empty. Crossing a brick takes eight slacks; the block
/// engine gathers what is due within one.
int Propagator::bucket_shift(Engine engine, int coordinate) {
  if (m_bucket_shift >= 0) return m_bucket_shift;
  int& bits = m_slack_bits[coordinate];
  if (bits < 0) bits = typical_slack_bits(m_body, coordinate);
  return engine == Engine::block ? std::min(bits + 3, 30) : std::max(bits - 2, 0);
}

PropagationCounts Propagator::run(const PropagationTask& task, const std::vector<Seed>& seeds) {
  PropagationCounts counts;
  if (seeds.empty()) return counts;
  if (m_engine == Engine::block && within_range(seeds)) {
    m_block.run(task, seeds, bucket_shift(Engine::block, task.coordinate), counts);
  } else {
    m_flat.run(task, seeds, bucket_shift(Engine::flat, task.coordinate), counts);
  }
  return counts;
}

PropagationCounts Propagator::close(const PropagationTask& task) {
  PropagationCounts counts;
  const int shift = bucket_shift(m_engine, task.coordinate);
  if (m_engine == Engine::block) {
    m_block.close(task, shift, counts);
  } else {
    m_flat.run(task, present_values(m_body, task.values), shift, counts);
  }
  return counts;
}

}  // namespace supple
