// Solutions of several loads with the same held components, by elements of one size after the
// other: the cycle of large elements becomes that of smaller ones, so that it is made once.
#pragma once

#include <memory>
#include <vector>

#include "lib/fem/voxel/fem.h"
#include "lib/fem/voxel/voxel_systems.h"

namespace supple {

class LevelSolver {
 public:
  /// `model` must outlive this, its joints as they are.
  explicit LevelSolver(const FemModel& model) : m_model(model) {}

  /// FemModel::solve_beside(). Held components are those of the first call, elements at most as
  /// large as those of the call before. `may_be_rough`: what `params` allow no more iterations for
  /// is a solution, too. Takes loads.u_mm, which becomes that of the solutions. Throws as it.
  std::vector<NodalSolution> solve(std::vector<NodalLoads>& loads, const FemParams& params,
                                   bool may_be_rough, Progress* progress);

 private:
  const FemModel& m_model;
  std::unique_ptr<VoxelSystem> m_system;
  double m_ritz_value = 1;  // the smallest that solutions by voxels have seen
};

}  // namespace supple
