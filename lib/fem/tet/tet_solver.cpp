#include <algorithm>
#include <cmath>

#include "lib/fem/conjugate_gradients.h"
#include "lib/fem/tet/finite_tets.h"
#include "lib/fem/tet/sparse_factor.h"
#include "lib/fem/tet/tet_fem.h"
#include "lib/fem/tet/tet_system.h"
#include "volumes/base/stopwatch.h"
#include "volumes/base/text.h"
#include "volumes/base/units.h"

namespace supple {

namespace {

/// Corrections by the residual after the solution with exact factors.
constexpr int kMostRefinements = 5;

void check_all_finite(const std::vector<double>& values) {
  for (const double value : values) {
    if (std::isfinite(value)) continue;
    throw InputError({"", "loads", number_text(value), "finite forces and displacements"});
  }
}

/// Holds loose pieces, or refuses them; begins the report.
FemReport report_of_pieces(const TetModel& model, LooseIslands treatment, HeldBits& held) {
  FemReport report;
  const LooseCount loose = model.hold_loose(treatment == LooseIslands::hold, held);
  if (loose.loose_islands > 0 && treatment == LooseIslands::refuse) {
    throw InputError({"", "finite elements",
                      std::to_string(loose.loose_islands) + " pieces of " +
                          std::to_string(loose.loose_elements) + " elements that nothing holds",
                      "every piece held so that it cannot move as a rigid body"});
  }
  report.islands = loose.islands;
  report.loose_islands = loose.loose_islands;
  report.loose_elements = loose.loose_elements;
  report.elements = model.element_count();
  report.nodes = std::int64_t(model.place_count());
  for (const std::uint8_t of : held) report.unknowns += 3 - __builtin_popcount(of);
  report.levels = 1;
  return report;
}

}  // namespace

void TetParams::validate() const {
  require(tolerance > 0 && tolerance < 1, "tolerance", tolerance, "between 0 and 1");
  require(reaction_tolerance > 0, "reaction_tolerance", reaction_tolerance, "above 0");
  require(max_iterations > 0, "max_iterations", max_iterations, "at least 1");
  if (strain == StrainTheory::finite && equations == TetEquations::factor) {
    throw InputError({"", "equations", "exact factors", "conjugate gradients at finite strain"});
  }
  require(limits.rotation_deg > 0, "max_rotation_deg", limits.rotation_deg, "above 0");
  require(limits.strain > 0, "max_strain", limits.strain, "above 0");
}

void TetModel::require_place(NodeIndex node, const char* of) const {
  if (node >= 0 && std::size_t(node) < place_count()) return;
  throw InputError(
      {"", of, "node " + std::to_string(node), "0 to " + std::to_string(place_count() - 1)});
}

/// Marks what is held and where it is led, with the turns of clamped edges.
void TetModel::hold(const TetHeld& held, NodalLoads& out) const {
  const std::size_t count = held.displacement_mm.size();
  if (count > 1 && count != held.nodes.size()) {
    throw InputError({"", "held", std::to_string(count) + " displacements",
                      std::to_string(held.nodes.size()) + ", one per node, or one for all"});
  }
  std::vector<char> is_here(place_count(), 0);
  for (std::size_t n = 0; n < held.nodes.size(); ++n) {
    const NodeIndex node = held.nodes[n];
    require_place(node, "held");
    is_here[std::size_t(node)] = 1;
    out.held[std::size_t(node)] |= held.components;
    const Vec3d u = count == 0 ? Vec3d(0) : held.displacement_mm[count == 1 ? 0 : n];
    for (int a = 0; a < 3; ++a) {
      if ((held.components >> a & 1) != 0) out.u_mm[3 * std::size_t(node) + std::size_t(a)] = u[a];
    }
  }
  out.nodes_of.push_back(held.nodes);
  for (std::size_t e = 0; e < m_shells.edges().size() && held.holds_turns; ++e) {
    const auto [a, b] = m_shells.edges()[e];
    if (is_here[std::size_t(a)] == 0 || is_here[std::size_t(b)] == 0) continue;
    out.held[place_count() + e / 3] |= std::uint8_t(1 << e % 3);
  }
}

void TetModel::add_swelling(const TetLoads& loads, StrainTheory strain, NodalLoads& out) const {
  if (loads.swelling_kpa.empty()) return;
  if (loads.swelling_kpa.size() != m_volumes.element_count()) {
    throw InputError({"", "swelling", std::to_string(loads.swelling_kpa.size()) + " values",
                      std::to_string(m_volumes.element_count()) + ", one per element"});
  }
  check_all_finite(loads.swelling_kpa);
  if (strain == StrainTheory::finite) {
    out.swelling_kpa = loads.swelling_kpa;
  } else {
    m_volumes.add_swelling(loads.swelling_kpa, out.force_mn);
  }
}

void TetModel::add_gravity(const TetLoads& loads, std::vector<double>& force_mn) const {
  if (loads.gravity_m_s2 == Vec3d(0)) return;
  if (loads.density_kg_m3.size() != m_moduli.size()) {
    throw InputError({"", "density", std::to_string(loads.density_kg_m3.size()) + " values",
                      std::to_string(m_moduli.size()) + ", one per material"});
  }
  std::vector<Vec3d> weights;
  for (const double density : loads.density_kg_m3) {
    weights.push_back(loads.gravity_m_s2 * (density * kMmPerM * kM3PerMm3));
  }
  m_volumes.add_body_force(weights, force_mn);
}

NodalLoads TetModel::nodal_loads(const TetLoads& loads, StrainTheory strain) const {
  const std::size_t unknowns = 3 * std::size_t(node_count());
  NodalLoads out;
  out.held.assign(std::size_t(node_count()), 0);
  out.u_mm.assign(unknowns, 0);
  out.force_mn.assign(unknowns, 0);
  for (const TetHeld& held : loads.held) hold(held, out);
  for (const TetForce& force : loads.forces) {
    require_place(force.node, "forces");
    for (int a = 0; a < 3; ++a) {
      out.force_mn[3 * std::size_t(force.node) + std::size_t(a)] += force.force_mn[a];
    }
  }
  for (const FacePressure& pressure : loads.pressures) add_pressure(pressure, out.force_mn);
  add_swelling(loads, strain, out);
  add_gravity(loads, out.force_mn);
  check_all_finite(out.force_mn);
  check_all_finite(out.u_mm);
  return out;
}

/// A face with six nodes has its whole load in the middles of its edges.
void TetModel::add_pressure(const FacePressure& pressure, std::vector<double>& force_mn) const {
  for (const auto& [a, b, c] : faces_named(pressure.faces).triangles) {
    const Vec3d& from = m_positions[std::size_t(a)];
    const Vec3d area =
        (m_positions[std::size_t(b)] - from).cross(m_positions[std::size_t(c)] - from) / 2;
    std::array<NodeIndex, 3> at{m_volumes.middle_of(a, b), m_volumes.middle_of(b, c),
                                m_volumes.middle_of(c, a)};
    if (std::min({at[0], at[1], at[2]}) < 0) at = {a, b, c};
    for (const NodeIndex node : at) {
      for (int m = 0; m < 3; ++m) {
        force_mn[3 * std::size_t(node) + std::size_t(m)] -= pressure.pressure_kpa * area[m] / 3;
      }
    }
  }
}

struct TetSolver::Parts {
  const TetModel& model;
  TetParams params;
  HeldBits held;   // as the loads have it
  HeldBits fixed;  // with loose pieces, if these are held
  FemReport report;
  std::unique_ptr<TetSystem> system;
  std::unique_ptr<SparseFactor> factor;

