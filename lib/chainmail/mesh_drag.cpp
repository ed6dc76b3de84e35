#include "lib/chainmail/mesh_drag.h"

#include <algorithm>
#include <string>

#include "lib/state/state.h"
#include "volumes/base/error.h"

namespace supple {

MeshDrag::MeshDrag(MeshValues& values, const HeldNodes& held, Progress* progress)
    : m_values(values), m_held(held), m_progress(progress) {
  const auto starts_of = [&](const std::vector<Slot>& nodes) {
    std::vector<std::int32_t> starts;
    starts.reserve(nodes.size());
    for (const Slot node : nodes) starts.push_back(values.value(node));
    return starts;
  };
  for (const HeldNodes::Handle& handle : held.handles) {
    m_handle_starts.push_back(starts_of(handle.nodes));
  }
  m_fixed_starts = starts_of(held.fixed);
}

MeshDrag::~MeshDrag() {
  if (!m_committed) roll_back();
}

template <class Visit>
void MeshDrag::for_each_target(std::size_t h, Direction direction, Visit&& visit) const {
  const HeldNodes::Handle& handle = m_held.handles[h];
  const std::int32_t by = handle.by[std::size_t(m_values.coordinate())];
  const bool pushes_so = direction == Direction::raise ? by > 0 : by < 0;
  if (handle.is_push && !pushes_so) return;
  const std::int32_t part = scaled(by);
  for (std::size_t n = 0; n < handle.nodes.size(); ++n) {
    const Slot node = handle.nodes[n];
    visit(node, m_handle_starts[h][n] + part, m_values.value(node), by);
  }
}

void MeshDrag::propagate(Direction direction, const std::vector<Seed>& seeds) {
  const PropagationCounts counts = m_values.run(direction, seeds, m_progress);
  m_counts.visits += counts.visits;
  m_counts.max_queue = std::max(m_counts.max_queue, counts.max_queue);
}

std::int64_t MeshDrag::excess_of_held(Direction direction) const {
  const std::int64_t sign = direction == Direction::raise ? 1 : -1;
  std::int64_t excess = 0;
  for (std::size_t n = 0; n < m_held.fixed.size(); ++n) {
    const std::int64_t moved = std::int64_t(m_values.value(m_held.fixed[n])) - m_fixed_starts[n];
    excess = std::max(excess, sign * moved);
  }
  return excess;
}

std::vector<Seed> MeshDrag::pulled_back(Direction, std::int32_t shift) {
  roll_back();
  std::vector<Seed> seeds;
  for (std::size_t n = 0; n < m_held.fixed.size(); ++n) {
    seeds.push_back({m_held.fixed[n], m_fixed_starts[n] - shift});
  }
  return seeds;
}

void MeshDrag::throw_conflict(const Target& above, const Target& below,
                              std::int64_t missing) const {
  throw InputError(
      {"", "handles " + std::to_string(above.handle) + " and " + std::to_string(below.handle),
       "targets " + number_text(double(missing) / kFixedOne) + " mm further apart along " +
           "xyz"[m_values.coordinate()] + " than the links between nodes " +
           std::to_string(above.slot) + " and " + std::to_string(below.slot) + " allow",
       "handles that agree with each other"});
}

template class DragAlgebra<MeshDrag>;

}  // namespace supple
