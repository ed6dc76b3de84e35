#include "lib/springs/implicit_euler.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "volumes/base/error.h"
#include "volumes/base/units.h"

namespace supple {

namespace {

// Part of the forces of each Newton step that conjugate gradients leave.
constexpr double kLinearTolerance = 1e-4;

double largest_of(const std::vector<Vec3d>& vectors) {
  double largest2 = 0;
  for (const Vec3d& v : vectors) largest2 = std::max(largest2, v.length2());
  return std::sqrt(largest2);
}

/// Direction of a spring at the start, and how far its ends moved along it; 0 without one.
struct DampedSpring {
  Vec3d along{0, 0, 0};
  double apart_mm = 0;  // how far the ends moved from each other along it
};
DampedSpring damped(const Spring& s, const std::vector<Vec3d>& start,
                    const std::vector<Vec3d>& pos) {
  const Vec3d x = start[s.b] - start[s.a];
  const double length = std::sqrt(x.length2());
  if (length == 0) return {};
  const Vec3d along = x / length;
  return {along, along.dot((pos[s.b] - start[s.b]) - (pos[s.a] - start[s.a]))};
}

}  // namespace

ImplicitEuler::ImplicitEuler(SpringSystem& system, const Params& params, const Progress* progress)
    : SpringIntegrator(system), m_params(params), m_matrix(system, m_is_held, progress) {
  if (params.newton_steps < 1 || params.newton_steps_bounded < 1 || !(params.tolerance_mn >= 0) ||
      !(params.relative_tolerance >= 0)) {
    throw InputError({"", "implicit Euler",
                      std::to_string(params.newton_steps) + " Newton steps, tolerances " +
                          number_text(params.tolerance_mn) + " mN and " +
                          number_text(params.relative_tolerance),
                      "at least one step, tolerances of at least 0"});
  }
}

/// Puts pressed nodes that moved along a curved surface back onto it.
void ImplicitEuler::stay_on_shapes() {
  constexpr double kSmooth = 0.9;
  for (const PressedNode& p : m_pressed) {
    Vec3d& pos = m_system.pos_mm[p.node];
    const double moved = (pos - m_before[p.node]).length();
    Vec3d normal(0.0);
    const double depth = depth_in(m_system.colliders[p.collider], pos, moved, normal);
    const bool is_smooth = normal.dot(p.normal) > kSmooth;  // no edge that it went over
    if (depth < 0 && depth >= -moved && is_smooth) pos += normal * depth;
  }
}

/// Takes back slip as far as friction reaches, whose forces bend the springs around the node, too.
void ImplicitEuler::rub(double dt_s) {
  std::vector<SlidingNode> sliding;
  for (const PressedNode& p : m_pressed) {
    const Collider& collider = m_system.colliders[p.collider];
    if (collider.friction == 0) continue;
    const Vec3d moved = m_system.pos_mm[p.node] - m_start[p.node] - collider.velocity_mm_s * dt_s;
    const Vec3d slip = moved - p.normal * p.normal.dot(moved);
    sliding.push_back({p.node, p.normal, slip, collider.friction * p.force_mn});
  }
  if (sliding.empty()) return;
  m_matrix.assemble(m_system, mass_factor(dt_s), 1 / dt_s, m_start, progress());
  m_matrix.take_back(sliding);
  for (const SlidingNode& node : sliding) m_system.pos_mm[node.node] += node.back_mm;
}

double ImplicitEuler::mass_factor(double dt_s) const {
  return 1 / (dt_s * dt_s) + m_system.mass_damping_per_s / dt_s;
}

double ImplicitEuler::descent(double dt_s, SpringStepReport& report) {
  report.without_direction = forces_mn(m_system, m_force, Damping::without, progress());
  const double alpha = m_system.mass_damping_per_s;
  for (std::size_t n = 0; n < m_system.springs.size(); ++n) {
    if (n % kSpringsPerPoll == 0) poll(progress());
    const Spring& s = m_system.springs[n];
    if (s.damping_n_s_m == 0) continue;
    const DampedSpring spring = damped(s, m_start, m_system.pos_mm);
    const Vec3d pull = spring.along * (s.damping_n_s_m * spring.apart_mm / dt_s);
    m_force[s.a] += pull;
    m_force[s.b] -= pull;
  }
  m_step = m_force;
  for (std::size_t n = 0; n < m_system.node_count(); ++n) {
    const Vec3d moved = m_system.pos_mm[n] - m_start[n];
    const Vec3d slow = moved * (alpha * m_system.mass_kg[n] / dt_s);
    m_force[n] -= slow;
    const Vec3d inertia = (moved / dt_s - m_start_velocity[n]) * (m_system.mass_kg[n] / dt_s);
    m_step[n] = m_is_held[n] ? Vec3d(0.0) : m_force[n] - inertia;
  }
  const double largest = largest_of(m_step);
  m_pressed = take_pressure(m_system.colliders, m_is_held, m_system.pos_mm, m_step);
  return largest;
}

double ImplicitEuler::potential(double dt_s) const {
  double sum = 0;
  const double alpha = m_system.mass_damping_per_s;
  for (std::size_t n = 0; n < m_system.node_count(); ++n) {
    if (m_is_held[n]) continue;
    const Vec3d moved = m_system.pos_mm[n] - m_start[n];
    const Vec3d off = moved - m_start_velocity[n] * dt_s;
    // Gravity against the start keeps the sum small beside its differences.
    sum += m_system.mass_kg[n] *
           (off.length2() / (2 * dt_s * dt_s) + alpha * moved.length2() / (2 * dt_s) -
            m_system.gravity_m_s2.dot(moved) * kMmPerM);
  }
  for (std::size_t n = 0; n < m_system.springs.size(); ++n) {
    if (n % kSpringsPerPoll == 0) poll(progress());
    const Spring& s = m_system.springs[n];
    const double stretch =
        std::sqrt((m_system.pos_mm[s.b] - m_system.pos_mm[s.a]).length2()) - s.rest_mm;
    sum += 0.5 * s.stiffness_n_m * stretch * stretch;
    if (s.damping_n_s_m == 0) continue;
    const double apart = damped(s, m_start, m_system.pos_mm).apart_mm;
    sum += 0.5 * s.damping_n_s_m / dt_s * apart * apart;
  }
  return sum + m_system.barrier.energy_uj(m_system.pos_mm);
}

SpringStepReport ImplicitEuler::advance(double dt_s) {
  constexpr int kHalvings = 20;
  SpringStepReport report;
  report.substeps = 1;
  m_start = m_system.pos_mm;
  m_start_velocity = m_system.velocity_mm_s;
  place_held(1);
  m_system.barrier.wake(m_system.pos_mm);
  const auto most_steps = [&] {
    const bool is_bounded = !m_system.colliders.empty() || !m_system.barrier.awake().empty();
    return is_bounded ? m_params.newton_steps_bounded : m_params.newton_steps;
  };
  const double largest = descent(dt_s, report);
  const double tolerance = std::max(m_params.tolerance_mn, m_params.relative_tolerance * largest);
  double residual = largest_of(m_step);
  double phi = potential(dt_s);
  while (report.iterations < most_steps() && residual > tolerance) {
    poll(progress());
    if (!m_matrix.factorise(m_system, mass_factor(dt_s), 1 / dt_s, m_start, m_pressed,
                            progress())) {
      throw InputError({"", "implicit Euler", "a matrix that is not positive definite",
                        "masses and stiffnesses whose ratio a double can hold"});
    }
    m_matrix.solve(m_step, kLinearTolerance, progress());
    m_before = m_system.pos_mm;
    double part = 1, lower = phi;
    for (int halving = 0; halving <= kHalvings; ++halving, part /= 2) {
      for (std::size_t n = 0; n < m_step.size(); ++n) {
        m_system.pos_mm[n] = m_before[n] + m_step[n] * part;
      }
      stay_on_shapes();
      leave_shapes(m_system.colliders, m_is_held, m_system.pos_mm);
      m_system.barrier.wake(m_system.pos_mm);
      lower = potential(dt_s);
      if (lower <= phi) break;
    }
    ++report.iterations;
    if (!(lower <= phi)) {  // rounding is all that is left
      m_system.pos_mm = m_before;
      break;
    }
    phi = lower;
    descent(dt_s, report);
    residual = largest_of(m_step);
  }
  report.residual_mn = residual;
  rub(dt_s);
  for (std::size_t n = 0; n < m_step.size(); ++n) {
    if (!m_is_held[n]) {
      m_system.velocity_mm_s[n] = (m_system.pos_mm[n] - m_start[n]) / dt_s;
    }
  }
  add_reactions(m_force, 1);
  SpringStepReport touched;
  end_contacts(m_start, dt_s, touched);
  report.contacts += std::max(touched.contacts, int(m_pressed.size()));
  report.penetration_mm = touched.penetration_mm;
  return report;
}

}  // namespace supple
