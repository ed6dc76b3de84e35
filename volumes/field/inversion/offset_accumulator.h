// Collects the solutions of an inversion from many threads into bricks on the output lattice.
//
// Where several source cells reach a node, tissue stays before its surface and that before air,
// then the smallest |o|, then the lexicographically smallest o, which is the lowest source
// position. That order is total, so the result does not depend on who comes first. Cost: 6 kB per
// output brick with an offset other than 0, one uncontended lock per run of nodes in a brick, 16
// bytes per solution of tissue that did not stay.
#pragma once

#include <vector>

#include "volumes/base/parallel.h"
#include "volumes/field/inversion/source_cells.h"

namespace supple {

/// A node in the box of a cell for which the quick solve could not decide.
struct OpenNode {
  Vec3i node;
  Vec3i cell;
  Content content = Content::tissue;  // the best that the cell could give
};

class OffsetAccumulator {
 public:
  struct NodeSolution {
    Vec3i node;
    Vec3f o;
    Content content = Content::tissue;
  };

  /// `origins`: sorted, unique origins of the output bricks; solutions in others are dropped.
  explicit OffsetAccumulator(std::vector<Vec3i> origins);

  /// Merges solutions; thread-safe.
  void merge(const std::vector<NodeSolution>& hits);
  /// The same for nodes within a box, faster; drops the doubts that holds() settles by now.
  void merge(const IndexBox& reach, const std::vector<NodeSolution>& hits,
             std::vector<OpenNode>& doubts);
  /// Thread-safe: o = 0 at the corners of the given cells of the brick at `origin`, where there are
  /// output bricks.
  void merge_zeros(const Vec3i& origin, const BrickMask& cells, const CellContents& contents);

  /// The output bricks, marked by their lowest voxel.
  const BrickTopology& bricks() const { return m_bricks; }
  /// True when a node of the box falls into an output brick.
  bool is_reached_by(const IndexBox& reach) const;

  /// True if the node has a solution by now, of such a content at least; thread-safe.
  bool holds(const Vec3i& node, Content content);

  /// Nodes to which tissue has come from several places, more than half a voxel apart; after all
  /// merging.
  BrickTopology overlaps() const;

  /// Nodes with a solution; call once, after all merging.
  VectorBricks finish();

 private:
  /// Nodes of a brick that have a solution, and its content: at least the surface of tissue, or its
  /// inside.
  struct Taken {
    BrickMask any{}, surface{}, tissue{};
  };
  struct Loser {
    int offset;
    Vec3f o;
  };
  bool has_taken(std::int32_t b, int offset, Content content) const;
  void take(std::int32_t b, const NodeSolution& hit);
  void put(std::int32_t b, int offset, const Vec3f& o);
  void merge_zero_nodes(std::int32_t b, const Taken& zeros);

  BrickTopology m_bricks;
  BrickVectors m_vectors;
  SpinMutex m_storing;  // held while a brick is added to m_vectors
  std::vector<Taken> m_taken;
  std::vector<std::vector<Loser>> m_losers;  // of tissue that came to a node beside other tissue
  std::vector<SpinMutex> m_locks;
};

}  // namespace supple
