// Chebyshev iteration for K z = r with D^-1 K, D the diagonal of K, as a smoother (Saad, Iterative
// methods for sparse linear systems, algorithm 12.1; Adams, Brezina, Hu and Tuminaro 2003):
// d = keep d + step D^-1 r, z += d, r -= K d, over and over; and an estimate of the largest
// eigenvalue that it needs.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include <Eigen/Eigenvalues>

#include "lib/fem/node_vectors.h"
#include "lib/fem/voxel/short_float.h"

namespace supple {

/// Factors of one step after the other. Eigenvalues from 1/`range` of the largest one on are
/// damped.
class ChebyshevSteps {
 public:
  ChebyshevSteps(double largest_eigenvalue, double range)
      : m_centre(largest_eigenvalue * (1 + 1 / range) / 2),
        m_half(largest_eigenvalue * (1 - 1 / range) / 2),
        m_rho(m_half / m_centre),
        m_step(float(1 / m_centre)) {}

  float keep() const { return m_keep; }
  float step() const { return m_step; }
  void advance() {
    const double next = 1 / (2 * m_centre / m_half - m_rho);
    m_keep = float(next * m_rho);
    m_step = float(2 * next / m_half);
    m_rho = next;
  }

 private:
  double m_centre, m_half, m_rho;
  float m_keep = 0, m_step;
};

/// The largest eigenvalue of D^-1 K from above, nearly: that of the tridiagonal matrix of a few
/// Lanczos steps in the inner product of D, from a vector without structure, and a margin. The
/// power method is far too low after as many steps where eigenvalues are dense: a cube with nu =
/// 0.45. subtract(x, y) is y -= K x.
template <class Subtract>
double estimate_largest(const std::vector<ShortFloat>& inverse_diagonal, Subtract&& subtract) {
  constexpr int kLanczosSteps = 12;
  /// Norm, that of D, at which Lanczos ends: what is left is rounding.
  constexpr double kLanczosEnd = 1e-5;
  /// Lanczos' values come from below.
  constexpr double kEigenvalueMargin = 1.1;
  const std::size_t count = inverse_diagonal.size();
  const ShortFloat* inverse = inverse_diagonal.data();
  std::vector<float> x(count), before(count), y(count);
  std::uint32_t random = 1;
  for (std::size_t n = 0; n < count; ++n) {
    random = random * 1664525u + 1013904223u;
    x[n] = inverse[n] == 0 ? 0 : float(random >> 8) / float(1 << 24) - 0.5f;
  }
  const auto norm_in_d = [&](const std::vector<float>& v) {
    return std::sqrt(sum_ranges(count, [&](std::size_t begin, std::size_t end) {
      double sum = 0;
      for (std::size_t n = begin; n < end; ++n) {
        if (inverse[n] != 0) sum += double(v[n]) * double(v[n]) / double(inverse[n]);
      }
      return sum;
    }));
  };
  Eigen::VectorXd diagonal(kLanczosSteps), beside(kLanczosSteps);
  double scale = norm_in_d(x), last = 0;
  int steps = 0;
  for (; steps < kLanczosSteps && scale > (steps == 0 ? 0 : kLanczosEnd); ++steps) {
    // y = -K x, x of norm 1.
    for_ranges(count, [&](std::size_t begin, std::size_t end) {
      for (std::size_t n = begin; n < end; ++n) {
        x[n] = float(x[n] / scale);
        y[n] = 0;
      }
    });
    subtract(x.data(), y.data());
    const double own = -dot(x.data(), y.data(), count);
    for_ranges(count, [&](std::size_t begin, std::size_t end) {
      for (std::size_t n = begin; n < end; ++n) {
        const float next = float(-double(y[n]) * inverse[n] - own * x[n] - last * before[n]);
        before[n] = x[n];
        x[n] = next;
      }
    });
    last = scale = norm_in_d(x);
    diagonal[steps] = own;
    beside[steps] = scale;
  }
  if (steps == 0) return 1;
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
  solver.computeFromTridiagonal(diagonal.head(steps), beside.head(steps - 1),
                                Eigen::EigenvaluesOnly);
  return kEigenvalueMargin * solver.eigenvalues()[steps - 1];
}

}  // namespace supple
