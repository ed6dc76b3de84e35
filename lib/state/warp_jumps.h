// Smoothness of the vectors of a dense warp, found while it is
// written.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "volumes/field/dense/resample.h"

namespace supple {

/// Vectors in LPS mm of a grid, slice after slice from the first.
class WarpJumps {
 public:
  explicit WarpJumps(const Geometry& grid);
  void add(const Vec3f* slice);
  /// Stands in place of all slices: takes vectors in mm that are 0 but in these bricks.
  void add(const VectorBricks& vectors_mm);

  /// Largest length of the difference of two neighbours' vectors.
  double largest_mm() const { return m_largest_mm; }
  /// Pairs of neighbours whose order along their grid line x + v(x) turns round.
  std::int64_t folded_pairs() const { return m_folded; }

 private:
  void add_pair(const Vec3f& lower, const Vec3f& upper, int axis);

  Geometry m_grid;
  std::vector<Vec3f> m_below;  // empty before the first
  double m_largest_mm = 0;
  std::int64_t m_folded = 0;
};

/// The uses of a warp in resample direction with that content of the void, in one line.
std::string use_of_warp(VoidMode void_mode, const WarpJumps& jumps);

}  // namespace supple
