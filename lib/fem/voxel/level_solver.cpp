#include "lib/fem/voxel/level_solver.h"

#include <algorithm>
#include <utility>

#include "lib/fem/conjugate_gradients.h"
#include "lib/fem/voxel/coarse_elements.h"

namespace supple {

namespace {

/// True where nothing moves the body: it stays.
bool is_at_rest(const NodalLoads& loads) {
  return loads.force_mn.empty() &&
         std::all_of(loads.u_mm.begin(), loads.u_mm.end(), [](double u_mm) { return u_mm == 0; });
}

template <class Solver>
NodalSolution solved_by(Solver& solver, bool may_be_rough, Progress* progress) {
  const bool is_converged = solver.run(progress, progress);
  NodalSolution out;
  out.iterations = solver.iterations();
  out.residual_max = solver.size().max;
  out.seen_mn = solver.size().seen_mn;
  if (!is_converged && !may_be_rough) {
    FemReport told;
    told.iterations = out.iterations;
    note(solver.size(), told);
    throw NotConverged(told);
  }
  out.residual_mn = solver.residual();
  out.u_mm = solver.take_u();
  return out;
}

}  // namespace

std::vector<NodalSolution> LevelSolver::solve(std::vector<NodalLoads>& loads,
                                              const FemParams& params, bool may_be_rough,
                                              Progress* progress) {
  std::vector<NodalSolution> all;
  if (loads.empty()) return all;
  const HeldBits& held = loads.front().held;
  if (!m_system) {
    m_system = std::make_unique<VoxelSystem>(m_model.levels(), m_model.stiffness(),
                                             m_model.material(), held, progress, params.doublings);
  }
  m_system->multigrid().extend(params.doublings, held, progress);
  stage(progress, "solving");
  const CgLimits limits{params.tolerance, params.reaction_tolerance, params.max_iterations};
  const auto solve_with = [&](auto&& solver) {
    const std::size_t bytes = m_model.bytes() + m_system->bytes() + solver.bytes() +
                              all.size() * 2 * sizeof(double) * solver.residual().size();
    all.push_back(solved_by(solver, may_be_rough, progress));
    all.back().bytes = bytes;
  };
  for (NodalLoads& one : loads) {
    if (is_at_rest(one)) {
      all.emplace_back().residual_mn.resize(one.u_mm.size());
      all.back().u_mm = std::move(one.u_mm);
    } else if (params.doublings > 0) {
      solve_with(CoarseElements(m_model.stiffness(), m_system->multigrid(), params.doublings, one,
                                limits));
    } else {
      solve_with(ConjugateGradients(*m_system, one, limits));
    }
  }
  return all;
}

}  // namespace supple
