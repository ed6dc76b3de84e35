// Folded cells of vectors on a grid that come slice by slice, in ascending order: a cell folds
// where det F = det(I + grad v) is 0 or below somewhere in it (cell_corners.h).
// Cost: 30 ns per cell and core; two slices of memory.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "volumes/base/progress.h"
#include "volumes/field/dense/resample.h"
#include "volumes/geometry/geometry.h"

namespace supple {

class GridFolds {
 public:
  explicit GridFolds(const Geometry& grid);

  /// The vectors of slice k, mm; slice 0 first.
  void add(int k, const Vec3f* vectors_mm);
  std::int64_t folded_cells() const { return m_folded; }
  /// The smallest det F at the corners of cells; 1 before two slices were there.
  double smallest_det() const { return m_smallest_det; }

 private:
  Geometry m_grid;
  std::vector<Vec3f> m_below, m_here;  // index vectors
  std::int64_t m_folded = 0;
  double m_smallest_det = 1;
};

/// The slices, of which the counter hears while they are asked for. It must outlive them.
VectorSliceSource counted(VectorSliceSource slices, GridFolds& folds);

/// The folds of all slices, or of the first ones with as many folded cells as `enough`.
GridFolds folds_of(const Geometry& grid, const VectorSliceSource& slices, const Progress* progress,
                   std::int64_t enough = std::numeric_limits<std::int64_t>::max());

}  // namespace supple
