// Solutions as sums of earlier ones, and several beside each other.
#include <algorithm>
#include <cmath>
#include <utility>

#include "lib/fem/response/response_set.h"
#include "lib/fem/voxel/coarse_elements.h"
#include "lib/fem/voxel/fem.h"
#include "lib/fem/voxel/fem_results.h"
#include "lib/fem/voxel/hex_operator.h"
#include "lib/fem/voxel/level_solver.h"
#include "volumes/base/stopwatch.h"
#include "volumes/base/units.h"

namespace supple {

namespace {

/// Places of elements are rounded to 2^-16 voxel; less than two of these, in parts of a voxel, is
/// no motion of its own.
constexpr double kRoundedVoxels = 2.0 / (1 << 16);
/// A sum may leave so many tolerances: each of its terms has one.
constexpr double kSumTolerances = 2;

ResponseKey key_of(const NodalLoads& loads, const std::vector<bool>& apart,
                   const FemParams& params) {
  ResponseKey key;
  ContentHash joined, solver, held, forces;
  joined.add(apart.size());
  for (const bool is_apart : apart) joined.add(is_apart);
  for (const double limit :
       {params.residual_limit(), params.reaction_limit(), params.error_limit_mm()}) {
    solver.add(limit);
  }
  solver.add(params.max_iterations);
  held.add(loads.held);
  forces.add(loads.force_mn);
  key.add("joints of touching voxels", std::move(joined));
  key.add("tolerances", std::move(solver));
  key.add("held elements", std::move(held));
  key.add("loads", std::move(forces));
  return key;
}

/// Prescribed displacements alone, 0 where a component is free.
std::vector<double> prescribed(const NodalLoads& loads) {
  std::vector<double> g(loads.u_mm.size(), 0.0);
  for (std::size_t n = 0; n < g.size(); ++n) {
    if ((loads.held[n / 3] >> n % 3 & 1) != 0) g[n] = loads.u_mm[n];
  }
  return g;
}

/// r = f - K u and its size.
ResidualSize residual_of(const HexOperator& stiffness, const NodalLoads& loads,
                         const std::vector<double>& u, double seen_mn, std::vector<double>& r) {
  r.resize(u.size());
  set_to_forces(loads, r);
  stiffness.subtract(u.data(), r.data());
  ResidualMeter meter(loads);
  meter.have_seen(seen_mn);
  return meter(r);
}

/// Measures of what a solution with these limits has left.
SolvedTo solved_to(const FemSolution& solution, double seen_mn, const FemParams& params) {
  const bool is_to_error = params.error_mm.has_value();
  return {seen_mn, is_to_error ? solution.report.error_mm.value_or(0) : 0,
          is_to_error ? solution.reaction_change_mn : 0};
}

FemParams to_error(const FemParams& params, double error_mm) {
  FemParams other = params;
  other.error_mm = error_mm;
  return other;
}

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

NodalSolution LevelSolver::by_voxels(Loads& loads, const CgLimits& limits, bool may_be_rough,
                                     Progress* progress) {
  std::unique_ptr<ConjugateGradients>& solver = loads.by_voxels;
  if (!solver) solver = std::make_unique<ConjugateGradients>(*m_system, *loads.of, limits);
  solver->allow(limits.max_iterations);
  NodalSolution out = run_solver(*solver, may_be_rough, progress);
  out.to.error_mm = solver->error_mm().value_or(0);
  out.ritz_value = solver->ritz_value();
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

std::vector<NodalSolution> FemModel::solve_beside(std::vector<NodalLoads> loads,
                                                  const FemParams& params,
                                                  Progress* progress) const {
  LevelSolver solver(*this);
  for (NodalLoads& one : loads) solver.add(one);
  std::vector<NodalSolution> all;
  if (loads.empty()) return all;
  solver.prepare(params.doublings, progress);
  for (std::size_t n = 0; n < loads.size(); ++n) {
    const std::size_t before = 2 * sizeof(double) * n * loads[n].u_mm.size();
    all.push_back(solver.solve(n, params, false, progress));
    all.back().bytes += before;
  }
  return all;
}

void FemModel::keep(const NodalLoads& base, const NodalLoads& loads, NodalSolution solution,
                    const FemParams& params, double rounding_mm, ResponseSet& known) const {
  known.require(key_of(base, parted(), params));
  known.see(solution.ritz_value);
  if (!loads.force_mn.empty()) {
    known.set_base(prescribed(loads), std::move(solution.u_mm), solution.to);
  } else {
    known.add(prescribed(loads), std::move(solution.u_mm), solution.to, rounding_mm);
  }
}

/// The sum, where it is as good as a solution. Held nodes go where the sum has them, which differs
/// from where they were to be by rounding: that would be a force in stiff elements.
std::optional<FemSolution> FemModel::sum_of(const ResponseSet& known, const ResponseParts& parts,
                                            NodalLoads& loads, const FemParams& params,
                                            const FemReport& report) const {
  const Stopwatch clock;
  FemSolution out;
  out.report = report;
  std::vector<double> u = known.sum(parts, loads.u_mm.size()), r;
  const SolvedTo left = known.solved_to(parts);
  ResidualSize size = residual_of(stiffness(), loads, u, left.seen_mn, r);
  // So far it is the one from nothing to the reactions.
  const double part =
      size.reaction_change_mn > 0 ? size.reaction_change / size.reaction_change_mn : 0;
  size.reaction_change_mn = params.error_mm ? left.reaction_change_mn : 0;
  size.reaction_change = part * size.reaction_change_mn;
  if (!size.is_within(kSumTolerances * params.residual_limit(), params.reaction_limit())) {
    for (std::size_t n = 0; n < u.size(); ++n) {
      if ((loads.held[n / 3] >> n % 3 & 1) == 0) loads.u_mm[n] = u[n];
    }
    return std::nullopt;
  }
  note(size, out.report);
  out.report.error_mm.reset();
  if (params.error_mm) out.report.error_mm = left.error_mm;
  out.report.bytes = std::max(
      out.report.bytes, bytes() + known.bytes() + (u.capacity() + r.capacity()) * sizeof(double));
  conclude(loads, params, size, r, std::move(u), out);
  out.report.solve_ms += clock.ms();
  return out;
}

/// Solves terms of a sum further until what they leave together is at most the error that is asked
/// for: those that leave more than their share, from where they are. Returns the iterations.
int FemModel::sharpen(ResponseSet& known, const ResponseParts& parts, const NodalLoads& loads,
                      const FemParams& params, Progress* progress) const {
  const double asked_mm = params.error_limit_mm();
  if (known.solved_to(parts).error_mm <= asked_mm) return 0;
  int iterations = 0;
  const double share_mm = asked_mm / (1 + parts.used());
  for (int n = -1; n < int(parts.of.size()); ++n) {
    if (known.error_mm(parts, n) <= share_mm) continue;
    const UnitResponse& of = n < 0 ? *known.base() : known[std::size_t(n)];
    const double part = n < 0 ? 1 : std::abs(parts.of[std::size_t(n)]);
    NodalLoads one = loads;
    if (n >= 0) one.force_mn.clear();
    one.u_mm = of.u_mm;
    one.within_held_mn = forces_within_held(mesh(), material(), one);
    FemSolution better;
    better.ritz_value = known.ritz_value();
    const FemParams further = to_error(params, kErrorShare * share_mm / part);
    solve_linear(one, further, progress, better);
    known.see(better.ritz_value);
    iterations += better.report.iterations;
    const SolvedTo to = solved_to(better, of.to.seen_mn, further);
    known.replace(n, std::move(better.u_mm), to);
  }
  return iterations;
}

FemSolution FemModel::solve_by(ResponseSet& known, const FemLoads& loads, const FemParams& params,
                               Progress* progress) const {
  const Stopwatch clock;
  FemReport report;
  NodalLoads nodal = checked_loads(loads, params, progress, report);
  report.setup_ms = clock.ms();
  ResponseReport told;
  told.changed = known.require(key_of(nodal, parted(), params));
  const std::vector<double> asked = prescribed(nodal);
  const Vec3d spacing = mesh().geometry.spacing_mm();
  const double rounding_mm = kRoundedVoxels * std::min({spacing.x, spacing.y, spacing.z});
  ResponseParts parts = known.parts_of(asked);
  if (parts.beyond_mm > rounding_mm && known.is_full()) known.forget();
  std::vector<double> r;
  const auto finish = [&](FemSolution& solution) {
    solution.report.responses = told;
    solution.swelling_kpa = std::move(nodal.swelling_kpa);
    solution.report.volume_change_ml =
        volume_change_mm3(mesh(), material(), solution.u_mm) * kMlPerMm3;
    return std::move(solution);
  };
  if (known.empty()) {
    const double seen_mn = residual_of(stiffness(), nodal, asked, 0, r).seen_mn;
    FemSolution out;
    out.report = report;
    NodalLoads first = nodal;
    solve_linear(first, params, progress, out);
    known.see(out.ritz_value);
    const SolvedTo to = solved_to(out, seen_mn, params);
    nodal.force_mn.empty() ? known.add(asked, out.u_mm, to) : known.set_base(asked, out.u_mm, to);
    told.solved = 1;
    return finish(out);
  }
  if (parts.beyond_mm > rounding_mm) {
    NodalLoads rest = nodal;
    rest.force_mn.clear();
    rest.u_mm = parts.left_mm;
    rest.within_held_mn = forces_within_held(mesh(), material(), rest);
    const double seen_mn = residual_of(stiffness(), rest, rest.u_mm, 0, r).seen_mn;
    FemSolution missing;
    missing.report = report;
    missing.ritz_value = known.ritz_value();
    FemParams of_rest = params;
    if (params.error_mm) {
      // The next motion may have as much of this direction as it has of all.
      double farthest_mm = parts.beyond_mm;
      for (const double way_mm : asked) farthest_mm = std::max(farthest_mm, std::abs(way_mm));
      of_rest = to_error(params, kErrorShare * *params.error_mm * parts.beyond_mm / farthest_mm);
    }
    solve_linear(rest, of_rest, progress, missing);
    known.see(missing.ritz_value);
    report.levels = missing.report.levels;
    report.iterations = missing.report.iterations;
    report.setup_ms = missing.report.setup_ms;
    report.solve_ms = missing.report.solve_ms;
    report.bytes = missing.report.bytes + known.bytes();
    known.add(parts.left_mm, std::move(missing.u_mm), solved_to(missing, seen_mn, of_rest));
    told.solved = 1;
    parts.of.push_back(1);
  }
  const int further = sharpen(known, parts, nodal, params, progress);
  report.iterations += further;
  told.used = parts.used() + (known.base() != nullptr ? 1 : 0);
  std::optional<FemSolution> sum = sum_of(known, parts, nodal, params, report);
  if (sum) return finish(*sum);
  FemSolution out;
  out.report = report;
  out.ritz_value = known.ritz_value();
  solve_linear(nodal, params, progress, out);
  out.report.iterations += report.iterations;
  return finish(out);
}

}  // namespace supple
