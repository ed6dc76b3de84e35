// Solutions of several loads with the same held components, by elements of one size after the
// other: the cycle of large elements becomes that of smaller ones, so that it is made once.
#pragma once

#include <memory>
#include <vector>

#include "lib/fem/conjugate_gradients.h"
#include "lib/fem/voxel/fem.h"
#include "lib/fem/voxel/voxel_systems.h"

namespace supple {

class LevelSolver {
 public:
  /// `model`, its joints as they are, and `loads` must outlive this. All loads hold the same
  /// components.
  LevelSolver(const FemModel& model, std::vector<NodalLoads>& loads);

  /// FemModel::solve_beside(), with elements at most as large as those of the call before. Starts
  /// from loads.u_mm, which it takes, or goes on where the call before ended by voxels.
  /// `may_be_rough`: what `params` allow no more iterations for is a solution, too. Throws as it.
  std::vector<NodalSolution> solve(const FemParams& params, bool may_be_rough, Progress* progress);

 private:
  NodalSolution by_coarse_elements(NodalLoads& loads, int doublings, const CgLimits& limits,
                                   bool may_be_rough, Progress* progress);
  NodalSolution by_voxels(std::size_t number, CgLimits limits, bool may_be_rough,
                          Progress* progress);

  const FemModel& m_model;
  std::vector<NodalLoads>* m_loads;
  std::unique_ptr<VoxelSystem> m_system;
  std::vector<bool> m_is_still;
  std::vector<std::unique_ptr<ConjugateGradients>> m_by_voxels;  // of loads whose solution is rough
  double m_ritz_value = 1;  // the smallest that solutions by voxels have seen
};

}  // namespace supple
