// Collects the solutions of an inversion from many threads into bricks on the output lattice.
//
// Where several source cells reach a node the smallest |o| stays, then the lexicographically
// smallest o, which is the lowest source position. That order is total, so the result does not
// depend on who comes first. Cost: 6 kB per output brick, one uncontended lock per run of nodes
// in a brick.
#pragma once

#include <vector>

#include <tbb/spin_mutex.h>

#include "volumes/field/inversion/source_cells.h"

namespace supple {

/// A node in the box of a cell for which the quick solve could not decide.
struct OpenNode {
  Vec3i node;
  Vec3i cell;
};

class OffsetAccumulator {
 public:
  struct NodeSolution {
    Vec3i node;
    Vec3f o;
  };

  /// `origins`: sorted, unique origins of the output bricks; what falls into others is dropped.
  explicit OffsetAccumulator(std::vector<Vec3i> origins);

  /// Thread-safe.
  void merge(const std::vector<NodeSolution>& hits);
  /// The same for nodes within a box, faster; drops the doubts whose node has a solution by now.
  void merge(const IndexBox& reach, const std::vector<NodeSolution>& hits,
             std::vector<OpenNode>& doubts);
  /// Thread-safe: o = 0 at the corners of the given cells of the brick at `origin`, where there are
  /// output bricks.
  void merge_zeros(const Vec3i& origin, const BrickMask& cells);

  /// True when a node of the box falls into an output brick.
  bool is_reached_by(const IndexBox& reach) const;

  /// Thread-safe: whether the node has a solution by now.
  bool contains(const Vec3i& node);

  /// Nodes with a solution; call once, after all merging.
  VectorBricks finish();

 private:
  void take(std::int32_t b, const NodeSolution& hit);
  void merge_zero_mask(std::int32_t b, const BrickMask& nodes);

  BrickTopology m_bricks;
  std::vector<Vec3f> m_vectors;
  std::vector<BrickMask> m_valid;
  std::vector<tbb::spin_mutex> m_locks;
};

}  // namespace supple
