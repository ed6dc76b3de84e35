#include "lib/fem/voxel/level_solver.h"

#include <algorithm>
#include <utility>

#include "lib/fem/response/response_set.h"
#include "lib/fem/voxel/coarse_elements.h"

namespace supple {

namespace {

bool is_at_rest(const NodalLoads& loads) {
  return loads.force_mn.empty() &&
         std::all_of(loads.u_mm.begin(), loads.u_mm.end(), [](double u_mm) { return u_mm == 0; });
}

/// Runs a solver as far as it may go; the solution still lacks u and the residual.
template <class Solver>
NodalSolution run_solver(Solver& solver, bool may_be_rough, Progress* progress) {
  const bool is_converged = solver.run(progress, progress);
  NodalSolution out;
  out.iterations = solver.iterations();
  out.residual_max = solver.size().max;
  out.to = {solver.size().seen_mn, 0, solver.size().reaction_change_mn};
  if (!is_converged && !may_be_rough) {
    FemReport told;
    told.iterations = out.iterations;
    note(solver.size(), told);
    throw NotConverged(told);
  }
  return out;
}

}  // namespace

void LevelSolver::add(NodalLoads& loads) {
  m_loads.push_back({&loads, is_at_rest(loads), nullptr});
}

void LevelSolver::prepare(int doublings, Progress* progress) {
  const HeldBits& held = m_loads.front().of->held;
  if (!m_system) {
    m_system = std::make_unique<VoxelSystem>(m_model.levels(), m_model.stiffness(),
                                             m_model.material(), held, progress, doublings);
  }
  m_system->multigrid().extend(doublings, held, progress);
}

NodalSolution LevelSolver::by_coarse_elements(NodalLoads& loads, int doublings,
                                              const CgLimits& limits, bool may_be_rough,
                                              Progress* progress) {
  CoarseElements solver(m_model.stiffness(), m_system->multigrid(), doublings, loads, limits);
  NodalSolution out = run_solver(solver, may_be_rough, progress);
  out.bytes = solver.bytes();
  out.residual_mn = solver.residual();
  out.u_mm = solver.take_u();
  return out;
}

NodalSolution LevelSolver::by_voxels(Loads& loads, CgLimits limits, bool may_be_rough,
                                     Progress* progress) {
  std::unique_ptr<ConjugateGradients>& solver = loads.by_voxels;
  if (!solver) {
    limits.ritz_value = m_ritz_value;
    solver = std::make_unique<ConjugateGradients>(*m_system, *loads.of, limits);
  }
  solver->allow(limits.max_iterations);
  NodalSolution out = run_solver(*solver, may_be_rough, progress);
  out.to.error_mm = solver->error_mm().value_or(0);
  out.ritz_value = m_ritz_value = std::min(m_ritz_value, solver->ritz_value());
  out.bytes = solver->bytes();
  out.residual_mn = solver->residual();
  if (may_be_rough) {
    out.u_mm = solver->u();
  } else {
    out.u_mm = solver->take_u();
    solver.reset();
  }
  return out;
}

NodalSolution LevelSolver::solve(std::size_t n, const FemParams& params, bool may_be_rough,
                                 Progress* progress) {
  Loads& loads = m_loads[n];
  NodalSolution out;
  if (loads.is_still) {
    for (std::vector<double>* of : {&out.u_mm, &out.residual_mn}) {
      of->resize(3 * loads.of->held.size());
    }
    return out;
  }
  stage(progress, "solving");
  CgLimits limits{params.residual_limit(), params.reaction_limit(), params.max_iterations};
  if (params.error_mm) {
    limits.error_mm = kErrorShare * *params.error_mm;
    limits.contrast = free_contrast(m_model.mesh(), m_model.material(), loads.of->held);
  }
  out = params.doublings > 0
            ? by_coarse_elements(*loads.of, params.doublings, limits, may_be_rough, progress)
            : by_voxels(loads, limits, may_be_rough, progress);
  out.bytes += m_model.bytes() + m_system->bytes();
  for (const Loads& other : m_loads) {
    if (&other != &loads && other.by_voxels) out.bytes += other.by_voxels->bytes();
  }
  return out;
}

}  // namespace supple
