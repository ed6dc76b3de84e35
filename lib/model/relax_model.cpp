#include "lib/model/relax_model.h"

#include <algorithm>

#include "lib/chainmail/ecm.h"
#include "lib/model/quasi_static.h"
#include "lib/relax/plastic_flow.h"
#include "volumes/base/stopwatch.h"
#include "volumes/base/units.h"

namespace supple {

const char* name_of(RelaxEnd end) {
  static constexpr const char* kNames[] = {"passes", "at rest", "converged", "budget"};
  return kNames[std::size_t(end)];
}

RelaxModel::RelaxModel(const HeldBody& held, const RelaxParams& params)
    : m_held(held), m_params(params), m_begin(std::chrono::steady_clock::now()) {
  params.validate();
  m_moduli = moduli_of(held.body, params);
  m_anchored = anchored_elements(held.body, held.anchors, held.holds);
  if (!held.body.links_known_valid || held.body.beyond) {
    const ProjectionReport projection = project(held.body, m_anchored, held.holds);
    m_report.projected_links = projection.violated_links;
    m_report.projected_max_voxels = projection.max_move_voxels;
    m_report.projected_held = projection.held_moved;
  }
  begin();
}

RelaxModel::~RelaxModel() = default;

void RelaxModel::begin() {
  if (m_moduli.any() && !m_report.volumes_before) {
    m_report.volumes_before = cell_volumes(m_held.body);
    m_report.bulk_modulus_kpa = m_moduli.kpa;
  }
  if (m_relaxation) m_work += m_relaxation->work();
  m_relaxation =
      std::make_unique<Relaxation>(m_held.body, m_anchored, m_held.holds, m_params, m_moduli);
}

/// Writes the offsets to the body.
void RelaxModel::put() {
  m_relaxation->store();
  m_held.body.links_known_valid = m_params.method != RelaxMethod::plain && knows_all_links();
}

bool RelaxModel::knows_all_links() const {
  return spring_links(m_held.body, m_moduli.any()) == m_held.body.slacks.links();
}

/// Moves back what diagonals do not allow where volume is conserved, as springs and steps know axis
/// links only there; passes go on from there.
void RelaxModel::keep_diagonals() {
  if (knows_all_links() || m_params.method == RelaxMethod::plain) return;
  const ProjectionReport projection = project(m_held.body, m_anchored, m_held.holds);
  if (projection.violated_links == 0) return;
  m_report.diagonal_links = projection.violated_links;
  m_report.diagonal_max_voxels = projection.max_move_voxels;
  begin();
}

void RelaxModel::move(const std::vector<Handle>& handles, int, Progress* progress) {
  put();
  keep_diagonals();
  EcmSolver(m_held.body).drag(handles, m_held.anchors, m_held.holds, progress);
  m_anchored = anchored_elements(m_held.body, m_held.anchors, m_held.holds);
  begin();
}

bool RelaxModel::step(const Progress*) {
  m_energy_before_flow.reset();
  m_report.largest_step_voxels = m_relaxation->pass();
  if (m_report.passes == 0) m_report.energy_before = m_relaxation->energy_before_pass();
  ++m_report.passes;
  m_report.converged = m_report.largest_step_voxels <= m_params.tolerance_voxels && forces_agree();
  m_report.looked_at_million = (m_work + m_relaxation->work()) / 1e6;
  const double budget = m_params.budget_million;
  const bool is_spent = budget > 0 && m_report.looked_at_million >= budget;
  m_report.end = m_report.converged                  ? RelaxEnd::converged
                 : m_report.largest_step_voxels == 0 ? RelaxEnd::at_rest
                 : is_spent                          ? RelaxEnd::budget
                                                     : RelaxEnd::passes;
  return m_report.end == RelaxEnd::passes;
}

double RelaxModel::part_done() const {
  if (m_params.budget_million <= 0) return 0;
  return std::min(1.0, m_report.looked_at_million / m_params.budget_million);
}

/// True where the forces that are left put the energy near the least (RelaxReport::converged).
bool RelaxModel::forces_agree() {
  constexpr double kPart = 0.01, kPartOfStart = 1e-6;
  if (m_params.budget_million > 0) {
    // A look takes as long as some passes.
    constexpr int kPassesPerLook = 8;
    if (m_report.passes < m_next_look && m_report.largest_step_voxels > 0) return false;
    m_next_look = m_report.passes + std::max(kPassesPerLook, m_report.passes / 8);
  }
  m_report.energy_excess = m_relaxation->excess();
  if (!m_report.energy_excess) return true;
  return *m_report.energy_excess <=
         std::max(kPart * m_relaxation->energy(), kPartOfStart * m_report.energy_before);
}

ModelEnergy RelaxModel::energy() {
  return {m_relaxation->energy() * kJPerUj, 0, 0};
}

std::vector<Reaction> RelaxModel::reactions(const std::vector<Handle>& handles) {
  put();
  return quasi_static_reactions(m_held, elements_of_handles(m_held.body, handles), m_moduli);
}

void RelaxModel::store() {
  put();
  keep_diagonals();
  Body& body = m_held.body;
  if (body.material.has_yield_strain() && m_report.passes > m_stored_passes) {
    m_energy_before_flow = m_relaxation->energy();
    m_report.yielded_links += let_flow(body);
  }
  m_stored_passes = m_report.passes;
}

RelaxReport RelaxModel::report() {
  m_report.energy_after = m_energy_before_flow ? *m_energy_before_flow : m_relaxation->energy();
  if (m_report.passes == 0) m_report.energy_before = m_report.energy_after;
  if (m_report.volumes_before) m_report.volumes_after = cell_volumes(m_held.body);
  m_report.milliseconds = ms_since(m_begin);
  return m_report;
}

RelaxReport relax(Body& body, const std::vector<Region>& fixed, const Holds& held,
                  const RelaxParams& params, Progress* progress) {
  Holds holds = held;
  RelaxModel model({body, fixed, holds}, params);
  run_model(model, params.passes, progress);
  return model.report();
}

}  // namespace supple
