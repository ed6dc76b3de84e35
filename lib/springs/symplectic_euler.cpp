#include "lib/springs/symplectic_euler.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "volumes/base/error.h"
#include "volumes/base/units.h"

namespace supple {

namespace {

constexpr int kSubstepsPerLook = 8;  // a node goes a small part of a cell in them

/// Energy of all springs at a strain that rounding may leave in a body at rest, in uJ.
double rounding_energy(const SpringSystem& system) {
  constexpr double kStrain = 1e-9;
  double sum = 0;
  for (const Spring& s : system.springs) sum += s.stiffness_n_m * s.rest_mm * s.rest_mm;
  return 0.5 * kStrain * kStrain * sum;
}

}  // namespace

SymplecticEuler::SymplecticEuler(SpringSystem& system, const Params& params,
                                 const Progress* progress)
    : SpringIntegrator(system),
      m_params(params),
      m_bounds(spectral_bounds(system, progress)),
      m_limit_s(supple::stable_step_s(m_bounds)),
      m_noise_uj(rounding_energy(system)) {
  if (!(params.safety > 0 && params.safety < 1) || params.max_substeps < 1 ||
      !(params.most_gain > 0)) {
    throw InputError({"", "symplectic Euler",
                      "safety " + number_text(params.safety) + ", max_substeps " +
                          std::to_string(params.max_substeps) + ", most_gain " +
                          number_text(params.most_gain),
                      "a safety between 0 and 1, at least one substep and a gain above 0"});
  }
}

double SymplecticEuler::substeps_of(double dt_s, int stiff_halvings) const {
  const double halved = std::ldexp(1, m_halvings + stiff_halvings);
  double substeps = halved;
  if (dt_s >= m_limit_s) substeps *= std::ceil(dt_s / (m_params.safety * m_limit_s));
  const bool is_refused = substeps > m_params.max_substeps || (!m_params.substep && substeps > 1);
  if (!is_refused) return substeps;
  if (halved > 1) {
    throw Error("symplectic Euler: time step: found energy that grows from nothing in " +
                number_text(substeps / 2) + " substeps of a step of " + number_text(dt_s) +
                " s, expected a motion that it resolves: take a shorter step or implicit Euler");
  }
  throw InputError({"", "time step", number_text(dt_s) + " s",
                    "less than " + number_text(m_limit_s) +
                        " s, the limit of stability of symplectic Euler for these springs"});
}

double SymplecticEuler::conserved(double h) {
  forces_mn(m_system, m_force, Damping::without);
  double sum = 0;
  for (std::size_t n = 0; n < m_system.node_count(); ++n) {
    const Vec3d weight = m_system.gravity_m_s2 * (kMmPerM * m_system.mass_kg[n]);
    sum -= weight.dot(m_system.pos_mm[n] - m_origin[n]);
    if (!m_is_held[n]) sum += 0.5 * h * m_force[n].dot(m_system.velocity_mm_s[n]);
  }
  return sum + present_energy();
}

/// Energy of the springs, the barrier and free nodes, in uJ.
double SymplecticEuler::present_energy() const {
  double sum = 0;
  for (std::size_t n = 0; n < m_system.node_count(); ++n) {
    if (!m_is_held[n]) sum += 0.5 * m_system.mass_kg[n] * m_system.velocity_mm_s[n].length2();
  }
  for (const Spring& s : m_system.springs) {
    const double stretch = (m_system.pos_mm[s.b] - m_system.pos_mm[s.a]).length() - s.rest_mm;
    sum += 0.5 * s.stiffness_n_m * stretch * stretch;
  }
  return sum + m_system.barrier.energy_uj(m_system.pos_mm);
}

/// Work of holders against the present forces in a time h, in uJ.
double SymplecticEuler::work_on_held(double h) const {
  double sum = 0;
  for (const HeldNode& held : m_system.held) {
    sum -= h * m_force[held.node].dot(m_system.velocity_mm_s[held.node]);
  }
  return sum;
}

void SymplecticEuler::move_nodes(double h) {
  m_start = m_system.pos_mm;
  for (std::size_t i = 0; i < m_system.node_count(); ++i) {
    if (m_is_held[i]) continue;
    m_system.velocity_mm_s[i] += m_force[i] * (h / m_system.mass_kg[i]);  // eq. 3.18
    m_system.pos_mm[i] += m_system.velocity_mm_s[i] * h;                  // eq. 3.19
  }
}

/// Ends a substep with contact. Where that moves a node by d, the conserved sum of a linear system
/// grows by the node's kinetic energy and -F.d / 2, F the force at the start of the substep.
void SymplecticEuler::touch(double h, SpringStepReport& report) {
  if (m_system.colliders.empty()) return;
  m_before_pos = m_system.pos_mm;
  m_before_velocity = m_system.velocity_mm_s;
  end_contacts(m_start, h, report);
  for (std::size_t n = 0; n < m_system.node_count(); ++n) {
    if (m_system.pos_mm[n] == m_before_pos[n]) continue;
    m_work_uj += 0.5 * m_system.mass_kg[n] *
                 (m_system.velocity_mm_s[n].length2() - m_before_velocity[n].length2());
    m_work_uj -= 0.5 * m_force[n].dot(m_system.pos_mm[n] - m_before_pos[n]);
  }
}

/// Wakes the barrier; true where its awake corners allow substeps of h.
bool SymplecticEuler::is_stable(double h) {
  m_system.barrier.wake(m_system.pos_mm);
  if (m_system.barrier.awake().empty()) return true;
  SpectralBounds bounds = m_bounds;
  bounds.stiffness_1_s2 += m_system.barrier.stiffness_1_s2(m_system.pos_mm, m_system.mass_kg);
  return h < supple::stable_step_s(bounds);
}

std::optional<SpringStepReport> SymplecticEuler::run(double dt_s, double substeps) {
  SpringStepReport report;
  report.substeps = int(substeps);
  const double h = dt_s / substeps;
  m_work_uj = 0;
  for (int n = 0; n < report.substeps; ++n) {
    poll(progress());
    if (n % kSubstepsPerLook == 0 && !is_stable(h)) return std::nullopt;
    place_held(n / substeps);
    report.without_direction += forces_mn(m_system, m_force, Damping::with);
    add_reactions(m_force, 1 / substeps);
    m_work_uj += work_on_held(n == 0 ? h / 2 : h);
    move_nodes(h);
    place_held((n + 1) / substeps);
    touch(h, report);
  }
  forces_mn(m_system, m_force, Damping::with);
  m_work_uj += work_on_held(h / 2);
  return report;
}

SpringStepReport SymplecticEuler::advance(double dt_s) {
  m_origin = m_system.pos_mm;
  const double start_energy = present_energy();
  int halvings = 0, stiff_halvings = 0;  // in this step, for its energy and for the barrier
  for (;;) {
    const double substeps = substeps_of(dt_s, stiff_halvings), h = dt_s / substeps;
    const double before = conserved(h);
    std::optional<SpringStepReport> report = run(dt_s, substeps);
    if (!report) {
      ++stiff_halvings;
      begin_again();
      continue;
    }
    const double gain = m_gain_uj + conserved(h) - before - m_work_uj;  // NaN past all bounds
    if (gain <= m_params.most_gain * std::max(start_energy, present_energy()) + m_noise_uj) {
      m_gain_uj = std::max(0.0, gain);
      report->halvings = halvings + stiff_halvings;
      return *report;
    }
    ++halvings;
    m_gain_uj = 0;
    ++m_halvings;
    begin_again();
  }
}

}  // namespace supple
