// The inversion of one displacement after the other on the same source bricks: of all bricks at
// once, or of those that a change touches. The contents of an output brick depend on the source
// bricks that reach it and on nothing else, so both ways end with the same bits.
#pragma once

#include <unordered_map>

#include "volumes/field/inversion/brick_solver.h"
#include "volumes/field/inversion/displacement_range.h"
#include "volumes/field/inversion/offset_accumulator.h"
#include "volumes/grid/voxel_sets.h"

namespace supple {

class Inversion {
 public:
  Inversion(const Vec3i& dims, const InvertParams& params);

  /// All offsets of u.
  VectorBricks solve(const VectorBricks& u, Progress* progress);

  /// The offsets in `touched`: the sorted output bricks that cells with a corner in one of the
  /// `changed` bricks of u reach, now or before. The topology of u is that of the last solve().
  /// False, and nothing has happened, when a brick is torn: then all has to be solved.
  bool solve_changed(const VectorBricks& u, const std::vector<std::int32_t>& changed,
                     std::vector<Vec3i>& touched, VectorBricks& offsets);

  /// Folded cells per brick of u.
  const std::vector<BrickMask>& folded() const { return m_folded; }
  /// Nodes that tissue from several places covers.
  BrickTopology overlaps() const;
  /// All but the residuals and the hidden elements.
  InversionCertificate certificate() const;

 private:
  struct Worker;
  void classify(const VectorBricks& u, const std::vector<std::int32_t>& bricks);
  void place(const VectorBricks& u, const std::vector<std::int32_t>& bricks);
  VectorBricks solve_bricks(const VectorBricks& u, const std::vector<std::int32_t>& bricks,
                            OffsetAccumulator& accumulator, Progress* progress);
  void solve_brick(const VectorBricks& u, std::size_t b, OffsetAccumulator& accumulator,
                   Worker& worker);
  void settle(const VectorBricks& u, const std::vector<OpenNode>& doubts,
              OffsetAccumulator& accumulator);

  CellContents contents_of(const Vec3i& origin) const;

  const Vec3i m_dims;
  const InvertParams m_params;
  BrickTopology m_slice;  // of a volume of one slice, its elements, thickened
  // Per source brick: how far its voxels move, the nodes that its cells reach, whether u = 0 at all
  // corners of the cells, and the findings about them.
  std::vector<BrickRanges> m_ranges;
  std::vector<IndexBox> m_reach;
  std::vector<std::uint8_t> m_still;
  std::vector<BrickFindings> m_findings;
  std::vector<BrickMask> m_folded;
  std::vector<Vec3i> m_unresolved;                             // sorted
  std::unordered_map<Vec3i, BrickMask, VoxelHash> m_overlaps;  // by output brick
};

}  // namespace supple
