#include "lib/fem/newton.h"

#include <algorithm>
#include <cmath>

#include "lib/fem/node_vectors.h"

namespace supple {

namespace {

/// Equilibrium on the way only leads to the next one.
constexpr double kToleranceOnTheWay = 1e-3;
constexpr double kPredictorTolerance = 1e-3;
/// Part of the residual that linear systems leave at most.
constexpr double kLargestForcing = 0.1;
constexpr double kToleranceLeft = 0.1;
constexpr int kMostCorrections = 12;
/// A step was easy after at most this many corrections.
constexpr int kEasyCorrections = 4;
constexpr double kShortestStep = 1e-3;
/// No step may turn an element, as seen from where it starts, by more degrees.
constexpr double kLargestTurnDeg = 30;
/// No step may shrink det F of an element to less than this part of the smallest one.
constexpr double kLeastShrinkage = 0.3;
constexpr int kMostHalvings = 6;
// Limits of the line search: Armijo's condition; the slope that is small enough where the energy
// changes by rounding alone (Hager and Zhang 2005).
constexpr double kArmijo = 1e-4;
constexpr double kSlopeLeft = 0.5;
constexpr double kEnergyRounding = 1e-10;
constexpr int kMostShortenings = 8;

/// y += factor x.
void add_to(std::vector<double>& y, double factor, const std::vector<double>& x) {
  for_ranges(y.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) y[n] += factor * x[n];
  });
}

}  // namespace

double take_swellings(const NonlinearSystem& system, const std::vector<double>& u,
                      const std::vector<double>& r, NodalLoads& loads) {
  loads.force_mn.assign(u.size(), 0);
  const StrainEnergy elastic = system.add_forces(u.data(), loads.force_mn.data(), 0);
  add_to(loads.force_mn, 1, r);
  return elastic.energy_uj;
}

Newton::Newton(const ElasticSolid& solid, const NonlinearSystem& system, NodalLoads& loads,
               const NewtonLimits& limits)
    : m_system(&system),
      m_limits(limits),
      m_path(solid, loads),
      m_whole_mn(loads.force_mn),
      m_swells(!loads.swelling_kpa.empty()),
      m_u(loads.u_mm.size(), 0.0),
      m_r(loads.u_mm.size(), 0.0),
      m_meter(loads) {
  loads.u_mm = std::vector<double>();
  m_system_loads.held = loads.held;
  m_system_loads.force_mn.resize(m_u.size());
}

/// The energy and r = f(part) - K(u); false where an element is inside out.
bool Newton::evaluate() {
  fill(m_r.data(), m_r.size(), 0.0);
  m_energy = m_system->add_forces(m_u.data(), m_r.data(), m_part);
  for_ranges(m_r.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      m_r[n] = (m_whole_mn.empty() ? 0 : m_part * m_whole_mn[n]) - m_r[n];
    }
  });
  return m_energy.smallest_j > 0;
}

/// d from m_system_loads; not `found` where no direction came of it.
std::vector<double> Newton::solve_tangent(const CgLimits& limits, Progress* progress, bool& found) {
  const std::unique_ptr<LinearSystem> tangent = m_system->tangent_at(m_u, m_part);
  ConjugateGradients solver(*tangent, m_system_loads, limits);
  found = solver.run(progress) || solver.iterations() > 0;
  m_report.cg_iterations += solver.iterations();
  m_meter.have_seen(solver.size().seen_mn);
  // Two vectors here, one that keeps the state before the step, and all forces twice.
  m_bytes = (3 + (m_whole_mn.empty() ? 0 : 2)) * m_u.size() * sizeof(double) + m_path.bytes() +
            solver.bytes() + tangent->bytes();
  return solver.take_u();
}

/// Writes f(part) - K(u) of where the body is to m_system_loads.
void Newton::find_load_from_here(double part) {
  if (m_swells) {
    m_part = part;
    evaluate();
  }
  m_system_loads.force_mn = m_r;
  if (!m_swells && !m_whole_mn.empty()) {
    add_to(m_system_loads.force_mn, part - m_part, m_whole_mn);
  }
}

