// Symmetric 3 x 3 blocks of the matrices of springs.
#pragma once

#include <array>

#include "volumes/base/vec.h"

namespace supple {

/// Entries xx, yy, zz, xy, xz, yz.
using SymmetricBlock = std::array<double, 6>;

inline Vec3d times(const SymmetricBlock& a, const Vec3d& x) {
  return {a[0] * x.x + a[3] * x.y + a[4] * x.z, a[3] * x.x + a[1] * x.y + a[5] * x.z,
          a[4] * x.x + a[5] * x.y + a[2] * x.z};
}

/// Inverts a block; false when it is not positive definite, or not a number.
inline bool invert(const SymmetricBlock& a, SymmetricBlock& inverse) {
  const auto [xx, yy, zz, xy, xz, yz] = a;
  const double c_xx = yy * zz - yz * yz, c_xy = xz * yz - xy * zz, c_xz = xy * yz - xz * yy;
  const double det = xx * c_xx + xy * c_xy + xz * c_xz;
  const double c_zz = xx * yy - xy * xy;
  if (!(xx > 0) || !(c_zz > 0) || !(det > 0)) return false;
  const double s = 1 / det;
  inverse = {c_xx * s, (xx * zz - xz * xz) * s, c_zz * s, c_xy * s,
             c_xz * s, (xy * xz - xx * yz) * s};
  return true;
}

}  // namespace supple
