#include "lib/fem/voxel/level_solver.h"

#include <algorithm>
#include <utility>

#include "lib/fem/response/response_set.h"
#include "lib/fem/voxel/coarse_elements.h"

namespace supple {

namespace {

/// True where nothing moves the body: it stays.
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

LevelSolver::LevelSolver(const FemModel& model, std::vector<NodalLoads>& loads)
    : m_model(model), m_loads(&loads), m_by_voxels(loads.size()) {
  for (const NodalLoads& one : loads) m_is_still.push_back(is_at_rest(one));
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

NodalSolution LevelSolver::by_voxels(std::size_t number, CgLimits limits, bool may_be_rough,
                                     Progress* progress) {
  std::unique_ptr<ConjugateGradients>& solver = m_by_voxels[number];
  if (!solver) {
    limits.ritz_value = m_ritz_value;
    solver = std::make_unique<ConjugateGradients>(*m_system, (*m_loads)[number], limits);
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

std::vector<NodalSolution> LevelSolver::solve(const FemParams& params, bool may_be_rough,
                                              Progress* progress) {
  std::vector<NodalSolution> all;
  if (m_loads->empty()) return all;
  const HeldBits& held = m_loads->front().held;
  if (!m_system) {
    m_system = std::make_unique<VoxelSystem>(m_model.levels(), m_model.stiffness(),
                                             m_model.material(), held, progress, params.doublings);
  }
  m_system->multigrid().extend(params.doublings, held, progress);
  stage(progress, "solving");
  CgLimits limits{params.residual_limit(), params.reaction_limit(), params.max_iterations};
  if (params.error_mm) {
    limits.error_mm = kErrorShare * *params.error_mm;
    limits.contrast = free_contrast(m_model.mesh(), m_model.material(), held);
  }
  std::size_t bytes = m_model.bytes() + m_system->bytes();
  for (std::size_t n = 0; n < m_loads->size(); ++n) {
    NodalLoads& one = (*m_loads)[n];
    if (m_is_still[n]) {
      all.emplace_back().residual_mn.resize(3 * one.held.size());
      all.back().u_mm.resize(3 * one.held.size());
      continue;
    }
    all.push_back(params.doublings > 0
                      ? by_coarse_elements(one, params.doublings, limits, may_be_rough, progress)
                      : by_voxels(n, limits, may_be_rough, progress));
    const std::size_t kept = m_by_voxels[n] ? all.back().bytes : 0;
    all.back().bytes += bytes;
    bytes += kept + 2 * sizeof(double) * all.back().u_mm.size();
  }
  return all;
}

}  // namespace supple
