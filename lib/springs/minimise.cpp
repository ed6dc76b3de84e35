#include "lib/springs/minimise.h"

#include <algorithm>
#include <cmath>

#include "lib/springs/spring_matrix.h"
#include "volumes/base/error.h"
#include "volumes/base/units.h"

namespace supple {

namespace {

// Part of the forces that conjugate gradients leave. With 1e-4 as many steps lead to the minimum
// and take three to five times as long.
constexpr double kInexact = 1e-2;

/// Energy in microjoules with gravity against `from`, so that its differences keep their digits.
double potential(const SpringSystem& system, const std::vector<Vec3d>& from) {
  double sum = 0;
  for (std::size_t n = 0; n < system.node_count(); ++n) {
    sum -= system.mass_kg[n] * system.gravity_m_s2.dot(system.pos_mm[n] - from[n]) * kMmPerM;
  }
  for (const Spring& s : system.springs) {
    const double stretch = (system.pos_mm[s.b] - system.pos_mm[s.a]).length() - s.rest_mm;
    sum += 0.5 * s.stiffness_n_m * stretch * stretch;
  }
  return sum + system.barrier.energy_uj(system.pos_mm);
}

/// Finds the forces, 0 at held nodes; returns the largest.
double free_forces(const SpringSystem& system, const std::vector<char>& is_held,
                   std::vector<Vec3d>& force) {
  forces_mn(system, force, Damping::without);
  double largest2 = 0;
  for (std::size_t n = 0; n < force.size(); ++n) {
    if (is_held[n]) force[n] = Vec3d(0.0);
    largest2 = std::max(largest2, force[n].length2());
  }
  return std::sqrt(largest2);
}

/// Largest eigenvalue of M^-1 K, or up to twice as much: by the sums of its rows. In 1/s^2.
double highest_eigenvalue(const SpringSystem& system, const std::vector<char>& is_held) {
  std::vector<double> stiffness(system.node_count(), 0);  // of its springs
  for (const Spring& s : system.springs) {
    stiffness[s.a] += s.stiffness_n_m;
    stiffness[s.b] += s.stiffness_n_m;
  }
  double highest = 0;
  for (std::size_t n = 0; n < stiffness.size(); ++n) {
    if (!is_held[n]) highest = std::max(highest, 2 * stiffness[n] / system.mass_kg[n]);
  }
  return highest;
}

}  // namespace

Minimiser::Minimiser(SpringSystem& system, const Progress* progress)
    : m_system(system), m_is_held(system.node_count(), 0) {
  validate(system);
  for (const HeldNode& held : system.held) {
    m_is_held[held.node] = 1;
    system.pos_mm[held.node] = held.target_mm;
  }
  std::fill(system.velocity_mm_s.begin(), system.velocity_mm_s.end(), Vec3d(0.0));
  system.barrier.wake(system.pos_mm);
  m_matrix = std::make_unique<SpringMatrix>(system, m_is_held, progress);
  m_highest = highest_eigenvalue(system, m_is_held);
  m_least = std::max(1e-12 * m_highest, 1e-12);
  m_mass_factor = std::max(1e-4 * m_highest, m_least);
  m_residual_mn = free_forces(system, m_is_held, m_step);
}

Minimiser::~Minimiser() = default;

bool Minimiser::step(const Progress* progress) {
  poll(progress);
  if (!m_matrix->factorise(m_system, m_mass_factor, 0, m_system.pos_mm, {}, progress)) {
    m_mass_factor *= 16;
    return true;
  }
  m_matrix->solve(m_step, kInexact, progress);
  const bool descends = descend();
  m_residual_mn = free_forces(m_system, m_is_held, m_step);
  return descends || m_mass_factor <= 4 * m_highest;
}

/// Goes along the step, halved until the energy does not rise.
bool Minimiser::descend() {
  constexpr int kHalvings = 20;
  m_before = m_system.pos_mm;
  const double old_potential = potential(m_system, m_before);
  double part = 1;
  for (int halving = 0; halving <= kHalvings; ++halving, part /= 2) {
    for (std::size_t n = 0; n < m_step.size(); ++n) {
      m_system.pos_mm[n] = m_before[n] + m_step[n] * part;
    }
    m_system.barrier.wake(m_system.pos_mm);
    if (potential(m_system, m_before) > old_potential) continue;
    m_mass_factor = part == 1 ? std::max(m_mass_factor * 0.1, m_least) : m_mass_factor * 4;
    return true;
  }
  m_system.pos_mm = m_before;
  m_mass_factor *= 4;
  return false;
}

MinimiseReport minimise(SpringSystem& system, const MinimiseParams& params, Progress* progress) {
  Minimiser minimiser(system);
  MinimiseReport report;
  report.before = energy(system);
  bool descends = true;
  while (descends && minimiser.residual_mn() > params.tolerance_mn &&
         report.steps < params.max_steps) {
    if (progress != nullptr && progress->cancelled()) break;
    if (progress != nullptr) progress->update(double(report.steps) / params.max_steps);
    descends = minimiser.step();
    ++report.steps;
  }
  report.residual_mn = minimiser.residual_mn();
  report.converged = report.residual_mn <= params.tolerance_mn;
  report.after = energy(system);
  return report;
}

}  // namespace supple
