#include "lib/springs/spring_system.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "volumes/base/error.h"
#include "volumes/base/units.h"

namespace supple {

namespace {

[[noreturn]] void fail(const std::string& field, const std::string& found,
                       const std::string& expected) {
  throw InputError({"", field, found, expected});
}

void check_spring(const SpringSystem& system, std::size_t n) {
  const Spring& s = system.springs[n];
  // Names are made where one is wrong: a head has 20 million springs.
  const auto name = [n] { return "spring " + std::to_string(n); };
  for (const int node : {s.a, s.b}) {
    if (node < 0 || std::size_t(node) >= system.node_count()) {
      fail(name(), "node " + std::to_string(node),
           "an index below " + std::to_string(system.node_count()));
    }
  }
  if (s.a == s.b) fail(name(), "node " + std::to_string(s.a) + " twice", "different nodes");
  for (const double value : {s.rest_mm, s.stiffness_n_m, s.damping_n_s_m}) {
    if (!(value >= 0) || !std::isfinite(value)) {
      fail(name(), number_text(value), "rest length, stiffness and damping of at least 0");
    }
  }
}

std::vector<HeldNode>::iterator held_at(SpringSystem& system, int node) {
  return std::lower_bound(system.held.begin(), system.held.end(), node,
                          [](const HeldNode& h, int wanted) { return h.node < wanted; });
}

}  // namespace

std::size_t SpringSystem::bytes() const {
  return mass_kg.capacity() * sizeof(double) +
         (pos_mm.capacity() + velocity_mm_s.capacity()) * sizeof(Vec3d) +
         springs.capacity() * sizeof(Spring) + held.capacity() * sizeof(HeldNode) + barrier.bytes();
}

void validate(const SpringSystem& system) {
  const std::size_t nodes = system.node_count();
  if (system.pos_mm.size() != nodes || system.velocity_mm_s.size() != nodes) {
    fail("spring system",
         std::to_string(system.pos_mm.size()) + " positions and " +
             std::to_string(system.velocity_mm_s.size()) + " velocities",
         std::to_string(nodes) + " of each, one per mass");
  }
  for (std::size_t n = 0; n < nodes; ++n) {
    const auto name = [n] { return "node " + std::to_string(n); };
    if (!(system.mass_kg[n] > 0) || !std::isfinite(system.mass_kg[n])) {
      fail(name(), "a mass of " + number_text(system.mass_kg[n]) + " kg", "a mass above 0");
    }
    if (!is_finite(system.pos_mm[n]) || !is_finite(system.velocity_mm_s[n])) {
      fail(name(), "a position or velocity that is not finite", "finite numbers");
    }
  }
  for (std::size_t n = 0; n < system.springs.size(); ++n) check_spring(system, n);
  for (std::size_t n = 0; n < system.held.size(); ++n) {
    const int node = system.held[n].node;
    if (node < 0 || std::size_t(node) >= nodes || (n > 0 && node <= system.held[n - 1].node)) {
      fail("held node " + std::to_string(node), "entry " + std::to_string(n),
           "ascending indices below " + std::to_string(nodes));
    }
    if (!is_finite(system.held[n].target_mm)) {
      fail("held node " + std::to_string(node), "a target that is not finite", "a position in mm");
    }
  }
  if (!is_finite(system.gravity_m_s2) || !(system.mass_damping_per_s >= 0) ||
      !std::isfinite(system.mass_damping_per_s)) {
    fail("spring system", "gravity or mass damping that is not usable",
         "finite gravity and a mass damping of at least 0");
  }
  for (const Collider& collider : system.colliders) validate(collider);
}

void hold(SpringSystem& system, int node) {
  if (node < 0 || std::size_t(node) >= system.node_count()) {
    fail("held node", std::to_string(node),
         "an index below " + std::to_string(system.node_count()));
  }
  const auto at = held_at(system, node);
  if (at != system.held.end() && at->node == node) {
    at->target_mm = system.pos_mm[node];
  } else {
    system.held.insert(at, {node, system.pos_mm[node]});
  }
}

void release(SpringSystem& system, int node) {
  const auto at = held_at(system, node);
  if (at != system.held.end() && at->node == node) system.held.erase(at);
}

void drive(SpringSystem& system, int node, const Vec3d& target_mm) {
  const auto at = held_at(system, node);
  if (at == system.held.end() || at->node != node) {
    fail("driven node", std::to_string(node), "a node that is held");
  }
  if (!is_finite(target_mm)) fail("driven node", "a target that is not finite", "a position in mm");
  at->target_mm = target_mm;
}

SpringEnergy energy(const SpringSystem& system) {
  double kinetic = 0, spring = 0, gravity = 0;
  for (std::size_t n = 0; n < system.node_count(); ++n) {
    kinetic += 0.5 * system.mass_kg[n] * system.velocity_mm_s[n].length2();
    gravity -= system.mass_kg[n] * system.gravity_m_s2.dot(system.pos_mm[n]) * kMmPerM;
  }
  for (const Spring& s : system.springs) {
    const double stretch = (system.pos_mm[s.b] - system.pos_mm[s.a]).length() - s.rest_mm;
    spring += 0.5 * s.stiffness_n_m * stretch * stretch;
  }
  spring += system.barrier.energy_uj(system.pos_mm);
  return {kinetic * kJPerUj, spring * kJPerUj, gravity * kJPerUj};
}

int forces_mn(const SpringSystem& system, std::vector<Vec3d>& force, Damping damping,
              const Progress* progress) {
  const bool with_damping = damping == Damping::with;
  const Vec3d gravity = system.gravity_m_s2 * kMmPerM;
  const double alpha = with_damping ? system.mass_damping_per_s : 0;
  force.resize(system.node_count());
  for (std::size_t n = 0; n < system.node_count(); ++n) {
    force[n] = (gravity - system.velocity_mm_s[n] * alpha) * system.mass_kg[n];
  }
  int without_direction = 0;
  for (std::size_t n = 0; n < system.springs.size(); ++n) {
    if (n % kSpringsPerPoll == 0) poll(progress);
    const Spring& s = system.springs[n];
    const Vec3d x = system.pos_mm[s.b] - system.pos_mm[s.a];
    const double length = std::sqrt(x.length2());
    if (length == 0) {
      ++without_direction;
      continue;
    }
    const Vec3d along = x / length;
    double pull = s.stiffness_n_m * (length - s.rest_mm);  // eq. 3.16
    if (with_damping) {
      const Vec3d apart = system.velocity_mm_s[s.b] - system.velocity_mm_s[s.a];
      pull += s.damping_n_s_m * along.dot(apart);
    }
    force[s.a] += along * pull;
    force[s.b] -= along * pull;
  }
  system.barrier.add_forces(system.pos_mm, force);
  return without_direction;
}

}  // namespace supple
