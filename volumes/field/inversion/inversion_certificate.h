// The independent measurement of an inversion: u is evaluated anew at x + o(x), by look-up, with
// none of the solver's cell coordinates. Cost: about 10 ns per moved node, 2 ns per unmoved one.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "volumes/field/inversion/source_window.h"

namespace supple {

/// Residuals of the nodes of one output brick, kept so that they can be replaced.
struct BrickResiduals {
  float max = 0;
  std::vector<std::uint32_t> bins;  // bin << 10 | nodes in it, of the bins that hold any
};

/// Counts of residuals, eight bins per power of two: the upper bits of a float.
class ResidualHistogram {
 public:
  void add(float value);
  void add_zeros(int count);
  void join(const ResidualHistogram& other);
  void add(const BrickResiduals& brick);
  void remove(const BrickResiduals& brick);  // all but its maximum
  void set_max(float max) { m_max = max; }
  BrickResiduals of_one_brick() const;

  double max() const { return m_max; }
  /// Upper end of the bin in which the given part of all values is reached: at most 12.5 % too
  /// large.
  double percentile(double part) const;

 private:
  static constexpr int kShift = 20;
  std::array<std::int64_t, (0x7f800000u >> kShift) + 1> m_bins{};
  std::int64_t m_count = 0;
  float m_max = 0;
};

/// Residuals over the nodes of `o` whose source cell is not folded. `dims`: of the volume.
ResidualHistogram measure_residuals(const VectorBricks& u, const Vec3i& dims, const VectorBricks& o,
                                    const FoldedCells& folded);

/// The same brick by brick, of the bricks at `origins`, all of which `offsets` finds.
std::vector<BrickResiduals> measure_bricks(const VectorBricks& u, const Vec3i& dims,
                                           const std::vector<Vec3i>& origins,
                                           const VectorBrickFinder& offsets,
                                           const FoldedCells& folded);

}  // namespace supple
