// Estimate of the error of displacements that conjugate gradients leave, from the last changes of a
// fixed sample of free nodes and from how slowly the iterations may converge:
//
//   error = 2.5 * max(p(u_k - u_k-1), p(u_k - u_k-2) / 2) * theta^-0.4 * max(1, 1e-3 / theta)^0.3
//           * max(1, c / 100)^0.25,
//
// or that of one of the two steps before, where it is more. p is the 95th percentile of lengths
// over the sample, theta the smallest Ritz value of B K, the smallest eigenvalue of the tridiagonal
// matrix that the steps of conjugate gradients make (Lanczos; Golub and Meurant 2010, section 5.6).
// Changes alone cannot tell what is still hidden: a plate or a pocket between stiff inclusions may
// stand still for some iterations, while theta has become small by then. Where it is smallest it is
// found last, which the third factor is for. The last one is for what neither has shown so far: c
// is the contrast, the largest stiffness of elements that can move by the smallest, and stiff
// pieces that soft tissue joins may move late. Of a floppy part under a force neither tells before
// the reactions do, so that these have to settle, too (kReactionsBesideError in fem_report.h).
// Powers and factor were found on bodies as those of rows `error` of `supple-lab bench fem`, so
// that the error is at most the estimate on 95 of 100 and at most twice it on all, contrasts of 1e3
// to 1e6 included; bounds of the energy (Gauss-Radau), changes over longer windows and their
// extrapolation by contraction need more iterations for that.
//
// It is no bound: a motion that has not entered the iterations, such as one of stiff pieces that
// soft tissue hardly joins, is not seen by it, nor by the residual.
//
// Cost: 100 kB, and 0.1 ms per iteration.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "lib/fem/nodal_loads.h"

namespace supple {

/// A step of conjugate gradients u += alpha p, p = B r + beta p.
struct CgStep {
  double alpha = 0, beta = 0;
};

class ErrorEstimate {
 public:
  /// Chooses the sample among nodes of which a component is free. `contrast`: the largest stiffness
  /// by the smallest. `ritz_value`: the smallest that earlier iterations with the same matrix have
  /// seen.
  ErrorEstimate(const HeldBits& held, double contrast, double ritz_value);

  /// Takes the displacements in mm, three per node, at the start of steps that know nothing of
  /// earlier ones.
  void start(const std::vector<double>& u_mm);
  /// Takes the displacements after the next step.
  void take(const std::vector<double>& u_mm, const CgStep& step);

  /// Returns the 95th percentile of the error after the last step; infinite before the first.
  double error_mm() const { return m_error_mm; }
  /// Returns the smallest Ritz value of all iterations so far, 1 before the first.
  double ritz_value() const { return m_ritz_value; }
  std::size_t bytes() const;

 private:
  std::vector<double> sample_of(const std::vector<double>& u_mm) const;

  std::vector<std::size_t> m_nodes;
  std::array<std::vector<double>, 3> m_recent;  // the sample now, a step and two steps before
  std::vector<CgStep> m_steps;
  double m_factor;
  double m_ritz_value;
  std::array<double, 3> m_last_mm{};  // by the last steps, the last one first
  double m_error_mm;
};

/// Returns the smallest eigenvalue of the tridiagonal matrix of these steps of conjugate gradients.
double smallest_ritz_value(const std::vector<CgStep>& steps);

}  // namespace supple
