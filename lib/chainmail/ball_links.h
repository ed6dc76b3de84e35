// Lengths of links and the ball limits on them: eq. 4.6 of the thesis in place of eqs. 4.3-4.5,
//   min_length h <= |x_j - x_i| <= max_length h,
// x in mm, h the link's rest length. Shear columns of the material are not used: a link may turn.
// The grid's axes may be oblique; lengths come from their scalar products.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "lib/body/body.h"

namespace supple {

class BallLinks {
 public:
  /// Looks every limit up once: 25 kB, 3 MB with Combine::limits.
  explicit BallLinks(const Body& body);

  struct Range {
    double least_mm, most_mm;
  };
  Range range(int axis, std::uint8_t class_a, std::uint8_t class_b) const {
    return m_ranges[std::size_t(axis)][std::size_t(class_a * m_stride + class_b)];
  }
  /// Length in mm of a vector in voxels along i, j, k.
  double length_mm(const Vec3d& link) const;
  double rest_mm(int axis) const { return m_rest_mm[std::size_t(axis)]; }
  std::size_t bytes() const;

  /// mm by which a length misses its range; 0 inside.
  static double excess_mm(double length_mm, const Range& range) {
    return std::max({0.0, length_mm - range.most_mm, range.least_mm - length_mm});
  }

 private:
  int m_stride;  // of classes, as in SlackTable
  std::array<std::vector<Range>, 3> m_ranges;
  std::array<double, 3> m_rest_mm;
  std::array<std::array<double, 3>, 3> m_products;  // of the axes, mm^2 per voxel^2
};

}  // namespace supple
