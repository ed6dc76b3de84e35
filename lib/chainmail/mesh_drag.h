// One coordinate of a drag of a mesh body (drag_algebra.h), with nodes for voxels and without holds
// of earlier drags.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lib/chainmail/drag_algebra.h"
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

class MeshDrag : public DragAlgebra<MeshDrag> {
 public:
  /// The destructor rolls the values back unless commit() was called. `values` has no changes yet;
  /// `held` must outlive the drag.
  MeshDrag(MeshValues& values, const HeldNodes& held, Progress* progress);
  ~MeshDrag();
  MeshDrag(const MeshDrag&) = delete;
  MeshDrag& operator=(const MeshDrag&) = delete;

  /// Keeps the result, and the list of changes for the caller to read and forget.
  void commit() { m_committed = true; }

  const MeshValues& values() const { return m_values; }
  const PropagationCounts& counts() const { return m_counts; }

 private:
  friend DragAlgebra<MeshDrag>;
  bool is_edge(std::size_t) const { return false; }
  bool let_edges_yield(Direction, std::int32_t) { return false; }
  std::size_t handle_count() const { return m_held.handles.size(); }
  template <class Visit>
  void for_each_target(std::size_t handle, Direction direction, Visit&& visit) const;
  std::int64_t excess_of_held(Direction direction) const;
  std::vector<Seed> pulled_back(Direction direction, std::int32_t shift);
  void propagate(Direction direction, const std::vector<Seed>& seeds);
  void roll_back() { m_values.roll_back(); }
  [[noreturn]] void throw_conflict(const Target& above, const Target& below,
                                   std::int64_t missing) const;

  MeshValues& m_values;
  const HeldNodes& m_held;
  /// Offsets before the drag, of each handle's nodes and of the fixed ones.
  std::vector<std::vector<std::int32_t>> m_handle_starts;
  std::vector<std::int32_t> m_fixed_starts;
  bool m_committed = false;
  Progress* m_progress;
  PropagationCounts m_counts;
};

extern template class DragAlgebra<MeshDrag>;

}  // namespace supple
