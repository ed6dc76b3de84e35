// A solution of the equations by another program, as the own solvers have theirs.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "lib/fem/elastic_law.h"
#include "lib/fem/operator.h"
#include "lib/fem/residual.h"

namespace supple {

/// Hexahedra for another program.
struct PeerProblem {
  std::vector<Vec3d> nodes;                       // LPS mm
  std::vector<std::array<NodeIndex, 8>> corners;  // 4 di + 2 dj + dk
  std::vector<std::uint8_t> classes;              // per element
  ModuliTable<double> moduli;
  bool is_pointwise = false;            // the dilatation, else its mean over the element
  bool is_mirrored = false;             // axes i, j, k of elements are left-handed
  const Operator* stiffness = nullptr;  // of these elements, as the own solver has it
};

class PeerSolver {
 public:
  virtual ~PeerSolver() = default;

  /// Runs it; false where it ended without what it was asked for. Throws InputError where the
  /// program is not installed, Error with what it said where it gives no result, Cancelled.
  virtual bool run(Progress* progress) = 0;

  /// Number of iterations; 0 of a direct solver, and where the program does not tell.
  int iterations() const { return m_iterations; }
  const ResidualSize& size() const { return m_size; }
  const std::vector<double>& u() const { return m_u; }
  std::vector<double> take_u() { return std::move(m_u); }
  const std::vector<double>& residual() const { return m_residual; }
  /// Time until the program, where it tells, was ready for the problem.
  double start_ms() const { return m_start_ms; }
  /// Memory of the program at its most.
  std::size_t bytes() const { return m_bytes; }

 protected:
  std::vector<double> m_u, m_residual;
  ResidualSize m_size;
  int m_iterations = 0;
  double m_start_ms = 0;
  std::size_t m_bytes = 0;
};

}  // namespace supple
