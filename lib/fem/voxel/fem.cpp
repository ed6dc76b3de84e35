#include "lib/fem/voxel/fem.h"

#include <algorithm>

#include "lib/fem/conjugate_gradients.h"
#include "lib/fem/newton.h"
#include "lib/fem/peers/calculix.h"
#include "lib/fem/peers/dolfinx.h"
#include "lib/fem/voxel/coarse_elements.h"
#include "lib/fem/voxel/fem_results.h"
#include "lib/fem/voxel/hinges.h"
#include "lib/fem/voxel/loose_islands.h"
#include "lib/fem/voxel/voxel_systems.h"
#include "volumes/base/stopwatch.h"
#include "volumes/base/units.h"

namespace supple {

struct FemModel::Parts {
  VoxelMaterial material;
  TouchingRule touching;
  MeshLevels levels;
  HexOperator stiffness;

  Parts(const Body& body, VoxelMaterial of, TouchingRule rule, Progress* progress)
      : material(std::move(of)),
        touching(std::move(rule)),
        levels(hex_mesh(body, touching, progress), progress),
        stiffness(levels.meshes[0], material) {}

  std::size_t bytes() const {
    return material.classes.capacity() + levels.bytes() + stiffness.bytes();
  }
};

namespace {

/// Held nodes stay prescribed. A start of another mesh does not count.
void begin_from(const NodeStart& start_mm, NodalLoads& loads) {
  if (start_mm.size() != loads.u_mm.size()) return;
  for (std::size_t n = 0; n < loads.u_mm.size(); ++n) {
    if ((loads.held[n / 3] >> n % 3 & 1) == 0) loads.u_mm[n] = double(start_mm[n]);
  }
}

}  // namespace

FemModel::FemModel(const Body& body, const ElasticTable& elastic, const ElementChoice& choice,
                   Progress* progress) {
  stage(progress, "finite elements");
  m_parts = std::make_unique<Parts>(body, voxel_material(body, elastic, choice.dilatation),
                                    TouchingRule{choice.touching}, progress);
}

FemModel::~FemModel() = default;

/// Finds hinged elements but for loose islands, which are held or refused as wholes.
std::vector<bool> FemModel::hinged(const HeldBits& held) const {
  if (m_parts->touching.touching == Touching::apart) return {};
  HeldBits all_held = held;
  const bool is_free = std::all_of(held.begin(), held.end(), [](auto bits) { return bits == 0; });
  if (!is_free) hold_loose(true, all_held);
  return hinged_elements(mesh(), all_held);
}

bool FemModel::part_hinges(const Body& body, const HeldBits& held, Progress* progress) {
  std::vector<bool> apart = hinged(held);
  if (apart.empty()) return false;
  const std::vector<bool>& known = m_parts->touching.apart;
  for (std::size_t e = 0; e < known.size(); ++e) apart[e] = apart[e] || known[e];
  m_parts = std::make_unique<Parts>(body, m_parts->material,
                                    TouchingRule{Touching::joined, std::move(apart)}, progress);
  return true;
}

void FemModel::join_hinges(const Body& body, Progress* progress) {
  if (m_parts->touching.apart.empty()) return;
  m_parts =
      std::make_unique<Parts>(body, m_parts->material, TouchingRule{Touching::joined}, progress);
}

/// Elements that part_hinges() has parted.
const std::vector<bool>& FemModel::parted() const {
  return m_parts->touching.apart;
}

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

std::vector<Vec3d> FemModel::node_positions() const {
  return supple::node_positions(mesh());
}
std::vector<Vec3d> FemModel::node_positions(const std::vector<NodeIndex>& nodes) const {
  return supple::node_positions(mesh(), nodes);
}
NodePieces FemModel::node_pieces() const {
  Islands islands = find_islands(mesh());
  return {std::move(islands.of_node), islands.count};
}
LooseCount FemModel::hold_loose(bool holds, HeldBits& held) const {
  return hold_loose_islands(mesh(), holds, held);
}

const Operator& FemModel::matrix() const {
  return m_parts->stiffness;
}
std::unique_ptr<Operator> FemModel::weighted(const ElementWeights& weights) const {
  return std::make_unique<WeightedOperator>(mesh(), weighted_material(material(), weights));
}
std::unique_ptr<LinearSystem> FemModel::system(const ElementWeights* weights, const HeldBits& held,
                                               Progress* progress) const {
  if (weights == nullptr) {
    return std::make_unique<VoxelSystem>(levels(), stiffness(), material(), held, progress);
  }
  return std::make_unique<VoxelSystem>(
      levels(), std::make_unique<WeightedOperator>(mesh(), weighted_material(material(), *weights)),
      held, progress);
}

void FemModel::apply(const std::vector<double>& u_mm, std::vector<double>& force_mn) const {
  force_mn.assign(u_mm.size(), 0);
  m_parts->stiffness.add(u_mm.data(), force_mn.data());
}

NodalLoads FemModel::checked_loads(const FemLoads& loads, const FemParams& params,
                                   Progress* progress, FemReport& report) const {
  params.validate();
  poll(progress);
  NodalLoads nodal = nodal_loads(mesh(), material(), loads, params.strain);
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
  const std::vector<bool> hanging = hinged(nodal.held);
  if (!hanging.empty()) {
    throw InputError({"", "touching",
                      std::to_string(std::count(hanging.begin(), hanging.end(), true)) +
                          " elements that hang by edges or corners and can turn there",
                      "pieces that what they touch keeps from turning, or apart"});
  }
  for (const std::uint8_t held : nodal.held) report.unknowns += 3 - __builtin_popcount(held);
  if (params.strain == StrainTheory::linear) {
    nodal.within_held_mn = forces_within_held(mesh(), material(), nodal);
  }
  return nodal;
}

FemSolution FemModel::solve(const FemLoads& loads, const FemParams& params, Progress* progress,
                            const NodeStart* start_mm) const {
  const Stopwatch clock;
  FemSolution out;
  FemReport& report = out.report;
  NodalLoads nodal = checked_loads(loads, params, progress, report);
  if (params.strain == StrainTheory::linear && start_mm != nullptr) begin_from(*start_mm, nodal);
  report.setup_ms = clock.ms();
  if (params.solver != EquationSolver::multigrid) {
    solve_by_peer(nodal, params, progress, out);
  } else if (params.doublings > 0) {
    solve_coarse(nodal, params, progress, out);
  } else if (params.strain == StrainTheory::linear) {
    solve_linear(nodal, params, progress, out);
  } else {
    solve_finite(nodal, params, progress, out);
  }
  report.volume_change_ml =
      volume_change_mm3(mesh(), material(), out.u_mm, params.strain) * kMlPerMm3;
  out.swelling_kpa = std::move(nodal.swelling_kpa);
  return out;
}

void FemModel::solve_linear(NodalLoads& loads, const FemParams& params, Progress* progress,
                            FemSolution& out) const {
  FemReport& report = out.report;
  const Stopwatch clock;
  VoxelSystem system(levels(), stiffness(), material(), loads.held, progress);
  report.levels = system.level_count();
  report.setup_ms += clock.ms();

  stage(progress, "solving");
  CgLimits limits{params.residual_limit(), params.reaction_limit(), params.max_iterations};
  limits.error_mm = params.error_limit_mm();
  limits.contrast = free_contrast(mesh(), material(), loads.held);
  limits.ritz_value = out.ritz_value;
  ConjugateGradients solver(system, loads, limits);
  report.bytes = m_parts->bytes() + system.bytes() + solver.bytes();
  run_linear(solver, loads, params, progress, out);
}

PeerProblem FemModel::peer_problem() const {
  PeerProblem problem{node_positions(), {}, material().classes, material().moduli};
  problem.is_pointwise = material().matrix.dilatation == Dilatation::pointwise;
  problem.is_mirrored = mesh().geometry.determinant() < 0;
  problem.stiffness = &matrix();
  for (std::size_t b = 0; b < mesh().block_count(); ++b) {
    for (auto e = mesh().element_begin[b]; e < mesh().element_begin[b + 1]; ++e) {
      problem.corners.push_back(mesh().corners_in(b, e));
    }
  }
  return problem;
}

void FemModel::solve_by_peer(NodalLoads& loads, const FemParams& params, Progress* progress,
                             FemSolution& out) const {
  const bool is_dolfinx = params.solver == EquationSolver::dolfinx;
  const PeerProblem problem = peer_problem();
  std::unique_ptr<PeerSolver> solver;
  if (is_dolfinx) {
    solver = std::make_unique<DolfinxSolver>(problem, loads, params.residual_limit(),
                                             params.max_iterations);
  } else {
    solver = std::make_unique<CalculixSolver>(problem, loads,
                                              params.solver == EquationSolver::calculix_iterative);
  }
  run_linear(*solver, loads, params, progress, out);
  out.report.bytes = m_parts->bytes() + solver->bytes();
  out.report.setup_ms += solver->start_ms();
  out.report.solve_ms -= solver->start_ms();
  if (out.report.residual_max <= params.residual_limit()) return;
  const std::string name = is_dolfinx ? "DOLFINx" : "CalculiX";
  warn(progress, "finite elements: " + name + " left forces of up to " +
                     number_text(100 * out.report.residual_max) +
                     " % of the largest on nodes, more than the tolerance of " +
                     number_text(100 * params.residual_limit()) + " %");
}

void FemModel::solve_coarse(NodalLoads& loads, const FemParams& params, Progress* progress,
                            FemSolution& out) const {
  FemReport& report = out.report;
  const int most = int(levels().meshes.size()) - 1;
  require(params.doublings <= most, "coarsen", params.doublings,
          "at most " + std::to_string(most) + " for so few elements");
  const Stopwatch clock;
  Multigrid multigrid(levels(), stiffness(), material(), loads.held, {}, progress,
                      params.doublings);
  const HexMesh& coarse = levels().meshes[std::size_t(params.doublings)];
  report.elements = coarse.element_count();
  report.nodes = coarse.node_count();
  report.unknowns = 3 * report.nodes;
  report.levels = multigrid.level_count() - params.doublings;
  report.setup_ms += clock.ms();

  stage(progress, "solving");
  CoarseElements solver(stiffness(), multigrid, params.doublings, loads,
                        {params.residual_limit(), params.reaction_limit(), params.max_iterations});
  report.bytes = m_parts->bytes() + multigrid.bytes() + solver.bytes();
  run_linear(solver, loads, params, progress, out);
}

namespace {

void note_error(const ConjugateGradients& solver, FemSolution& out) {
  out.report.error_mm = solver.error_mm();
  out.ritz_value = solver.ritz_value();
}
/// Others tell none.
template <class Solver>
void note_error(const Solver&, FemSolution&) {}

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
  const Stopwatch clock;
  const bool converged = run_told(solver, progress);
  report.iterations = solver.iterations();
  note(solver.size(), report);
  note_error(solver, out);
  out.reaction_change_mn = solver.size().reaction_change_mn;
  report.solve_ms = clock.ms();
  if (!converged) throw NotConverged(report);
  conclude(loads, params, solver.size(), solver.residual(), solver.take_u(), out);
}

/// Notes all that follows from displacements and the residual that they leave.
void FemModel::conclude(const NodalLoads& loads, const FemParams& params, const ResidualSize& size,
                        const std::vector<double>& residual, std::vector<double> u,
                        FemSolution& out) const {
  FemReport& report = out.report;
  balance(loads, u, residual, kLeastForce * size.seen_mn, report);
  out.reactions = reactions_of(*this, loads, residual);
  note(largest_motion(mesh(), material(), u, params.strain, limits_of(params)), report);
  report.beyond_linear = report.beyond_elements > 0;
  out.u_mm = std::move(u);
}

void FemModel::solve_finite(NodalLoads& loads, const FemParams& params, Progress* progress,
                            FemSolution& out) const {
  FemReport& report = out.report;
  const Stopwatch clock;
  Multigrid multigrid(m_parts->levels, m_parts->stiffness, material(), loads.held, {}, progress);
  const FiniteStrain strain(mesh(), material(), loads.swelling_kpa);
  report.levels = multigrid.level_count();
  report.setup_ms += clock.ms();

  stage(progress, "solving");
  const Stopwatch solve_clock;
  NewtonLimits limits;
  limits.tolerance = params.residual_limit();
  limits.reaction_tolerance = params.reaction_limit();
  limits.max_cg_iterations = params.max_iterations;
  const FiniteVoxels voxels(mesh(), strain, material(), multigrid, loads.held);
  Newton solver(*this, voxels, loads, limits);
  const bool converged = solver.run(progress);
  report.newton = solver.report();
  report.iterations = solver.report().cg_iterations;
  note(solver.size(), report);
  report.bytes = m_parts->bytes() + multigrid.bytes() + strain.bytes() + solver.bytes();
  report.solve_ms = solve_clock.ms();
  if (!converged) throw NotConverged(report);
  const double energy_uj = loads.swelling_kpa.empty()
                               ? solver.report().energy_uj
                               : take_swellings(voxels, solver.u(), solver.residual(), loads);
  balance(loads, solver.u(), solver.residual(), kLeastForce * solver.size().seen_mn, report);
  report.energy_mj = energy_uj * kMjPerUj;
  out.reactions = reactions_of(*this, loads, solver.residual(), &solver.u());
  note(largest_motion(mesh(), material(), solver.u(), params.strain, limits_of(params)), report);
  out.u_mm = solver.take_u();
}

}  // namespace supple
