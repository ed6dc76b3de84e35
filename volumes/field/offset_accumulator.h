// Collects the solutions of an inversion from many threads into bricks on the output lattice.
//
// Where several source cells reach a node the smallest |o| stays, then the lexicographically
// smallest o, which is the lowest source position. That order is total, so the result does not
// depend on who comes first. Cost: 6 kB per output brick, one uncontended lock per run of nodes
// in a brick.
#pragma once

#include <vector>

#include <tbb/spin_mutex.h>

#include "volumes/field/source_cells.h"

namespace supple {

class OffsetAccumulator {
 public:
  struct Hit {
    Vec3i node;
    Vec3f o;
  };

  /// `origins`: sorted, unique origins of all output bricks that a node may fall into.
  explicit OffsetAccumulator(std::vector<Vec3i> origins);

  /// Thread-safe. The hits must lie in the output bricks.
  void merge(const std::vector<Hit>& hits);
  /// Thread-safe: o = 0 at the corners of the given cells of the brick at `origin`.
  void merge_zeros(const Vec3i& origin, const BrickMask& cells);

  /// Thread-safe: whether the node has a solution by now.
  bool contains(const Vec3i& node);

  /// Nodes with a solution; call once, after all merging.
  VectorBricks finish();

 private:
  void merge_zero_mask(std::int32_t b, const BrickMask& nodes);

  BrickTopology m_bricks;
  std::vector<Vec3f> m_vectors;
  std::vector<BrickMask> m_valid;
  std::vector<tbb::spin_mutex> m_locks;
};

}  // namespace supple
