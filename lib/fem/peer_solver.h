// A solution of the equations by another program, as the own solvers have theirs.
#pragma once

#include <utility>
#include <vector>

#include "lib/fem/residual.h"

namespace supple {

class PeerSolver {
 public:
  virtual ~PeerSolver() = default;

  /// False where it ended without what it was asked for. Throws InputError where the program is not
  /// installed, Error with what it said where it gives no result, Cancelled.
  virtual bool run(Progress* progress) = 0;

  /// 0 of a direct solver, and where the program does not tell.
  int iterations() const { return m_iterations; }
  const ResidualSize& size() const { return m_size; }
  const std::vector<double>& u() const { return m_u; }
  std::vector<double> take_u() { return std::move(m_u); }
  const std::vector<double>& residual() const { return m_residual; }
  /// Until the program, where it tells, was ready for the problem.
  double start_ms() const { return m_start_ms; }
  /// Of the program, at its most.
  std::size_t bytes() const { return m_bytes; }

 protected:
  std::vector<double> m_u, m_residual;
  ResidualSize m_size;
  int m_iterations = 0;
  double m_start_ms = 0;
  std::size_t m_bytes = 0;
};

}  // namespace supple
