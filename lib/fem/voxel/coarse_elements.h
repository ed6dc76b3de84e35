// Elements of 2, 4 or 8 voxels in each direction: the best of all displacements that are trilinear
// on these, by the elastic energy of the voxels themselves (Galerkin),
//
//   u = g + P z,   P^T K P z = P^T (f - K g),   g: what is prescribed, 0 elsewhere,
//
// with the meshes of the multigrid cycle and its interpolation P to the voxels' nodes, which leaves
// out what is held. So a block that is filled in part, or with several tissues, needs no rule of
// its own: it is as stiff as its voxels. Cuts, gaps and thin shells stay, and a held voxel counts,
// as they do in the cycle. Energy and reactions of prescribed displacements come from above: they
// are never below those of the voxels.
//
// Solver: conjugate gradients in single precision on the coarse nodes, with the residual of the
// voxels in double precision between them. 24 bytes per unknown of the voxels.
#pragma once

#include <vector>

#include "lib/fem/conjugate_gradients.h"
#include "lib/fem/residual.h"
#include "lib/fem/voxel/multigrid.h"

namespace supple {

class CoarseElements {
 public:
  /// All must outlive this. Takes loads.u_mm. `level`: 1 and on, of the cycle.
  CoarseElements(const HexOperator& stiffness, Multigrid& multigrid, int level, NodalLoads& loads,
                 const CgLimits& limits);

  /// Solves; false after too many iterations or where no descent is found. Throws Cancelled.
  bool run(const Progress* progress, Progress* told = nullptr);

  int iterations() const { return m_iterations; }
  /// Size of the residual by the forces of coarse nodes.
  const ResidualSize& size() const { return m_size; }
  const std::vector<double>& residual() const { return m_r; }
  const std::vector<double>& u() const { return m_u; }
  std::vector<double> take_u() { return std::move(m_u); }
  std::size_t bytes() const;

 private:
  void measure_residual();

  const HexOperator* m_stiffness;
  Multigrid* m_multigrid;
  int m_level;
  const NodalLoads* m_loads;
  CgLimits m_limits;
  ResidualMeter m_meter;
  ResidualSize m_size;
  double m_scale = 1;
  int m_iterations = 0;
  std::vector<double> m_u, m_r;
  std::vector<float> m_single;
};

}  // namespace supple
