// Preconditioned conjugate gradients in double precision (Hestenes and Stiefel 1952) with a
// multigrid cycle as preconditioner, which is not quite linear: each direction is made conjugate to
// the one before by its product with K, not by the norms of residuals (flexible conjugate
// gradients, Notay 2000).
//
// Held components stay in the vectors: there p and z are 0, so that they take no part, and the
// residual r = f - K u is minus the force of what holds them, known after every iteration at no
// cost. Directions p are rounded to single precision, of which u and r are then updated alike in
// double, so that r stays f - K u. 32 bytes per unknown, and 8 where forces act.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "lib/fem/error_estimate.h"
#include "lib/fem/nodal_loads.h"
#include "lib/fem/node_vectors.h"
#include "lib/fem/operator.h"
#include "lib/fem/residual.h"
#include "volumes/base/progress.h"

namespace supple {

/// Limits at which the iterations end.
struct CgLimits {
  double tolerance = 1e-6;  // of ResidualSize
  double reaction_tolerance = 1e-5;
  int max_iterations = 400;
  double residual_mn = 0;  // or with the largest residual at most so large
  /// K may have directions of negative curvature, at the first of which iterations end (Steihaug
  /// 1983); where that is the very first one, u goes along it as if the curvature were positive.
  bool may_be_indefinite = false;
  /// The estimate ends them, too (error_estimate.h); infinite: it is only told; 0: there is none.
  double error_mm = 0;
  double ritz_value = 1;  // for the estimate, the smallest that is known of the same system
  double contrast = 1;    // for the estimate, of the stiffness of what can move
};

class ConjugateGradients {
 public:
  /// All must outlive this. Takes loads.u_mm as the start.
  ConjugateGradients(LinearSystem& system, NodalLoads& loads, const CgLimits& limits);

  /// Solves; true when the limits are reached by the residual as it is computed afresh; false after
  /// too many iterations, or where no descent is found. Throws Cancelled. `told`: hears after every
  /// iteration how far the residual has come. After too many iterations, where allow() lets it, and
  /// after Cancelled, it goes on from there with the directions that it has.
  bool run(const Progress* progress, Progress* told = nullptr);
  void allow(int max_iterations) { m_limits.max_iterations = max_iterations; }

  int iterations() const { return m_iterations; }
  const ResidualSize& size() const { return m_size; }
  /// Estimated error that is left; none where the limits ask for no estimate.
  std::optional<double> error_mm() const;
  double ritz_value() const { return m_error ? m_error->ritz_value() : m_limits.ritz_value; }
  const std::vector<double>& u() const { return m_u; }
  const std::vector<double>& residual() const { return m_r; }
  std::vector<double> take_u() { return std::move(m_u); }
  std::size_t bytes() const;

 private:
  void compute_residual();
  void precondition(const Progress* progress);
  bool iterate(bool is_first);
  bool is_converged() const;
  void tell(Progress* told);

  LinearSystem* m_system;
  const NodalLoads* m_loads;
  CgLimits m_limits;
  ResidualMeter m_meter;
  ResidualSize m_size;
  int m_iterations = 0;
  int m_starts = 0;
  bool m_goes_on = false;  // p and K p are those of the iteration before
  double m_told_part = 0;
  std::vector<double> m_u, m_r;
  std::vector<float> m_p;
  /// K p from its computation to the next r; then r, B r and K p in single precision until the next
  /// p.
  SharedVectors m_shared;
  double m_p_q = 0;
  std::optional<ErrorEstimate> m_error;
  double m_first_error_mm = 0;
  double m_scale = 1;  // of the forces whose B r is the direction
  CgStep m_step;       // the last one, of forces that are not scaled
};

}  // namespace supple
