#include "lib/springs/xpbd.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "lib/springs/stability.h"
#include "volumes/base/error.h"
#include "volumes/base/units.h"

namespace supple {

namespace {

constexpr int kFewestSubsteps = 8;
constexpr int kCornerSweeps = 4;  // few corners are awake, and stiff

/// The h at which h^2 omega^2 + h gamma is what four sweeps solve to 2 %.
double longest_substep(const SpectralBounds& bounds) {
  constexpr double kStiffness = 10;
  const double omega2 = bounds.stiffness_1_s2, gamma = bounds.damping_1_s;
  if (omega2 == 0) return gamma > 0 ? kStiffness / gamma : HUGE_VAL;
  return 2 * kStiffness / (std::sqrt(gamma * gamma + 4 * kStiffness * omega2) + gamma);
}

}  // namespace

Xpbd::Xpbd(SpringSystem& system, const Params& params, const Progress* progress)
    : SpringIntegrator(system),
      m_params(params),
      m_longest_substep_s(longest_substep(spectral_bounds(system, progress))) {
  if (params.substeps < 0 || params.sweeps < 2) {
    throw InputError({"", "XPBD",
                      std::to_string(params.substeps) + " substeps of " +
                          std::to_string(params.sweeps) + " sweeps",
                      "at least two sweeps: one sweep may gain energy"});
  }
  for (std::size_t n = 0; n < system.node_count(); ++n) {
    m_inverse_mass.push_back(m_is_held[n] ? 0 : 1 / system.mass_kg[n]);
  }
}

int Xpbd::solve_spring(std::size_t n, double h) {
  const Spring& s = m_system.springs[n];
  const double w_a = m_inverse_mass[s.a] * m_slowing, w_b = m_inverse_mass[s.b] * m_slowing;
  Vec3d& a = m_system.pos_mm[s.a];
  Vec3d& b = m_system.pos_mm[s.b];
  const Vec3d x = b - a;
  const double length = std::sqrt(x.length2());
  if (length == 0) return 1;
  const Vec3d along = x / length;
  const double stiff = h * h * s.stiffness_n_m, slow = h * s.damping_n_s_m;
  double push = stiff * (length - s.rest_mm) + m_multiplier[n];
  if (slow > 0) push += slow * along.dot((b - m_start[s.b]) - (a - m_start[s.a]));
  const double change = -push / (1 + (stiff + slow) * (w_a + w_b));
  m_multiplier[n] += change;
  a -= along * (w_a * change);
  b += along * (w_b * change);
  if (w_a == 0) m_held_push[s.a] -= along * change;
  if (w_b == 0) m_held_push[s.b] += along * change;
  return 0;
}

/// Solves an awake corner like a spring; its force W b'(s) is not linear.
void Xpbd::solve_corner(std::size_t n, double h) {
  const CellBarrier::Corner& corner = m_system.barrier.awake()[n];
  const CellBarrier::Response found = m_system.barrier.response(corner, m_system.pos_mm);
  double w = 0;
  for_each_node(corner, found, [&](int node, const Vec3d& per_mm) {
    w += m_inverse_mass[node] * m_slowing * per_mm.length2();
  });
  const double push = h * h * found.first_uj + m_corner_multiplier[n];
  const double change = -push / (1 + h * h * found.second_uj * w);
  m_corner_multiplier[n] += change;
  for_each_node(corner, found, [&](int node, const Vec3d& per_mm) {
    m_system.pos_mm[node] += per_mm * (m_inverse_mass[node] * m_slowing * change);
    if (m_is_held[node]) m_held_push[node] += per_mm * change;
  });
}

void Xpbd::sweep(double h, bool forwards) {
  const std::size_t count = m_system.springs.size();
  m_without_direction = 0;
  for (std::size_t n = 0; n < count; ++n) {
    if (n % kSpringsPerPoll == 0) poll(progress());
    m_without_direction += solve_spring(forwards ? n : count - 1 - n, h);
  }
  for (int n = 0; n < kCornerSweeps; ++n) {
    for (std::size_t c = 0; c < m_corner_multiplier.size(); ++c) solve_corner(c, h);
  }
}

ContactReport Xpbd::touch_shapes(double h) {
  ContactReport report;
  if (m_system.colliders.empty()) return report;
  for (std::size_t n = 0; n < m_system.node_count(); ++n) {
    if (m_is_held[n]) continue;
    bool touched = false;
    const double left = push_out(m_system.colliders, m_start[n], h, m_system.pos_mm[n], touched);
    report.contacts += touched;
    report.penetration_mm = std::max(report.penetration_mm, left);
  }
  return report;
}

void Xpbd::add_held_forces(double h, double weight) {
  if (m_system.held.empty()) return;
  for (const HeldNode& held : m_system.held) {
    Vec3d& force = m_held_push[held.node];
    force = force / (h * h) + (m_system.gravity_m_s2 * kMmPerM -
                               m_system.velocity_mm_s[held.node] * m_system.mass_damping_per_s) *
                                  m_system.mass_kg[held.node];
  }
  add_reactions(m_held_push, weight);
}

int Xpbd::substeps_of(double dt_s) const {
  if (m_params.substeps > 0) return m_params.substeps;
  const double needed = std::ceil(dt_s / m_longest_substep_s);
  if (needed <= m_params.max_substeps) return std::max(kFewestSubsteps, int(needed));
  throw InputError(
      {"", "time step", number_text(dt_s) + " s",
       "at most " + number_text(m_params.max_substeps * m_longest_substep_s) +
           " s, beyond which XPBD is too soft for these springs, or the integrator implicit"});
}

SpringStepReport Xpbd::advance(double dt_s) {
  SpringStepReport report;
  report.substeps = substeps_of(dt_s);
  const double h = dt_s / report.substeps;
  // Mass damping taken implicitly: to forces and velocities alike masses seem larger.
  m_slowing = 1 / (1 + h * m_system.mass_damping_per_s);
  const Vec3d fall = m_system.gravity_m_s2 * (kMmPerM * h);
  for (int substep = 0; substep < report.substeps; ++substep) {
    m_start = m_system.pos_mm;
    place_held(double(substep + 1) / report.substeps);
    for (std::size_t n = 0; n < m_system.node_count(); ++n) {
      if (m_is_held[n]) continue;
      m_system.velocity_mm_s[n] = (m_system.velocity_mm_s[n] + fall) * m_slowing;
      m_system.pos_mm[n] += m_system.velocity_mm_s[n] * h;
    }
    m_system.barrier.wake(m_system.pos_mm);
    m_corner_multiplier.assign(m_system.barrier.awake().size(), 0);
    m_multiplier.assign(m_system.springs.size(), 0);
    m_held_push.assign(m_system.node_count(), Vec3d(0.0));
    ContactReport touched;  // of the last sweep
    for (int n = 0; n < m_params.sweeps; ++n) {
      sweep(h, n % 2 == 0);
      touched = touch_shapes(h);
    }
    report.contacts += touched.contacts;
    report.penetration_mm = std::max(report.penetration_mm, touched.penetration_mm);
    report.iterations += m_params.sweeps;
    report.without_direction += m_without_direction;
    for (std::size_t n = 0; n < m_system.node_count(); ++n) {
      if (!m_is_held[n]) m_system.velocity_mm_s[n] = (m_system.pos_mm[n] - m_start[n]) / h;
    }
    add_held_forces(h, 1.0 / report.substeps);
  }
  return report;
}

}  // namespace supple
