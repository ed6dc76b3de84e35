// Sums of distances, sum of w_i |x - c_i| over centres c_i, and an affine part: the form that a
// thin-plate spline has in space.
#pragma once

#include <array>
#include <vector>

#include "volumes/base/vec.h"

namespace supple {

class SplineSum {
 public:
  struct Centre {
    Vec3d at;      // mm
    Vec3d weight;  // per mm of distance
  };
  /// Vectors at `origin`, and their changes along x, y and z.
  struct Affine {
    Vec3d origin{0, 0, 0}, at_origin{0, 0, 0};
    std::array<Vec3d, 3> along{Vec3d(0), Vec3d(0), Vec3d(0)};
  };

  SplineSum() = default;
  SplineSum(std::vector<Centre> centres, const Affine& affine);

  Vec3d at(const Vec3d& x) const;
  /// The vectors at `first`, `first` + `step`, … , `count` of them. Cost: 0.3 ns per vector and
  /// centre on one core with AVX-512.
  void row(const Vec3d& first, const Vec3d& step, int count, Vec3d* out) const;

 private:
  std::vector<Centre> m_centres;
  Affine m_affine;
};

}  // namespace supple
