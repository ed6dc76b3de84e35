#include "lib/springs/stability.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace supple {

namespace {

/// One edge of the signless Laplacian between free nodes, or from one to a held node.
struct Coupling {
  int a, b;  // b = -1: held
  double value;
};

/// Upper bound of the largest eigenvalue of M^-1 (signless Laplacian of the couplings).
double largest_eigenvalue_bound(const std::vector<Coupling>& couplings,
                                const std::vector<double>& mass, const Progress* progress) {
  constexpr int kMaxIterations = 1000;
  constexpr double kTolerance = 1e-3;
  std::vector<double> diagonal(mass.size(), 0), x(mass.size(), 1), ax(mass.size());
  for (const Coupling& c : couplings) {
    diagonal[c.a] += c.value;
    if (c.b >= 0) diagonal[c.b] += c.value;
  }
  double bound = HUGE_VAL;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    poll(progress);
    for (std::size_t n = 0; n < mass.size(); ++n) ax[n] = diagonal[n] * x[n];
    for (const Coupling& c : couplings) {
      if (c.b < 0) continue;
      ax[c.a] += c.value * x[c.b];
      ax[c.b] += c.value * x[c.a];
    }
    double largest = 0, lowest_of_coupled = HUGE_VAL, norm = 0;
    for (std::size_t n = 0; n < mass.size(); ++n) {
      ax[n] /= mass[n];
      const double ratio = ax[n] / x[n];
      largest = std::max(largest, ratio);
      if (diagonal[n] > 0) lowest_of_coupled = std::min(lowest_of_coupled, ratio);
      norm = std::max(norm, ax[n]);
    }
    bound = std::min(bound, largest);
    if (norm == 0) return 0;
    if (largest - lowest_of_coupled <= kTolerance * largest) break;
    // Entries that vanish beside others, as on parts that are not joined, stay positive.
    for (std::size_t n = 0; n < mass.size(); ++n) x[n] = std::max(ax[n] / norm, 1e-30);
  }
  return bound;
}

}  // namespace

SpectralBounds spectral_bounds(const SpringSystem& system, const Progress* progress) {
  std::vector<char> is_held(system.node_count(), 0);
  for (const HeldNode& held : system.held) is_held[held.node] = 1;
  std::vector<Coupling> stiffness, damping;
  for (const Spring& s : system.springs) {
    if (is_held[s.a] && is_held[s.b]) continue;
    const int a = is_held[s.a] ? s.b : s.a;
    const int b = is_held[s.a] || is_held[s.b] ? -1 : s.b;
    if (s.stiffness_n_m > 0) stiffness.push_back({a, b, s.stiffness_n_m});
    if (s.damping_n_s_m > 0) damping.push_back({a, b, s.damping_n_s_m});
  }
  return {largest_eigenvalue_bound(stiffness, system.mass_kg, progress),
          largest_eigenvalue_bound(damping, system.mass_kg, progress) + system.mass_damping_per_s};
}

double stable_step_s(const SpectralBounds& bounds) {
  const double omega2 = bounds.stiffness_1_s2, gamma = bounds.damping_1_s;
  if (omega2 == 0) return gamma > 0 ? 2 / gamma : HUGE_VAL;
  return (std::sqrt(gamma * gamma + 4 * omega2) - gamma) / omega2;
}

}  // namespace supple
