#include "lib/model/spring_motion.h"

#include <algorithm>
#include <cmath>

#include "volumes/base/error.h"

namespace supple {

namespace {

constexpr double kNewtonPerMillinewton = 1e-3;

}  // namespace

void MotionParams::validate() const {
  const auto check = [](const char* field, double value, const char* unit) {
    if (value > 0 && std::isfinite(value)) return;
    throw InputError({"", field, number_text(value) + " " + unit, "a positive number"});
  };
  check("time step", step_s, "s");
  check("tolerance", tolerance_mn, "mN");
  for (int c = 0; c < 3; ++c) {
    if (std::isfinite(gravity_m_s2[c])) continue;
    throw InputError({"", "gravity", number_text(gravity_m_s2[c]), "three finite numbers"});
  }
}

SpringMotion::SpringMotion(SpringSystem& system, const MotionParams& params)
    : m_system(system), m_params(params) {
  params.validate();
  m_system.gravity_m_s2 = params.gravity_m_s2;
}

void SpringMotion::move(const std::vector<int>& still, std::vector<DrivenNodes> handles,
                        int steps) {
  std::vector<int> held = still;
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
  // They know from their start which nodes are held.
  m_integrator.reset();
  m_minimiser.reset();
}

/// The handles' targets of the next step.
void SpringMotion::drive() {
  m_step = std::min(m_step + 1, m_steps);
  const double part = m_params.goal == MotionParams::Goal::minimum ? 1 : double(m_step) / m_steps;
  for (std::size_t h = 0; h < m_handles.size(); ++h) {
    for (std::size_t n = 0; n < m_handles[h].nodes.size(); ++n) {
      supple::drive(m_system, m_handles[h].nodes[n], m_starts[h][n] + m_handles[h].by_mm * part);
    }
  }
}

bool SpringMotion::step() {
  drive();
  if (m_params.goal == MotionParams::Goal::motion) {
    if (!m_integrator) m_integrator = make_integrator(m_params.method, m_system);
    m_report += m_integrator->step(m_params.step_s);
    return true;
  }
  if (!m_minimiser) m_minimiser = std::make_unique<Minimiser>(m_system);
  if (m_minimiser->residual_mn() <= m_params.tolerance_mn) return false;
  const bool descends = m_minimiser->step();
  return descends && m_minimiser->residual_mn() > m_params.tolerance_mn;
}

ModelEnergy SpringMotion::energy() const {
  const SpringEnergy found = supple::energy(m_system);
  return {found.spring_j, found.kinetic_j, found.gravity_j};
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
      on_node[std::size_t(held.node)] = force_mn[std::size_t(held.node)] * kNewtonPerMillinewton;
    }
  }
  std::vector<Reaction> sums(sets.size());
  for (std::size_t s = 0; s < sets.size(); ++s) {
    for (const int node : sets[s]) sums[s].force_n += on_node[std::size_t(node)];
  }
  return sums;
}

}  // namespace supple