  bool solve_by_factor(NodalLoads& loads, std::vector<double>& r, ResidualSize& size) const;
};

TetSolver::TetSolver(const TetModel& model, const TetLoads& held, const TetParams& params,
                     Progress* progress) {
  params.validate();
  if (params.strain == StrainTheory::finite) {
    throw InputError({"", "strain", "finite", "linear where one system serves many loads"});
  }
  poll(progress);
  const Stopwatch clock;
  TetLoads alone;
  alone.held = held.held;
  const HeldBits bits = model.nodal_loads(alone).held;
  m_parts = std::make_unique<Parts>(Parts{model, params, bits, bits, {}, nullptr, nullptr});
  FemReport& report = m_parts->report = report_of_pieces(model, params.loose, m_parts->fixed);
  if (params.equations == TetEquations::gradients) {
    m_parts->system = std::make_unique<TetSystem>(model.stiffness(), m_parts->fixed);
  } else {
    m_parts->factor =
        std::make_unique<SparseFactor>(model.stiffness(), m_parts->fixed, model.node_positions());
  }
  report.bytes = bytes();
  report.setup_ms = clock.ms();
}

TetSolver::~TetSolver() = default;

std::size_t TetSolver::bytes() const {
  return m_parts->model.bytes() + (m_parts->system ? m_parts->system->bytes() : 0) +
         (m_parts->factor ? m_parts->factor->bytes() : 0);
}

/// Leaves u in loads.u_mm and f - K u in r.
bool TetSolver::Parts::solve_by_factor(NodalLoads& loads, std::vector<double>& r,
                                       ResidualSize& size) const {
  ResidualMeter meter(loads);
  std::vector<double> z(r.size());
  for (int round = 0;; ++round) {
    set_to_forces(loads, r);
    model.stiffness().subtract(loads.u_mm.data(), r.data());
    size = meter(r);
    size.reaction_change = 0;  // of exact factors
    const bool is_within = size.is_within(params.tolerance, params.reaction_tolerance);
    if ((round > 1 && is_within) || size.largest_mn == 0) return true;
    if (round > kMostRefinements) return false;
    factor->solve(r.data(), z.data());
    for (std::size_t n = 0; n < z.size(); ++n) loads.u_mm[n] += z[n];
  }
}

TetSolution TetSolver::solve(const TetLoads& loads, Progress* progress) const {
  const TetParams& params = m_parts->params;
  NodalLoads nodal = m_parts->model.nodal_loads(loads);
  if (nodal.held != m_parts->held) {
    throw InputError({"", "held", "other components than the equations were made ready for",
                      "the same nodes and components"});
  }
  nodal.held = m_parts->fixed;
  const Stopwatch clock;
  TetSolution out;
  out.report = m_parts->report;
  std::vector<double> r(nodal.u_mm.size());
  ResidualSize size;
  bool is_found = false;
  stage(progress, "solving");
  if (m_parts->factor) {
    is_found = m_parts->solve_by_factor(nodal, r, size);
    out.u_mm = std::move(nodal.u_mm);
  } else {
    ConjugateGradients solver(*m_parts->system, nodal,
                              {params.tolerance, params.reaction_tolerance, params.max_iterations});
    is_found = solver.run(progress, progress);
    out.report.iterations = solver.iterations();
    out.report.bytes += solver.bytes();
    size = solver.size();
    r = solver.residual();
    out.u_mm = solver.take_u();
  }
  note(size, out.report);
  out.report.solve_ms = clock.ms();
  if (!is_found) throw NotConverged(out.report);
  balance(nodal, out.u_mm, r, kLeastForce * size.seen_mn, out.report);
  out.reactions = reactions_of(m_parts->model, nodal, r);
  m_parts->model.note_motion(out, loads, params.limits);
  return out;
}

void TetModel::note_motion(TetSolution& solution, const TetLoads& loads,
                           const MotionLimits& limits) const {
  FemReport& report = solution.report;
  for (const ElementState& state : states(solution, loads)) {
    const double turn = state.rotation_rad.length() * kDegreesPerRadian;
    const std::array<double, 3> principal = eigenvalues(state.strain);
    const double strain = std::max(std::abs(principal[0]), std::abs(principal[2]));
    report.largest_rotation_deg = std::max(report.largest_rotation_deg, turn);
    report.largest_strain = std::max(report.largest_strain, strain);
    report.beyond_elements += turn > limits.rotation_deg || strain > limits.strain;
  }
  report.beyond_linear = solution.strain == StrainTheory::linear && report.beyond_elements > 0;
  solution.least_det_f = m_volumes.least_det_f(solution.u_mm);
}

TetSolution TetModel::solve_finite(const TetLoads& loads, const TetParams& params,
                                   Progress* progress) const {
  params.validate();
  poll(progress);
  const Stopwatch clock;
  NodalLoads nodal = nodal_loads(loads, StrainTheory::finite);
  TetSolution out;
  out.strain = StrainTheory::finite;
  out.report = report_of_pieces(*this, params.loose, nodal.held);
  const FiniteTets system(*this, nodal.held, nodal.swelling_kpa);
  out.report.setup_ms = clock.ms();
  stage(progress, "solving");
  Newton solver(*this, system, nodal,
                {params.tolerance, params.reaction_tolerance, params.max_iterations});
  const bool is_found = solver.run(progress);
  out.report.newton = solver.report();
  out.report.iterations = solver.report().cg_iterations;
  note(solver.size(), out.report);
  out.report.bytes = bytes() + system.bytes() + solver.bytes();
  out.report.solve_ms = clock.ms() - out.report.setup_ms;
  if (!is_found) throw NotConverged(out.report);
  const double energy_uj = nodal.swelling_kpa.empty()
                               ? solver.report().energy_uj
                               : take_swellings(system, solver.u(), solver.residual(), nodal);
  balance(nodal, solver.u(), solver.residual(), kLeastForce * solver.size().seen_mn, out.report);
  out.report.energy_mj = energy_uj * kMjPerUj;
  out.reactions = reactions_of(*this, nodal, solver.residual(), &solver.u());
  out.u_mm = solver.take_u();
  note_motion(out, loads, params.limits);
  return out;
}

TetSolution TetModel::solve(const TetLoads& loads, const TetParams& params,
                            Progress* progress) const {
  if (params.strain == StrainTheory::finite) return solve_finite(loads, params, progress);
  return TetSolver(*this, loads, params, progress).solve(loads, progress);
}

}  // namespace supple
