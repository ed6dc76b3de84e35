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
  /// `model`, its joints as they are, must outlive this.
  explicit LevelSolver(const FemModel& model) : m_model(model) {}

  /// Takes further loads, which must outlive this and hold the same components as the others.
  /// Throws Cancelled.
  void add(NodalLoads& loads);
  /// Makes ready what all loads share for elements of 2^doublings voxels. Throws Cancelled, all as
  /// it was.
  void prepare(int doublings, Progress* progress);
  /// The solution of the n-th loads by elements of params.doublings, with the bits that it has
  /// whatever other loads are solved. Starts from their u_mm, which
  /// it takes; by voxels it goes on where the call before ended. `may_be_rough`: what `params`
  /// allow no more iterations for is a solution, too. Throws NotConverged, Cancelled, after which
  /// solutions by voxels can go on.
  NodalSolution solve(std::size_t n, const FemParams& params, bool may_be_rough,
                      Progress* progress);

 private:
  struct Loads {
    NodalLoads* of;
    bool is_still;                                  // nothing moves the body: it stays
    std::unique_ptr<ConjugateGradients> by_voxels;  // while the solution is rough
  };
  NodalSolution by_coarse_elements(NodalLoads& loads, int doublings, const CgLimits& limits,
                                   bool may_be_rough, Progress* progress);
  NodalSolution by_voxels(Loads& loads, const CgLimits& limits, bool may_be_rough,
                          Progress* progress);

  const FemModel& m_model;
  std::vector<Loads> m_loads;
  std::unique_ptr<VoxelSystem> m_system;
};

}  // namespace supple
