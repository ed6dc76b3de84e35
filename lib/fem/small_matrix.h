// Matrices of 3 x 3 in rows: products, cofactors and the rotation of a gradient.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "volumes/base/vec.h"

namespace supple {

using Matrix9 = std::array<double, 9>;
constexpr Matrix9 kIdentity9{1, 0, 0, 0, 1, 0, 0, 0, 1};

inline Matrix9 cofactors(const Matrix9& a) {
  Matrix9 out;
  for (std::size_t n = 0; n < 3; ++n) {
    const double *b = &a[3 * ((n + 1) % 3)], *c = &a[3 * ((n + 2) % 3)];
    for (std::size_t m = 0; m < 3; ++m) {
      out[3 * n + m] = b[(m + 1) % 3] * c[(m + 2) % 3] - b[(m + 2) % 3] * c[(m + 1) % 3];
    }
  }
  return out;
}

/// A x.
inline Vec3d times(const Matrix9& a, const Vec3d& x) {
  return {a[0] * x.x + a[1] * x.y + a[2] * x.z, a[3] * x.x + a[4] * x.y + a[5] * x.z,
          a[6] * x.x + a[7] * x.y + a[8] * x.z};
}
/// A B^T.
inline Matrix9 times_transposed(const Matrix9& a, const Matrix9& b) {
  Matrix9 out{};
  for (std::size_t n = 0; n < 9; ++n) {
    for (std::size_t m = 0; m < 3; ++m) out[n] += a[3 * (n / 3) + m] * b[3 * (n % 3) + m];
  }
  return out;
}
/// Half the curl of a gradient.
inline Vec3d axial(const Matrix9& a) {
  return {(a[7] - a[5]) / 2, (a[2] - a[6]) / 2, (a[3] - a[1]) / 2};
}

/// Expands the determinant by the cofactors of the first row.
inline double determinant_of(const Matrix9& a, const Matrix9& cofactor) {
  return a[0] * cofactor[0] + a[1] * cofactor[1] + a[2] * cofactor[2];
}

/// R of the polar decomposition F = R U (Higham, SIAM J. Sci. Stat. Comput. 7, 1160-1174, 1986);
/// the identity where det F is not above 0.
inline Matrix9 rotation_of(Matrix9 f) {
  constexpr int kMostSteps = 30;
  constexpr double kSmallStep = 1e-9;  // the error is its square
  for (int step = 0; step < kMostSteps; ++step) {
    const Matrix9 cofactor = cofactors(f);
    const double determinant = determinant_of(f, cofactor);
    if (!(determinant > 0)) return kIdentity9;
    double moved = 0;
    for (std::size_t n = 0; n < 9; ++n) {
      const double next = (f[n] + cofactor[n] / determinant) / 2;
      moved = std::max(moved, std::abs(next - f[n]));
      f[n] = next;
    }
    if (moved < kSmallStep) break;
  }
  return f;
}

}  // namespace supple
