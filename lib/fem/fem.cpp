#include "lib/fem/fem.h"

#include <chrono>
#include <cmath>

#include "lib/fem/calculix.h"
#include "lib/fem/coarse_elements.h"
#include "lib/fem/conjugate_gradients.h"
#include "lib/fem/dolfinx.h"
#include "lib/fem/fem_results.h"
#include "lib/fem/hex_operator.h"
#include "lib/fem/loose_islands.h"
#include "lib/fem/multigrid.h"
#include "lib/fem/newton.h"
#include "lib/fem/stiffness_system.h"
#include "volumes/base/stopwatch.h"
#include "volumes/base/units.h"

namespace supple {

struct FemModel::Parts {
  VoxelMaterial material;
  MeshLevels levels;
  HexOperator stiffness;

  Parts(VoxelMaterial of, HexMesh mesh, Progress* progress)
      : material(std::move(of)),
        levels(std::move(mesh), progress),
        stiffness(levels.meshes[0], material) {}

  std::size_t bytes() const {
    return material.classes.capacity() + levels.bytes() + stiffness.bytes();
  }
};

namespace {

void require(bool holds, const char* field, double found, const char* expected) {
  if (!holds) throw InputError({"", field, number_text(found), expected});
}

VoxelMaterial material_of(const Body& body, const ElasticTable& elastic, Dilatation dilatation) {
  elastic.validate();
  VoxelMaterial out;
  out.matrix = element_matrix(body.geometry.axes_mm(), dilatation);
  for (int n = 0; n <= kLastClass; ++n) {
    const ElasticModuli moduli = elastic_moduli(elastic.young_kpa[n], elastic.poisson[n]);
    out.moduli.shear[n] = moduli.shear_kpa;
    out.moduli.bulk[n] = moduli.bulk_kpa;
    out.moduli_single.shear[n] = float(moduli.shear_kpa);
    out.moduli_single.bulk[n] = float(moduli.bulk_kpa);
  }
  out.classes.reserve(std::size_t(body.elements.active_count()));
  for (std::size_t b = 0; b < body.elements.brick_count(); ++b) {
    for_each_active(body.elements.mask(b), [&](int offset) {
      out.classes.push_back(body.classes[b * kBrickVoxels + offset]);
    });
  }
  return out;
}

std::string not_converged_text(const FemReport& report) {
  std::string text = "finite elements did not converge";
  if (report.newton) {
    const NewtonReport& newton = *report.newton;
    text += " beyond " + number_text(100 * newton.load_part) + " % of the load (" +
            std::to_string(newton.load_steps) + " steps, " + std::to_string(newton.rejected_steps) +
            " given up, " + std::to_string(newton.newton_iterations) +
            " corrections, smallest det F " + number_text(newton.smallest_j) + ")";
  }
  return text + ": residual " + number_text(report.residual_max) +
         " of the largest nodal force (rms " + number_text(report.residual_rms) +
         "), reactions changed by " + number_text(report.reaction_change) + " after " +
         std::to_string(report.iterations) + " iterations, " + std::to_string(report.unknowns) +
         " unknowns";
}

void note(const ResidualSize& size, FemReport& report) {
  report.residual_max = size.max;
  report.residual_rms = size.rms;
  report.largest_force_n = size.largest_force_mn * kNPerMn;
  report.reaction_change = size.reaction_change;
}

MotionLimits limits_of(const FemParams& params) {
  return {params.max_rotation_deg, params.max_strain};
}

void note(const LargestMotion& largest, FemReport& report) {
  report.largest_rotation_deg = largest.rotation_deg;
  report.largest_strain = largest.strain;
  report.turned = largest.turned;
  report.strained = largest.strained;
  report.beyond_elements = largest.beyond;
}

/// Held nodes stay prescribed. A start of another mesh does not count.
void begin_from(const NodeStart& start_mm, NodalLoads& loads) {
  if (start_mm.size() != loads.u_mm.size()) return;
  for (std::size_t n = 0; n < loads.u_mm.size(); ++n) {
    if ((loads.held[n / 3] >> n % 3 & 1) == 0) loads.u_mm[n] = double(start_mm[n]);
  }
}

/// Reactions, balance and energy from r = f - K(u), which is minus the force of what holds a node.
/// Sums of less than `least_force_mn` are rounding.
void balance(const NodalLoads& loads, const std::vector<double>& u, const std::vector<double>& r,
             double least_force_mn, FemReport& report) {
  Vec3d sum(0);
  double lengths = least_force_mn, energy = 0, work_of_residual = 0, farthest_mm = 0;
  for (std::size_t n = 0; n < loads.held.size(); ++n) {
    Vec3d held(0), load(0);
    for (int a = 0; a < 3; ++a) {
      const std::size_t at = 3 * n + std::size_t(a);
      if (!loads.force_mn.empty()) load[a] = loads.force_mn[at];
      energy += u[at] * (load[a] - r[at]);
      farthest_mm = std::max(farthest_mm, std::abs(u[at]));
      if ((loads.held[n] >> a & 1) != 0) {
        held[a] = -r[at];
      } else {
        work_of_residual += u[at] * r[at];
      }
    }
    sum += held + load;
    lengths += held.length() + load.length();
  }
  report.energy_mj = energy / 2 * kMjPerUj;
  report.force_balance = lengths > 0 ? sum.length() / lengths : 0;
  const double least_energy = std::max(std::abs(energy), least_force_mn * farthest_mm);
  report.energy_identity = least_energy > 0 ? std::abs(work_of_residual) / least_energy : 0;
}

}  // namespace

ElasticTable ElasticTable::uniform(double young_kpa, double poisson) {
  ElasticTable table;
  table.young_kpa.fill(young_kpa);
  table.poisson.fill(poisson);
  return table;
}

void ElasticTable::validate() const {
  for (int n = 0; n <= kLastClass; ++n) {
    require(young_kpa[n] > 0 && std::isfinite(young_kpa[n]), "stiffness", young_kpa[n],
            "above 0 kPa");
    require(poisson[n] > -1 && poisson[n] <= kLargestPoisson, "poisson", poisson[n],
            "above -1 and at most 0.4999");
  }
}

void FemParams::set_accuracy(FemAccuracy chosen) {
  const FemParams exact;
  const bool is_picture = chosen == FemAccuracy::picture;
  accuracy = chosen;
  tolerance = is_picture ? kPictureTolerance : exact.tolerance;
  reaction_tolerance = is_picture ? kPictureTolerance : exact.reaction_tolerance;
}

void FemParams::validate() const {
  require(tolerance > 0 && tolerance < 1, "tolerance", tolerance, "between 0 and 1");
  require(reaction_tolerance > 0, "reaction_tolerance", reaction_tolerance, "above 0");
  require(max_iterations > 0, "max_iterations", max_iterations, "at least 1");
  require(doublings >= 0 && doublings <= kMostDoublings, "coarsen", doublings, "0 to 3");
  require(doublings == 0 || strain == StrainTheory::linear, "coarsen", doublings,
          "0 at finite strain");
  const bool is_plain = doublings == 0 && strain == StrainTheory::linear;
  if (solver != EquationSolver::multigrid && !is_plain) {
    throw InputError(
        {"", "solver", "another program at finite strain or with coarsen", "multigrid"});
  }
  require(max_rotation_deg > 0, "max_rotation_deg", max_rotation_deg, "above 0");
  require(max_strain > 0, "max_strain", max_strain, "above 0");
}

NotConverged::NotConverged(const FemReport& report)
    : Error(not_converged_text(report)), m_report(report) {}

FemModel::FemModel(const Body& body, const ElasticTable& elastic, Dilatation dilatation,
                   Progress* progress) {
  stage(progress, "finite elements");
  m_parts = std::make_unique<Parts>(material_of(body, elastic, dilatation),
                                    hex_mesh(body, progress), progress);
}

FemModel::~FemModel() = default;

const HexMesh& FemModel::mesh() const {
  return m_parts->levels.meshes[0];
}
const VoxelMaterial& FemModel::material() const {
  return m_parts->material;
}

const HexOperator& FemModel::stiffness() const {
  return m_parts->stiffness;
}
const MeshLevels& FemModel::levels() const {
  return m_parts->levels;
}
std::size_t FemModel::bytes() const {
  return m_parts->bytes();
}

void FemModel::apply(const std::vector<double>& u_mm, std::vector<double>& force_mn) const {
  force_mn.assign(u_mm.size(), 0);
  m_parts->stiffness.add(u_mm.data(), force_mn.data());
}

FemSolution FemModel::solve(const FemLoads& loads, const FemParams& params, Progress* progress,
                            const NodeStart* start_mm) const {
  params.validate();
  const auto start = std::chrono::steady_clock::now();
  poll(progress);
  NodalLoads nodal = nodal_loads(mesh(), material(), loads, params.strain);
  FemSolution out;
  FemReport& report = out.report;
  report.elements = mesh().element_count();
  report.nodes = mesh().node_count();
  const LooseCount loose =
      hold_loose_islands(mesh(), params.loose == LooseIslands::hold, nodal.held);
  poll(progress);
  report.islands = loose.islands;
  report.loose_islands = loose.loose_islands;
  report.loose_elements = loose.loose_elements;
  if (loose.loose_islands > 0 && params.loose == LooseIslands::refuse) {
    throw InputError({"", "finite elements",
                      std::to_string(loose.loose_islands) + " pieces of " +
                          std::to_string(loose.loose_elements) + " elements that nothing holds",
                      "every piece held so that it cannot move as a rigid body"});
  }
  for (const std::uint8_t held : nodal.held) report.unknowns += 3 - __builtin_popcount(held);
  if (params.strain == StrainTheory::linear) {
    nodal.within_held_mn = forces_within_held(mesh(), material(), nodal);
    if (start_mm != nullptr) begin_from(*start_mm, nodal);
  }
  report.setup_ms = ms_since(start);
  if (params.solver != EquationSolver::multigrid) {
    solve_by_peer(nodal, params, progress, out);
  } else if (params.doublings > 0) {
    solve_coarse(nodal, params, progress, out);
  } else if (params.strain == StrainTheory::linear) {
    solve_linear(nodal, params, progress, out);
  } else {
    solve_finite(nodal, params, progress, out);
  }
  return out;
}

void FemModel::solve_linear(NodalLoads& loads, const FemParams& params, Progress* progress,
                            FemSolution& out) const {
  FemReport& report = out.report;
  const auto start = std::chrono::steady_clock::now();
  Multigrid multigrid(m_parts->levels, m_parts->stiffness, material(), loads.held, {}, progress);
  report.levels = multigrid.level_count();
  report.setup_ms += ms_since(start);

  stage(progress, "solving");
  StiffnessSystem system(m_parts->stiffness, multigrid);
  ConjugateGradients solver(system, loads,
                            {params.tolerance, params.reaction_tolerance, params.max_iterations});
  report.bytes = m_parts->bytes() + multigrid.bytes() + solver.bytes();
  run_linear(solver, loads, params, progress, out);
}

void FemModel::solve_by_peer(NodalLoads& loads, const FemParams& params, Progress* progress,
                             FemSolution& out) const {
  const bool is_dolfinx = params.solver == EquationSolver::dolfinx;
  std::unique_ptr<PeerSolver> solver;
  if (is_dolfinx) {
    solver = std::make_unique<DolfinxSolver>(stiffness(), material(), loads, params.tolerance,
                                             params.max_iterations);
  } else {
    solver = std::make_unique<CalculixSolver>(mesh(), material(), loads, params.solver);
  }
  run_linear(*solver, loads, params, progress, out);
  out.report.bytes = m_parts->bytes() + solver->bytes();
  out.report.setup_ms += solver->start_ms();
  out.report.solve_ms -= solver->start_ms();
  if (out.report.residual_max <= params.tolerance) return;
  const std::string name = is_dolfinx ? "DOLFINx" : "CalculiX";
  warn(progress, "finite elements: " + name + " left forces of up to " +
                     number_text(100 * out.report.residual_max) +
                     " % of the largest on nodes, more than the tolerance of " +
                     number_text(100 * params.tolerance) + " %");
}

void FemModel::solve_coarse(NodalLoads& loads, const FemParams& params, Progress* progress,
                            FemSolution& out) const {
  FemReport& report = out.report;
  const int most = int(levels().meshes.size()) - 1;
  require(params.doublings <= most, "coarsen", params.doublings,
          ("at most " + std::to_string(most) + " for so few elements").c_str());
  const auto start = std::chrono::steady_clock::now();
  Multigrid multigrid(levels(), stiffness(), material(), loads.held, {}, progress,
                      params.doublings);
  const HexMesh& coarse = levels().meshes[std::size_t(params.doublings)];
  report.elements = coarse.element_count();
  report.nodes = coarse.node_count();
  report.unknowns = 3 * report.nodes;
  report.levels = multigrid.level_count() - params.doublings;
  report.setup_ms += ms_since(start);

  stage(progress, "solving");
  CoarseElements solver(stiffness(), multigrid, params.doublings, loads,
                        {params.tolerance, params.reaction_tolerance, params.max_iterations});
  report.bytes = m_parts->bytes() + multigrid.bytes() + solver.bytes();
  run_linear(solver, loads, params, progress, out);
}

namespace {

template <class Solver>
bool run_told(Solver& solver, Progress* progress) {
  return solver.run(progress, progress);
}
/// Other programs do not tell how far they are.
bool run_told(PeerSolver& solver, Progress* progress) {
  return solver.run(progress);
}

}  // namespace

template <class Solver>
void FemModel::run_linear(Solver& solver, const NodalLoads& loads, const FemParams& params,
                          Progress* progress, FemSolution& out) const {
  FemReport& report = out.report;
  const auto start = std::chrono::steady_clock::now();
  const bool converged = run_told(solver, progress);
  report.iterations = solver.iterations();
  note(solver.size(), report);
  report.solve_ms = ms_since(start);
  if (!converged) throw NotConverged(report);
  balance(loads, solver.u(), solver.residual(), kLeastForce * solver.size().seen_mn, report);
  out.reactions = reactions_of(mesh(), loads, solver.residual());
  note(largest_motion(mesh(), material(), solver.u(), params.strain, limits_of(params)), report);
  report.beyond_linear = report.beyond_elements > 0;
  out.u_mm = solver.take_u();
}

void FemModel::solve_finite(NodalLoads& loads, const FemParams& params, Progress* progress,
                            FemSolution& out) const {
  FemReport& report = out.report;
  const auto start = std::chrono::steady_clock::now();
  Multigrid multigrid(m_parts->levels, m_parts->stiffness, material(), loads.held, {}, progress);
  const FiniteStrain strain(mesh(), material(), loads.swelling_kpa);
  report.levels = multigrid.level_count();
  report.setup_ms += ms_since(start);

  stage(progress, "solving");
  const auto solve_start = std::chrono::steady_clock::now();
  NewtonLimits limits;
  limits.tolerance = params.tolerance;
  limits.reaction_tolerance = params.reaction_tolerance;
  limits.max_cg_iterations = params.max_iterations;
  Newton solver(mesh(), strain, material(), multigrid, loads, limits);
  const bool converged = solver.run(progress);
  report.newton = solver.report();
  report.iterations = solver.report().cg_iterations;
  note(solver.size(), report);
  report.bytes = m_parts->bytes() + multigrid.bytes() + strain.bytes() + solver.bytes();
  report.solve_ms = ms_since(solve_start);
  if (!converged) throw NotConverged(report);
  balance(loads, solver.u(), solver.residual(), kLeastForce * solver.size().seen_mn, report);
  report.energy_mj = solver.report().energy_uj * kMjPerUj;
  out.reactions = reactions_of(mesh(), loads, solver.residual(), &solver.u());
  note(largest_motion(mesh(), material(), solver.u(), params.strain, limits_of(params)), report);
  out.u_mm = solver.take_u();
}

}  // namespace supple
