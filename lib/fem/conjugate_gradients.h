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

#include <vector>

#include "lib/fem/fem.h"
#include "lib/fem/fem_loads.h"
#include "lib/fem/hex_operator.h"
#include "lib/fem/multigrid.h"
#include "lib/fem/node_vectors.h"

namespace supple {

struct CgState {
  int iterations = 0;
  double residual_max = 0, residual_rms = 0;  // relative to the largest nodal force
  double largest_force_mn = 0;
  double reaction_change = 0;  // relative to the largest reaction, over the last iteration
};

class ConjugateGradients {
 public:
  /// All must outlive this. Takes loads.u_mm as the start.
  ConjugateGradients(const HexOperator& stiffness, Multigrid& multigrid, NodalLoads& loads,
                     const FemParams& params);

  /// True when the tolerances are reached by the residual as it is computed afresh. Throws
  /// Cancelled.
  bool run(Progress* progress);

  const CgState& state() const { return m_state; }
  const std::vector<double>& u() const { return m_u; }
  const std::vector<double>& residual() const { return m_r; }
  std::vector<double> take_u() { return std::move(m_u); }
  std::size_t bytes() const;

 private:
  void compute_residual();
  void measure();
  void precondition();
  bool iterate(bool is_first);
  bool is_converged() const;

  const HexOperator* m_stiffness;
  Multigrid* m_multigrid;
  const NodalLoads* m_loads;
  FemParams m_params;
  CgState m_state;
  std::vector<double> m_u, m_r;
  std::vector<float> m_p;
  /// K p from its computation to the next r; then r, B r and K p in single precision until the next
  /// p.
  SharedVectors m_shared;
  double m_largest_load_mn = 0;
  double m_largest_residual_mn = 0;
  double m_p_q = 0;
  std::vector<Vec3d> m_reactions;
};

}  // namespace supple