/// Goes from equilibrium at m_part towards that at `part`, which becomes less where the whole way
/// would turn or shrink an element too much.
bool Newton::predict(double& part, Progress* progress) {
  const double from = m_part, way = part - m_part, smallest = m_energy.smallest_j;
  find_load_from_here(part);
  m_system_loads.u_mm = m_u;
  m_path.prescribe(part, m_system_loads.u_mm);
  add_to(m_system_loads.u_mm, -1, m_u);
  bool found;
  const std::vector<double> d =
      solve_tangent({kPredictorTolerance, std::numeric_limits<double>::infinity(),
                     m_limits.max_cg_iterations, 0, true},
                    progress, found);
  const double turn_deg = m_system->largest_turn_deg(d);
  double taken = 0;
  for (int halvings = 0; halvings <= kMostHalvings; ++halvings) {
    const double fraction = std::ldexp(1, -halvings);
    if (fraction * turn_deg > kLargestTurnDeg && halvings < kMostHalvings) continue;
    add_to(m_u, fraction - taken, d);
    taken = fraction;
    if (halvings > 0) part = from + fraction * way;
    m_part = part;
    m_path.prescribe(part, m_u);
    if (evaluate() && m_energy.smallest_j >= kLeastShrinkage * smallest) return true;
  }
  return false;
}

/// Along d, as far as the energy falls; false, with u as it was, where it does not.
bool Newton::search_along(const std::vector<double>& d) {
  const double slope_before = -dot(m_r.data(), d.data(), d.size());
  if (!(slope_before < 0)) return false;
  const double energy_before = m_energy.energy_uj;
  const double work = m_whole_mn.empty() ? 0 : m_part * dot(m_whole_mn.data(), d.data(), d.size());
  double taken = 0, next = 1;
  for (int shortenings = 0; shortenings <= kMostShortenings; ++shortenings) {
    add_to(m_u, next - taken, d);
    taken = next;
    if (!evaluate()) {
      next = taken / 2;
      continue;
    }
    const double slope = -dot(m_r.data(), d.data(), d.size());
    const double change = m_energy.energy_uj - energy_before - taken * work;
    if (change <= kArmijo * taken * slope_before ||
        (std::abs(slope) <= kSlopeLeft * -slope_before &&
         change <= kEnergyRounding * std::abs(energy_before))) {
      if (shortenings > 0) ++m_report.shortened_steps;
      return true;
    }
    const double secant = taken * slope_before / (slope_before - slope);
    next = std::clamp(secant, 0.1 * taken, 0.5 * taken);
  }
  add_to(m_u, -taken, d);
  evaluate();
  return false;
}

/// The parts of the load that are done, and of the one that is being corrected the decades of its
/// residual.
void Newton::tell(double tolerance, Progress* progress) {
  const double reached = part_of_way(m_size, tolerance, 1);
  const double part = m_report.load_part + reached * (m_part - m_report.load_part);
  m_told_part = std::max(m_told_part, part);
  supple::report(progress, m_told_part);
}

bool Newton::correct(bool is_last, Progress* progress) {
  m_report.residuals_mn.clear();
  for (int corrections = 0;; ++corrections) {
    m_size = m_meter(m_r);
    m_report.residuals_mn.push_back(m_size.largest_mn);
    const bool is_done = is_last ? m_size.is_within(m_limits.tolerance, m_limits.reaction_tolerance)
                                 : m_size.max <= kToleranceOnTheWay;
    if (is_done || m_size.largest_mn == 0) return true;
    if (corrections == kMostCorrections) return false;
    tell(is_last ? m_limits.tolerance : kToleranceOnTheWay, progress);
    // Quadratic convergence needs systems that are solved as well as the residual is small, and
    // none better than the tolerance needs.
    const double forcing = std::min(
        kLargestForcing, std::max(m_size.max, kToleranceLeft * m_limits.tolerance / m_size.max));
    m_system_loads.u_mm.assign(m_u.size(), 0.0);
    m_system_loads.force_mn = m_r;
    bool found;
    const std::vector<double> d = solve_tangent(
        {0, 0, m_limits.max_cg_iterations, forcing * m_size.largest_mn, true}, progress, found);
    if (!found || !search_along(d)) return false;
    ++m_report.newton_iterations;
  }
}

bool Newton::run(Progress* progress) {
  evaluate();
  double step = 1;
  while (m_part < 1) {
    poll(progress);
    const double before = m_part;
    double part = std::min(1.0, m_part + step);
    const std::vector<double> u_before = m_u;
    const int corrections = m_report.newton_iterations;
    if (predict(part, progress) && correct(part == 1, progress)) {
      ++m_report.load_steps;
      const bool was_easy = m_report.newton_iterations - corrections <= kEasyCorrections;
      step = (was_easy ? 2 : 1) * (part - before);
    } else {
      ++m_report.rejected_steps;
      m_u = u_before;
      m_part = before;
      evaluate();
      step = (part - before) / 2;
    }
    m_report.load_part = m_part;
    m_report.smallest_j = m_energy.smallest_j;
    m_report.energy_uj = m_energy.energy_uj;
    const bool is_stuck = step < kShortestStep ||
                          m_report.load_steps + m_report.rejected_steps >= m_limits.max_load_steps;
    if (m_part < 1 && is_stuck) return false;
  }
  return true;
}

}  // namespace supple
