#include "tools/grips.h"

#include <algorithm>
#include <cstdio>

namespace supple::tools {

void Grips::add(int step, const std::vector<Handle>& handles) {
  for (std::size_t n = 0; n < handles.size(); ++n) {
    const Region& region = handles[n].region;
    m_grips.erase(std::remove_if(m_grips.begin(), m_grips.end(),
                                 [&](const Grip& grip) { return grip.handle.region == region; }),
                  m_grips.end());
    m_grips.push_back({step, int(n) + 1, handles[n]});
  }
}

std::vector<Handle> Grips::handles() const {
  std::vector<Handle> handles;
  for (const Grip& grip : m_grips) handles.push_back(grip.handle);
  return handles;
}

std::vector<GripForce> Grips::forces(const std::vector<Reaction>& reactions) const {
  std::vector<GripForce> forces;
  for (std::size_t n = 0; n < m_grips.size(); ++n) {
    const Grip& grip = m_grips[n];
    forces.push_back({grip.step, grip.number, grip.handle.region.name(), reactions[n]});
  }
  return forces;
}

nlohmann::ordered_json to_json(const std::vector<GripForce>& forces) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const GripForce& force : forces) {
    const Vec3d& n = force.reaction.force_n;
    json.push_back({{"step", force.step},
                    {"handle", force.handle},
                    {"grab", force.name},
                    {"force_n", {n.x, n.y, n.z}},
                    {"taut", force.reaction.taut}});
  }
  return json;
}

void print(const std::vector<GripForce>& forces) {
  for (const GripForce& force : forces) {
    const Vec3d& n = force.reaction.force_n;
    const auto& taut = force.reaction.taut;
    std::printf("pull at %-15s %.4g, %.4g, %.4g N (LPS)%s\n", force.name.c_str(), n.x, n.y, n.z,
                taut[0] || taut[1] || taut[2] ? ", or more: links at their limits join it to "
                                                "something else that is held"
                                              : "");
  }
}

}  // namespace supple::tools
