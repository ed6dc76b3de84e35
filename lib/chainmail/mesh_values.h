// One coordinate of a mesh body's offsets: a graph for the flat engine, with the values before the
// first change of each node, for undoing and counting. Memory: 5 bytes per node, 8 per change.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/chainmail/bucket_queue.h"
#include "lib/chainmail/mesh_links.h"
#include "lib/chainmail/propagation.h"

namespace supple {

class MeshValues {
 public:
  /// Values at rest. The links must outlive this.
  MeshValues(const MeshLinks& links, int coordinate);

  struct Change {
    Slot node;
    std::int32_t before;
  };

  std::int32_t value(Slot node) const { return m_q[node]; }
  void set(Slot node, std::int32_t value) {
    if (!m_is_changed[node]) {
      m_is_changed[node] = 1;
      m_changes.push_back({node, m_q[node]});
    }
    m_q[node] = value;
  }
  /// Sets a value for good: nothing is to be undone.
  void place(Slot node, std::int32_t value) { m_q[node] = value; }
  /// Visits links as flat_engine.h asks of a graph.
  template <bool kRaise, class Visit>
  void for_each_link(Slot from, Visit&& visit) const {
    for (std::size_t n = m_links.first(from), end = m_links.first(from + 1); n < end; ++n) {
      const MeshStep& step = m_links.step(m_coordinate, n);
      visit(step.to, [&] { return kRaise ? step.out : step.in; });
    }
  }

  /// One-sided propagation to the envelope of the seeds. Throws Cancelled.
  PropagationCounts run(Direction direction, const std::vector<Seed>& seeds, Progress* progress);
  /// Replaces invalid values by floor((L + U) / 2), L the least valid majorant and U the greatest
  /// valid minorant (project.cpp). Returns the largest move. Throws Cancelled, with values that
  /// mean nothing.
  std::int64_t project(const std::vector<Slot>& anchored, Progress* progress);

  /// Nodes that were set, each once, in order of their first change.
  const std::vector<Change>& changes() const { return m_changes; }
  /// Puts every value back and forgets the changes.
  void roll_back();
  /// Forgets the changes.
  void forget();

  int coordinate() const { return m_coordinate; }
  std::size_t bytes() const;

 private:
  const MeshLinks& m_links;
  int m_coordinate;
  std::vector<std::int32_t> m_q;
  std::vector<char> m_is_changed;
  std::vector<Change> m_changes;
  BucketQueue m_queue{2048};
};

}  // namespace supple
