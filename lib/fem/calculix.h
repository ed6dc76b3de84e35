// Equilibria of linear theory by CalculiX (program `ccx`), to set its time, memory and result
// beside those of the own solver: the same nodes, loads and supports, and hexahedra C3D8, in which
// the dilatation is that of each point and not the mean of the element. Its files lie in a folder
// of their own and go when it ends. It prints seven digits.
#pragma once

#include <cstdio>
#include <string>

#include "lib/fem/fem.h"
#include "lib/fem/peer_solver.h"

namespace supple {

class CalculixSolver final : public PeerSolver {
 public:
  /// All must outlive this.
  CalculixSolver(const HexMesh& mesh, const VoxelMaterial& material, const NodalLoads& loads,
                 EquationSolver solver);

  /// Always true.
  bool run(Progress* progress) override;

 private:
  void write_deck(const std::string& path) const;
  void write_body(std::FILE* out) const;
  void write_step(std::FILE* out) const;
  void read_results(const std::string& path);

  const HexMesh& m_mesh;
  const VoxelMaterial& m_material;
  const NodalLoads& m_loads;
  EquationSolver m_solver;
};

}  // namespace supple
