// Solutions as sums of earlier ones, and several beside each other.
#include <algorithm>
#include <cmath>
#include <utility>

#include "lib/fem/conjugate_gradients.h"
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
  for (const double number : {params.tolerance, params.reaction_tolerance}) solver.add(number);
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

std::vector<NodalSolution> FemModel::solve_beside(std::vector<NodalLoads> loads,
                                                  const FemParams& params,
                                                  Progress* progress) const {
  return LevelSolver(*this).solve(loads, params, false, progress);
}

void FemModel::keep(const std::vector<NodalLoads>& loads, std::vector<NodalSolution> solutions,
                    const FemParams& params, double rounding_mm, ResponseSet& known) const {
  known.require(key_of(loads.front(), parted(), params));
  for (std::size_t n = 0; n < loads.size(); ++n) {
    NodalSolution& of = solutions[n];
    if (n == 0 && !loads[n].force_mn.empty()) {
      known.set_base(prescribed(loads[n]), std::move(of.u_mm), of.seen_mn);
    } else {
      known.add(prescribed(loads[n]), std::move(of.u_mm), of.seen_mn, rounding_mm);
    }
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
  ResidualSize size = residual_of(stiffness(), loads, u, known.seen_mn(parts), r);
  size.reaction_change = 0;
  if (!size.is_within(kSumTolerances * params.tolerance, params.reaction_tolerance)) {
    for (std::size_t n = 0; n < u.size(); ++n) {
      if ((loads.held[n / 3] >> n % 3 & 1) == 0) loads.u_mm[n] = u[n];
    }
    return std::nullopt;
  }
  note(size, out.report);
  out.report.bytes = std::max(
      out.report.bytes, bytes() + known.bytes() + (u.capacity() + r.capacity()) * sizeof(double));
  conclude(loads, params, size, r, std::move(u), out);
  out.report.solve_ms += clock.ms();
  return out;
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
    nodal.force_mn.empty() ? known.add(asked, out.u_mm, seen_mn)
                           : known.set_base(asked, out.u_mm, seen_mn);
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
    solve_linear(rest, params, progress, missing);
    report.levels = missing.report.levels;
    report.iterations = missing.report.iterations;
    report.setup_ms = missing.report.setup_ms;
    report.solve_ms = missing.report.solve_ms;
    report.bytes = missing.report.bytes + known.bytes();
    known.add(parts.left_mm, std::move(missing.u_mm), seen_mn);
    told.solved = 1;
    parts.of.push_back(1);
  }
  told.used = parts.used() + (known.base() != nullptr ? 1 : 0);
  std::optional<FemSolution> sum = sum_of(known, parts, nodal, params, report);
  if (sum) return finish(*sum);
  FemSolution out;
  out.report = report;
  solve_linear(nodal, params, progress, out);
  out.report.iterations += report.iterations;
  return finish(out);
}

}  // namespace supple
