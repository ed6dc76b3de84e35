// The inversion of a brick's cells in single precision, sixteen at a time: the same equation and
// the same bounds as deformed_cell.h, which stays the authority for cells that the lanes decline.
//
// Coordinates are relative to each cell and to one whole-voxel shift of its brick, so that floats
// resolve 10^-6 voxel whatever the displacement. Cells that are folded, nearly flat or stretched
// beyond kMaxEdge voxels are declined, and so are translated ones, which have an exact answer. A
// result depends on its own cell and node only, never on the lanes beside it.
// Cost: about 10 ns per cell and 8 ns per node in reach of it (one core, AVX-512).
#pragma once

#include <memory>
#include <vector>

#include "volumes/field/inversion/offset_accumulator.h"
#include "volumes/field/inversion/source_cells.h"

namespace supple {

/// Findings of a solver about the cells of one brick.
struct CellResults {
  std::vector<OffsetAccumulator::NodeSolution> hits;
  std::vector<OpenNode> doubts;
  BrickMask still{};     // cells of which no corner moved: o = 0 at all eight
  BrickMask suspects{};  // cells that lanes have solved, which may fold between their corners
};

class LaneSolver {
 public:
  LaneSolver();
  ~LaneSolver();

  /// Cells that were declined; hits and doubts of the others are appended to `results`, and
  /// `min_det` becomes the smallest det F at the corners of those of tissue when that is smaller.
  BrickMask solve(const SourceCells& cells, const BrickMask& tissue_cells, double tolerance_voxels,
                  CellResults& results, double& min_det);

 private:
  struct Scratch;
  std::unique_ptr<Scratch> m_scratch;
};

}  // namespace supple
