// Solves the cells of one source brick for the lattice nodes in reach: translated cells exactly,
// ordinary ones sixteen at a time (lane_solver.h), the rest one by one (deformed_cell.h). Every
// cell finds its own nodes, so the results of a brick depend on nothing but its cells.
#pragma once

#include "volumes/field/inversion/invert.h"
#include "volumes/field/inversion/lane_solver.h"

namespace supple {

/// Counts of one source brick.
struct BrickFindings {
  int cells = 0;
  int folded_cells = 0;
  int folded_air_cells = 0;
  double min_det = 1;  // of cells of tissue
};

/// Solves brick after brick. It holds scratch memory: one per thread.
class BrickSolver {
 public:
  /// `dims`: of the source volume. Both must outlive the solver.
  BrickSolver(const Vec3i& dims, const InvertParams& params) : m_dims(dims), m_params(params) {}

  /// Solves the cells and marks the folded ones; hits and doubts are in results() until the next
  /// call.
  BrickFindings solve(const SourceCells& cells, const CellContents& contents, BrickMask& folded);
  CellResults& results() { return m_results; }

  /// Bisects a cell around a node that is still without a solution: true when it has one, which is
  /// in results(). `covered`: it has none, and yet the cell's tetrahedra cover the node.
  bool settle(const VectorBricks& u, const OpenNode& doubt, const CellContents& contents,
              bool& covered);

 private:
  void translate_cell(const SourceCells& cells, int offset, const Vec3f& shift);
  void solve_cell(const CellCorners& corners, const Vec3i& cell, bool folded);
  void solve_borders(const SourceCells& cells, const CellContents& contents);
  void solve_beyond(const SourceCells& cells, int offset, const Vec3i& side);
  void set_contents(const SourceCells& cells, const CellContents& contents);
  void add_hit(const Vec3i& node, const Vec3d& source, const Vec3f& o);

  const Vec3i& m_dims;
  const InvertParams& m_params;
  LaneSolver m_lanes;
  CellResults m_results;
};

}  // namespace supple
