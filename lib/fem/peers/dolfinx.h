// Equilibria of linear theory by DOLFINx (Python package `dolfinx`, Debian's python3-dolfinx) with
// PETSc's conjugate gradients and algebraic multigrid (GAMG, rigid motions as its near null space),
// one process per thread: an assembled matrix and general elements on the same equations. The mean
// dilatation of an element is its dilatation at the middle, since elements are parallelepipeds, so
// that one point integrates it. The residual is that of the own operator.
#pragma once

#include <string>

#include "lib/fem/peers/peer_solver.h"

namespace supple {

class DolfinxSolver final : public PeerSolver {
 public:
  /// All must outlive this. It ends when PETSc's norm of the residual is `tolerance` of what it was
  /// with the held nodes alone moved.
  DolfinxSolver(const PeerProblem& problem, const NodalLoads& loads, double tolerance,
                int max_iterations)
      : m_problem(problem),
        m_loads(loads),
        m_tolerance(tolerance),
        m_max_iterations(max_iterations) {}

  bool run(Progress* progress) override;

 private:
  void write_problem(const std::string& folder) const;
  void read_result(const std::string& path);

  const PeerProblem& m_problem;
  const NodalLoads& m_loads;
  double m_tolerance;
  int m_max_iterations;
};

}  // namespace supple
