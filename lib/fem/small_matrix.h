// Matrices of 3 x 3 in rows: cofactors and the rotation of a gradient.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

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
