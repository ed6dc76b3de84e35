#include "lib/springs/integrator.h"

#include <algorithm>
#include <cmath>

#include "volumes/base/error.h"
#include "volumes/base/units.h"

namespace supple {

SpringStepReport& SpringStepReport::operator+=(const SpringStepReport& next) {
  substeps += next.substeps;
  halvings += next.halvings;
  iterations += next.iterations;
  residual_mn = std::max(residual_mn, next.residual_mn);
  contacts += next.contacts;
  penetration_mm = std::max(penetration_mm, next.penetration_mm);
  without_direction += next.without_direction;
  return *this;
}

SpringIntegrator::SpringIntegrator(SpringSystem& system)
    : m_system(system), m_is_held(system.node_count(), 0) {
  validate(system);
  for (const HeldNode& held : system.held) m_is_held[held.node] = 1;
  m_reactions_n.assign(system.held.size(), Vec3d(0.0));
}

SpringStepReport SpringIntegrator::step(double dt_s, const Progress* progress) {
  if (!(dt_s > 0) || !std::isfinite(dt_s)) {
    throw InputError({"", "time step", number_text(dt_s) + " s", "above 0 s"});
  }
  m_held_start.clear();
  m_held_velocity.clear();
  for (const HeldNode& held : m_system.held) {
    const Vec3d& start = m_system.pos_mm[held.node];
    m_held_start.push_back(start);
    m_held_velocity.push_back((held.target_mm - start) / dt_s);
  }
  // The inertia of a held node: the force that gives it its speed of this step, reversed.
  for (std::size_t n = 0; n < m_system.held.size(); ++n) {
    const int node = m_system.held[n].node;
    const Vec3d change = m_held_velocity[n] - m_system.velocity_mm_s[node];
    m_reactions_n[n] = change * (-m_system.mass_kg[node] / dt_s * kNPerMn);
  }
  m_first_pos = m_system.pos_mm;
  m_first_velocity = m_system.velocity_mm_s;
  m_first_reactions_n = m_reactions_n;
  m_progress = progress;
  try {
    const ContactReport before = begin_again();
    SpringStepReport report = advance(dt_s);
    report.contacts += before.contacts;
    return report;
  } catch (...) {
    m_system.pos_mm = m_first_pos;
    m_system.velocity_mm_s = m_first_velocity;
    throw;
  }
}

ContactReport SpringIntegrator::begin_again() {
  m_system.pos_mm = m_first_pos;
  m_system.velocity_mm_s = m_first_velocity;
  m_reactions_n = m_first_reactions_n;
  return leave_shapes(m_system.colliders, m_is_held, m_system.pos_mm);
}

void SpringIntegrator::place_held(double part) {
  for (std::size_t n = 0; n < m_system.held.size(); ++n) {
    const HeldNode& held = m_system.held[n];
    m_system.pos_mm[held.node] =
        part == 1 ? held.target_mm : m_held_start[n] + (held.target_mm - m_held_start[n]) * part;
    m_system.velocity_mm_s[held.node] = m_held_velocity[n];
  }
}

void SpringIntegrator::add_reactions(const std::vector<Vec3d>& force, double weight) {
  for (std::size_t n = 0; n < m_system.held.size(); ++n) {
    m_reactions_n[n] += force[m_system.held[n].node] * (weight * kNPerMn);
  }
}

void SpringIntegrator::end_contacts(const std::vector<Vec3d>& start_mm, double dt_s,
                                    SpringStepReport& report) {
  const ContactReport contact = resolve_contacts(m_system.colliders, m_is_held, start_mm, dt_s,
                                                 m_system.pos_mm, m_system.velocity_mm_s);
  report.contacts += contact.contacts;
  report.penetration_mm = std::max(report.penetration_mm, contact.penetration_mm);
}

SpringStepReport run_steps(SpringIntegrator& integrator, double dt_s, int count,
                           Progress* progress) {
  SpringStepReport sum;
  for (int n = 0; n < count; ++n) {
    report(progress, double(n) / count);
    sum += integrator.step(dt_s, progress);
  }
  return sum;
}

}  // namespace supple
