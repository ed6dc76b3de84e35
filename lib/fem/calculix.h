// Equilibria of linear theory by CalculiX (program `ccx`), to set its time, memory and result
// beside those of the own solver: the same nodes, loads and supports, and hexahedra C3D8, in which
// the dilatation is that of each point and not the mean of the element. Its files lie in a folder
// of their own and go when it ends. It prints seven digits.
#pragma once

#include <cstdio>
#include <string>
#include <vector>

#include "lib/fem/fem.h"
#include "lib/fem/residual.h"

namespace supple {

class CalculixSolver {
 public:
  /// All must outlive this.
  CalculixSolver(const HexMesh& mesh, const VoxelMaterial& material, const NodalLoads& loads,
                 EquationSolver solver);

  /// Always true. Throws InputError where `ccx` is not installed, Error with what it said where it
  /// gives no result, Cancelled.
  bool run(const Progress* progress);

  int iterations() const { return 0; }
  const ResidualSize& size() const { return m_size; }
  const std::vector<double>& u() const { return m_u; }
  std::vector<double> take_u() { return std::move(m_u); }
  const std::vector<double>& residual() const { return m_residual; }
  /// Of CalculiX, at its most.
  std::size_t bytes() const { return m_bytes; }

 private:
  void write_deck(const std::string& path) const;
  void write_body(std::FILE* out) const;
  void write_step(std::FILE* out) const;
  void read_results(const std::string& path);

  const HexMesh& m_mesh;
  const VoxelMaterial& m_material;
  const NodalLoads& m_loads;
  EquationSolver m_solver;
  std::vector<double> m_u, m_residual;
  ResidualSize m_size;
  std::size_t m_bytes = 0;
};

}  // namespace supple
