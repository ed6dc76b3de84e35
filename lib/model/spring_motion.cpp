#include "lib/model/spring_motion.h"

#include <algorithm>
#include <cmath>

#include "volumes/base/error.h"
#include "volumes/base/units.h"

namespace supple {

namespace {

/// Nodes as near to a shape as this touch it.
constexpr double kTouchMm = 1e-6;

void check_finite(const char* field, const Vec3d& vector) {
  for (int c = 0; c < 3; ++c) {
    if (std::isfinite(vector[c])) continue;
    throw InputError({"", field, number_text(vector[c]), "three finite numbers"});
  }
}

}  // namespace

void MotionParams::validate() const {
  const auto check = [](const char* field, double value, const char* unit) {
    if (value > 0 && std::isfinite(value)) return;
    throw InputError({"", field, number_text(value) + " " + unit, "a positive number"});
  };
  check("time step", step_s, "s");
  check("tolerance", tolerance_mn, "mN");
  check_finite("gravity", gravity_m_s2);
  if (!colliders.empty() && minimise) {
    throw InputError({"", "colliders", "shapes beside a minimum", "shapes in a motion only"});
  }
  for (const DrivenCollider& driven : colliders) {
    supple::validate(driven.collider);
    check_finite("way of a collider", driven.by_mm);
  }
}

SpringMotion::SpringMotion(SpringSystem& system, const MotionParams& params)
    : m_system(system), m_params(params) {
  params.validate();
  m_system.gravity_m_s2 = params.gravity_m_s2;
  m_system.colliders.clear();
  for (const DrivenCollider& driven : params.colliders) {
    m_system.colliders.push_back(driven.collider);
    m_shape_starts.push_back(driven.collider.shape);
  }
}

void SpringMotion::move(const std::vector<int>& anchored, std::vector<DrivenNodes> handles,
                        int steps) {
  std::vector<int> held = anchored;
  for (const DrivenNodes& handle : handles) {
    held.insert(held.end(), handle.nodes.begin(), handle.nodes.end());
  }
  std::sort(held.begin(), held.end());
  held.erase(std::unique(held.begin(), held.end()), held.end());
  m_system.held.clear();
  for (const int node : held) m_system.held.push_back({node, m_system.pos_mm[std::size_t(node)]});
  m_handles = std::move(handles);
  m_starts.clear();
  for (const DrivenNodes& handle : m_handles) {
    m_starts.emplace_back();
    for (const int node : handle.nodes) {
      m_starts.back().push_back(m_system.pos_mm[std::size_t(node)]);
    }
  }
  m_step = 0;
  m_steps = std::max(steps, 1);
  for (std::size_t n = 0; n < m_shape_starts.size(); ++n) {
    m_shape_starts[n] = m_system.colliders[n].shape;
  }
  // Integrators and minimisers know from their start which nodes are held.
  m_integrator.reset();
  m_minimiser.reset();
}

/// Sets targets of handles and places of shapes as they are at the end of the next step.
void SpringMotion::drive() {
  const int before = m_step;
  m_step = std::min(m_step + 1, m_steps);
  const double part = m_params.minimise ? 1 : double(m_step) / m_steps;
  for (std::size_t h = 0; h < m_handles.size(); ++h) {
    for (std::size_t n = 0; n < m_handles[h].nodes.size(); ++n) {
      supple::drive(m_system, m_handles[h].nodes[n], m_starts[h][n] + m_handles[h].by_mm[n] * part);
    }
  }
  for (std::size_t n = 0; n < m_system.colliders.size(); ++n) {
    const Vec3d& by_mm = m_params.colliders[n].by_mm;
    m_system.colliders[n].shape = shifted(m_shape_starts[n], by_mm * part);
    m_system.colliders[n].velocity_mm_s = by_mm * ((m_step - before) / (m_steps * m_params.step_s));
  }
}

bool SpringMotion::step(const Progress* progress) {
  const int before = m_step;
  try {
    drive();
    return m_params.minimise ? step_down(progress) : step_on(progress);
  } catch (...) {
    m_step = before;
    throw;
  }
}

bool SpringMotion::step_on(const Progress* progress) {
  if (!m_integrator) m_integrator = make_integrator(m_params.method, m_system, progress);
  if (!m_system.colliders.empty()) m_velocity_before = m_system.velocity_mm_s;
  m_report += m_integrator->step(m_params.step_s, progress);
  return true;
}

bool SpringMotion::step_down(const Progress* progress) {
  if (!m_minimiser) m_minimiser = std::make_unique<Minimiser>(m_system, progress);
  if (m_minimiser->residual_mn() <= m_params.tolerance_mn) return false;
  const bool descends = m_minimiser->step(progress);
  return descends && m_minimiser->residual_mn() > m_params.tolerance_mn;
}

ModelEnergy SpringMotion::energy() const {
  const SpringEnergy found = supple::energy(m_system);
  return {found.spring_j, found.kinetic_j, found.gravity_j};
}

std::vector<Vec3d> SpringMotion::collider_forces_n() const {
  std::vector<Vec3d> forces_n(m_system.colliders.size(), Vec3d(0));
  if (m_velocity_before.empty()) return forces_n;
  std::vector<char> is_held(m_system.node_count(), 0);
  for (const HeldNode& held : m_system.held) is_held[std::size_t(held.node)] = 1;
  std::vector<Vec3d> force_mn;
  forces_mn(m_system, force_mn, Damping::with);
  for (std::size_t n = 0; n < force_mn.size(); ++n) {
    if (is_held[n]) continue;
    double deepest = -kTouchMm;
    std::size_t touched = forces_n.size();
    for (std::size_t c = 0; c < forces_n.size(); ++c) {
      Vec3d normal(0);
      const double depth = depth_in(m_system.colliders[c], m_system.pos_mm[n], kTouchMm, normal);
      if (depth < deepest) continue;
      deepest = depth;
      touched = c;
    }
    if (touched == forces_n.size()) continue;
    const Vec3d gained = m_system.velocity_mm_s[n] - m_velocity_before[n];
    const Vec3d inertia_mn = gained * (m_system.mass_kg[n] / m_params.step_s);
    forces_n[touched] += (force_mn[n] - inertia_mn) * kNPerMn;
  }
  return forces_n;
}

std::vector<Reaction> SpringMotion::reactions(const std::vector<std::vector<int>>& sets) const {
  std::vector<Vec3d> on_node(m_system.node_count(), Vec3d(0.0));
  if (m_integrator) {
    for (std::size_t n = 0; n < m_system.held.size(); ++n) {
      on_node[std::size_t(m_system.held[n].node)] = m_integrator->reactions_n()[n];
    }
  } else {
    std::vector<Vec3d> force_mn;
    forces_mn(m_system, force_mn, Damping::without);
    for (const HeldNode& held : m_system.held) {
      on_node[std::size_t(held.node)] = force_mn[std::size_t(held.node)] * kNPerMn;
    }
  }
  std::vector<Reaction> sums(sets.size());
  for (std::size_t s = 0; s < sets.size(); ++s) {
    for (const int node : sets[s]) sums[s].force_n += on_node[std::size_t(node)];
  }
  return sums;
}

}  // namespace supple
