#include "tools/grips.h"

#include <algorithm>
#include <cstdio>

#include "lib/model/quasi_static.h"

namespace supple::tools {

void HandleLedger::add(int step, const std::vector<Handle>& handles, const Body& body) {
  const std::vector<SlotSet> elements = elements_of_handles(body, handles);
  std::vector<SlotSet::Brick> bricks;
  for (const SlotSet& set : elements) {
    bricks.insert(bricks.end(), set.bricks().begin(), set.bricks().end());
  }
  const SlotSet taken(std::move(bricks));
  for (Grip& grip : m_grips) grip.elements.remove(taken);
  m_grips.erase(std::remove_if(m_grips.begin(), m_grips.end(),
                               [](const Grip& grip) { return grip.elements.empty(); }),
                m_grips.end());
  for (std::size_t n = 0; n < handles.size(); ++n) {
    m_grips.push_back({step, int(n) + 1, handles[n].region.name(), elements[n]});
  }
}

std::vector<SlotSet> HandleLedger::elements() const {
  std::vector<SlotSet> elements;
  for (const Grip& grip : m_grips) elements.push_back(grip.elements);
  return elements;
}

std::vector<HandleReaction> HandleLedger::forces(const std::vector<Reaction>& reactions) const {
  std::vector<HandleReaction> forces;
  for (std::size_t n = 0; n < m_grips.size(); ++n) {
    const Grip& grip = m_grips[n];
    forces.push_back({grip.step, grip.handle, grip.name, reactions[n]});
  }
  return forces;
}

nlohmann::ordered_json to_json(const std::vector<HandleReaction>& forces) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const HandleReaction& force : forces) {
    const Vec3d& n = force.reaction.force_n;
    json.push_back({{"step", force.step},
                    {"handle", force.handle},
                    {"grab", force.name},
                    {"force_n", {n.x, n.y, n.z}},
                    {"taut", force.reaction.taut}});
  }
  return json;
}

void print(const std::vector<HandleReaction>& forces) {
  for (const HandleReaction& force : forces) {
    const Vec3d& n = force.reaction.force_n;
    const auto& taut = force.reaction.taut;
    std::printf("pull at %-15s %.4g, %.4g, %.4g N (LPS)%s\n", force.name.c_str(), n.x, n.y, n.z,
                taut[0] || taut[1] || taut[2] ? ", or more: links at their limits join it to "
                                                "something else that is held"
                                              : "");
  }
}

}  // namespace supple::tools
