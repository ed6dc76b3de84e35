#include "tests/lib/quadratic_program.h"

#include <algorithm>
#include <cmath>

#include "lib/body/diagonals.h"
#include "tests/lib/relaxed_bodies.h"

namespace supple::test {

QuadraticProgram::QuadraticProgram(const Body& body, std::size_t c, const SlotSet& held) {
  const MaterialClasses classes(body.material);
  const Vec3d h = body.geometry.spacing_mm();
  for_each_element(body.elements, [&](Slot slot) {
    m_x.resize(std::max<std::size_t>(m_x.size(), slot + 1));
    m_x[slot] = body.q[c].at(slot) / kFixedOne;
  });
  m_at.resize(m_x.size());
  const int links = body.slacks.links();
  for_each_element(body.elements, [&](Slot low) {
    for_each_linked(body.elements, body.cuts, links, low, [&](int direction, Slot high) {
      if (direction < kNoStep) return;
      const std::uint8_t first = body.classes[low], second = body.classes[high];
      const double k =
          classes.physics(first, second).stiffness_kpa * spring_share(h, links, direction);
      const auto fall = [&](int way) {
        return body.slacks.fall(way, int(c), first, second) / kFixedOne;
      };
      m_at[low].push_back(m_links.size());
      m_at[high].push_back(m_links.size());
      m_links.push_back({low, high, k, fall(opposite_direction(direction)), fall(direction), 0});
    });
  });
  for (Slot slot = 0; slot < m_x.size(); ++slot) {
    if (!m_at[slot].empty() && !held.contains(slot)) m_free.push_back(slot);
  }
}

double QuadraticProgram::minimise(int rounds, double& excess) {
  double moved = 1;
  for (int round = 0; round < rounds && moved > kStillVoxels; ++round) {
    moved = 0;
    for (int sweep = 0; sweep < 20; ++sweep) {
      for (const Slot slot : m_free) moved = std::max(moved, std::abs(step(slot)));
    }
    for (Link& link : m_links) {
      const double before = link.multiplier;
      link.multiplier = kPenalty * link.k * beyond(link);
      moved = std::max(moved, std::abs(link.multiplier - before) / (kPenalty * link.k));
    }
  }
  double energy = 0;
  excess = 0;
  for (const Link& link : m_links) {
    const double d = m_x[link.high] - m_x[link.low];
    energy += link.k * d * d / 2;
    excess = std::max({excess, d - link.upper, -link.lower - d});
  }
  return energy;
}

double QuadraticProgram::beyond(const Link& link) const {
  const double d = m_x[link.high] - m_x[link.low] + link.multiplier / (kPenalty * link.k);
  return d > link.upper ? d - link.upper : d < -link.lower ? d + link.lower : 0;
}

double QuadraticProgram::step(Slot slot) {
  double force = 0, stiffness = 0;
  for (const std::size_t n : m_at[slot]) {
    const Link& link = m_links[n];
    const double pull = link.k * (m_x[link.high] - m_x[link.low] + kPenalty * beyond(link));
    force += slot == link.low ? pull : -pull;
    stiffness += link.k * (1 + kPenalty);
  }
  const double by = 1.8 * force / stiffness;
  m_x[slot] += by;
  return by;
}

}  // namespace supple::test
