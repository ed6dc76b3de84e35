#include "lib/chainmail/mesh_values.h"

#include <algorithm>
#include <cstdlib>

#include "lib/chainmail/flat_engine.h"

namespace supple {

MeshValues::MeshValues(const MeshLinks& links, int coordinate)
    : m_links(links),
      m_coordinate(coordinate),
      m_q(links.node_count(), 0),
      m_is_changed(links.node_count(), 0) {}

PropagationCounts MeshValues::run(Direction direction, const std::vector<Seed>& seeds,
                                  Progress* progress) {
  PropagationCounts counts;
  FlatEngine<MeshValues>(m_queue).run(*this, direction, seeds, m_links.bucket_shift(m_coordinate),
                                      progress, counts);
  return counts;
}

std::int64_t MeshValues::project(const std::vector<Slot>& anchored, Progress* progress) {
  std::vector<Seed> present(m_q.size());
  for (Slot node = 0; node < m_q.size(); ++node) present[node] = {node, m_q[node]};
  run(Direction::raise, present, progress);
  std::vector<Seed> held;
  for (const Slot node : anchored) held.push_back(present[node]);
  std::vector<std::int32_t> above = m_q;
  run(Direction::lower, held, progress);
  std::vector<std::int32_t> above_held = m_q;
  roll_back();
  run(Direction::lower, present, progress);
  const std::vector<std::int32_t> below = m_q;
  run(Direction::raise, held, progress);
  // Held nodes keep their places where the links allow it, as for voxel bodies (project.cpp).
  const bool can_hold = std::all_of(held.begin(), held.end(), [&](const Seed& seed) {
    return above_held[seed.slot] == seed.value && m_q[seed.slot] == seed.value;
  });
  if (can_hold) {
    above.swap(above_held);
  } else {
    m_q = below;
  }
  std::int64_t largest = 0;
  for (Slot node = 0; node < m_q.size(); ++node) {
    const std::int64_t sum = std::int64_t(above[node]) + m_q[node];
    m_q[node] = std::int32_t(sum >= 0 ? sum / 2 : -((1 - sum) / 2));
    largest = std::max(largest, std::abs(std::int64_t(m_q[node]) - present[node].value));
  }
  forget();
  return largest;
}

void MeshValues::roll_back() {
  for (const Change& change : m_changes) m_q[change.node] = change.before;
  forget();
}

void MeshValues::forget() {
  for (const Change& change : m_changes) m_is_changed[change.node] = 0;
  m_changes.clear();
}

std::size_t MeshValues::bytes() const {
  return m_q.capacity() * sizeof(std::int32_t) + m_is_changed.capacity() +
         m_changes.capacity() * sizeof(Change) + m_queue.bytes();
}

}  // namespace supple
