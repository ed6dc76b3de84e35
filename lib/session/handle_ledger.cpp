#include "lib/session/handle_ledger.h"

#include <algorithm>

#include "lib/model/quasi_static.h"
#include "lib/session/removal.h"

namespace supple {

void HandleLedger::add(int step, const std::vector<Handle>& handles, const Body& body) {
  const std::vector<SlotSet> elements = elements_of_handles(body, handles);
  std::vector<SlotSet::Brick> bricks;
  for (const SlotSet& set : elements) {
    bricks.insert(bricks.end(), set.bricks().begin(), set.bricks().end());
  }
  const SlotSet taken(std::move(bricks));
  for (LedgerEntry& entry : m_handles) entry.elements.remove(taken);
  m_handles.erase(std::remove_if(m_handles.begin(), m_handles.end(),
                                 [](const LedgerEntry& entry) { return entry.elements.empty(); }),
                  m_handles.end());
  int number = 0;
  for (std::size_t n = 0; n < handles.size(); ++n) {
    if (handles[n].is_edge && n > 0) {
      m_handles.back().elements.add(elements[n]);
    } else {
      m_handles.push_back({step, ++number, handles[n].region.name(), elements[n]});
    }
  }
}

void HandleLedger::move_to(const BrickTopology& from, const BrickTopology& to) {
  for (LedgerEntry& entry : m_handles) entry.elements = moved_to(from, to, entry.elements);
  m_handles.erase(std::remove_if(m_handles.begin(), m_handles.end(),
                                 [](const LedgerEntry& entry) { return entry.elements.empty(); }),
                  m_handles.end());
}

std::vector<SlotSet> HandleLedger::elements() const {
  std::vector<SlotSet> elements;
  for (const LedgerEntry& entry : m_handles) elements.push_back(entry.elements);
  return elements;
}

std::vector<HandleReaction> HandleLedger::name(const std::vector<Reaction>& reactions) const {
  std::vector<HandleReaction> named;
  for (std::size_t n = 0; n < m_handles.size(); ++n) {
    const LedgerEntry& entry = m_handles[n];
    named.push_back({entry.step, entry.handle, entry.name, reactions[n]});
  }
  return named;
}

std::vector<HandleReaction> HandleLedger::name(const std::vector<FemReaction>& reactions) const {
  std::vector<Reaction> forces;
  for (const FemReaction& reaction : reactions) forces.push_back({reaction.force_n});
  std::vector<HandleReaction> named = name(forces);
  for (std::size_t n = 0; n < named.size(); ++n) named[n].moment_nmm = reactions[n].moment_nmm;
  return named;
}

}  // namespace supple
