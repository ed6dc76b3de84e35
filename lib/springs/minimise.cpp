#include "lib/springs/minimise.h"

#include <algorithm>
#include <cmath>

#include "lib/springs/spring_matrix.h"
#include "lib/springs/stability.h"
#include "volumes/base/error.h"

namespace supple {

namespace {

constexpr double kMmPerM = 1e3;

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
  return sum;
}

/// The forces, 0 at held nodes; returns the largest.
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

}  // namespace

MinimiseReport minimise(SpringSystem& system, const MinimiseParams& params, Progress* progress) {
  constexpr int kHalvings = 20;
  validate(system);
  std::vector<char> is_held(system.node_count(), 0);
  for (const HeldNode& held : system.held) {
    is_held[held.node] = 1;
    system.pos_mm[held.node] = held.target_mm;
  }
  std::fill(system.velocity_mm_s.begin(), system.velocity_mm_s.end(), Vec3d(0.0));
  MinimiseReport report;
  report.before = energy(system);
  SpringMatrix matrix(system, is_held);
  const double omega2 = spectral_bounds(system).stiffness_1_s2;
  const double floor = std::max(1e-12 * omega2, 1e-12);
  double mass_factor = std::max(1e-4 * omega2, floor);
  std::vector<Vec3d> step, before;
  report.residual_mn = free_forces(system, is_held, step);
  while (report.residual_mn > params.tolerance_mn && report.steps < params.max_steps) {
    if (progress != nullptr && progress->cancelled()) break;
    if (progress != nullptr) progress->update(double(report.steps) / params.max_steps);
    ++report.steps;
    if (!matrix.factorise(system, mass_factor, 0, system.pos_mm)) {
      mass_factor *= 16;
      continue;
    }
    matrix.solve(step);
    before = system.pos_mm;
    const double old_potential = potential(system, before);
    double part = 1;
    bool descends = false;
    for (int halving = 0; halving <= kHalvings && !descends; ++halving) {
      for (std::size_t n = 0; n < step.size(); ++n) system.pos_mm[n] = before[n] + step[n] * part;
      descends = potential(system, before) <= old_potential;
      if (!descends) part /= 2;
    }
    if (!descends) system.pos_mm = before;
    report.residual_mn = free_forces(system, is_held, step);
    if (!descends && mass_factor > omega2) break;
    mass_factor = part == 1 ? std::max(mass_factor * 0.1, floor) : mass_factor * 4;
  }
  report.converged = report.residual_mn <= params.tolerance_mn;
  report.after = energy(system);
  return report;
}

}  // namespace supple
