// Equilibria of linear theory by CalculiX (program `ccx`), to set its time, memory and result
// beside those of the own solver: the same nodes, loads and supports, and hexahedra C3D8, in which
// the dilatation is that of each point, as with Dilatation::pointwise, and not the element's mean.
// Its files lie in a folder of their own and go when it ends. It prints seven digits.
#pragma once

#include <cstdio>
#include <string>

#include "lib/fem/peers/peer_solver.h"

namespace supple {

class CalculixSolver final : public PeerSolver {
 public:
  /// All must outlive this.
  CalculixSolver(const PeerProblem& problem, const NodalLoads& loads, bool is_iterative)
      : m_problem(problem), m_loads(loads), m_is_iterative(is_iterative) {}

  /// Always true.
  bool run(Progress* progress) override;

 private:
  void write_deck(const std::string& path) const;
  void write_body(std::FILE* out) const;
  void write_step(std::FILE* out) const;
  void read_results(const std::string& path);

  const PeerProblem& m_problem;
  const NodalLoads& m_loads;
  bool m_is_iterative;
};

}  // namespace supple
