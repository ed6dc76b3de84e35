// One coordinate of a drag of a mesh body: targets, envelopes, conflicts and the part that anchors
// allow. The algebra is that of coordinate_drag.h, with nodes for voxels and without holds of
// earlier drags:
//   two-sided handle     in A and B   l = u = q + f D
//   push handle          in A (D > 0) or B (D < 0)
//   anchor               in A and B   l = u = q
// where A has lower bounds l and B upper bounds u, which are met iff l_a - u_b <= dist(a, b).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lib/chainmail/fraction.h"
#include "lib/chainmail/mesh_values.h"
#include "volumes/base/progress.h"

namespace supple {

/// Nodes of a drag; no node is in two sets or in one twice.
struct HeldNodes {
  struct Handle {
    std::vector<Slot> nodes;
    std::array<std::int32_t, 3> by;  // 2^-16 mm
    bool is_push;
  };
  std::vector<Handle> handles;
  std::vector<Slot> fixed;
};

class MeshDrag {
 public:
  /// The destructor rolls the values back unless commit() was called. `values` has no changes yet.
  MeshDrag(MeshValues& values, const HeldNodes& held, Progress* progress);
  ~MeshDrag();
  MeshDrag(const MeshDrag&) = delete;
  MeshDrag& operator=(const MeshDrag&) = delete;

  /// Moves the handles by the whole and tightens `fraction` by the anchors. Throws InputError when
  /// handles contradict each other, whatever the anchors say.
  void try_whole(Fraction& fraction);
  /// Starts over and moves the handles by that part.
  void redo(const Fraction& fraction);
  /// Keeps the result, and the list of changes for the caller to read and forget.
  void commit() { m_committed = true; }

  const MeshValues& values() const { return m_values; }
  const PropagationCounts& counts() const { return m_counts; }

 private:
  /// A node of a handle, where it was before the drag, and what it is to move by.
  struct Bound {
    Slot node;
    std::int32_t at, by;
    std::size_t handle;
  };
  struct Anchor {
    Slot node;
    std::int32_t at;
  };

  const std::vector<Bound>& bounds(Direction direction) const {
    return direction == Direction::raise ? m_lower : m_upper;
  }
  std::int32_t target(const Bound& bound) const { return bound.at + m_fraction.scale(bound.by); }
  void propagate(Direction direction, const std::vector<Seed>& seeds);
  /// Up to L, then down to U; how far anchors were moved each way.
  void solve();
  std::int64_t excess_of_anchors(Direction direction) const;
  void limit_by_anchors(Direction direction, std::int64_t excess, Fraction& fraction);
  void require_agreement();
  [[noreturn]] void report_conflict(const Bound& above, std::int64_t missing);

  MeshValues& m_values;
  std::vector<Bound> m_lower, m_upper;
  std::vector<Anchor> m_anchors;
  std::int64_t m_excess_up = 0, m_excess_down = 0;
  Fraction m_fraction;  // of the targets
  bool m_committed = false;
  Progress* m_progress;
  PropagationCounts m_counts;
};

}  // namespace supple
