#include "lib/chainmail/flat_propagate.h"

#include "lib/body/diagonals.h"
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

}  // namespace supple
