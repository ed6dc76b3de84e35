// One coordinate of a drag of voxels (drag_algebra.h), on bricks that keep their former values for
// undoing.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/chainmail/drag_algebra.h"
#include "lib/chainmail/free_pieces.h"
#include "lib/chainmail/held_voxels.h"

namespace supple {

class CoordinateDrag : public DragAlgebra<CoordinateDrag> {
 public:
  /// Gives the coordinate its table of bricks if it never moved; the destructor rolls back unless
  /// commit() was called. `undo` must be empty, and `pieces` are those that `held` leaves free.
  /// Edges among the handles that are held may yield: their displacements become the ones
  /// performed.
  CoordinateDrag(Body& body, int coordinate, HeldVoxels& held, const FreePieces& pieces,
                 Propagator& propagator, UndoLog& undo, Progress* progress);
  ~CoordinateDrag();
  CoordinateDrag(const CoordinateDrag&) = delete;
  CoordinateDrag& operator=(const CoordinateDrag&) = delete;

  /// Keeps the result.
  void commit();

  int coordinate() const { return m_coordinate; }
  const UndoLog& undo() const { return m_undo; }
  const BrickValues& values() const { return m_values; }
  const PropagationCounts& counts() const { return m_counts; }

 private:
  friend DragAlgebra<CoordinateDrag>;
  std::size_t handle_count() const { return m_held.handles.size(); }
  bool is_edge(std::size_t handle) const {
    return m_held.handles[handle].source->is_edge && m_held.handles[handle].is_push();
  }
  bool let_edges_yield(Direction direction, std::int32_t furthest);
  template <class Visit>
  void for_each_target(std::size_t handle, Direction direction, Visit&& visit) const;
  std::int64_t excess_of_held(Direction direction) const;
  std::vector<Seed> pulled_back(Direction direction, std::int32_t shift);
  void propagate(Direction direction, const std::vector<Seed>& seeds);
  void run(Direction direction, const std::vector<Seed>& seeds);
  void roll_back() { m_undo.roll_back(m_values); }
  [[noreturn]] void throw_conflict(const Target& above, const Target& below,
                                   std::int64_t missing) const;

  /// Calls `visit(slot, limit)` for the held elements of a brick that may not rise above their
  /// limit (raise) or sink below it (lower).
  template <class Visit>
  void for_each_held(std::size_t brick, Direction direction, Visit&& visit) const;
  const std::vector<Bound>& held_bounds(Direction direction) const;

  Body& m_body;
  const int m_coordinate;
  HeldVoxels& m_held;
  const FreePieces& m_pieces;
  BrickValues& m_values;
  bool m_committed = false;
  UndoLog& m_undo;
  Propagator& m_propagator;
  Progress* m_progress;
  PropagationCounts m_counts;
};

extern template class DragAlgebra<CoordinateDrag>;

}  // namespace supple
