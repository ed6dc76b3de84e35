#include "lib/chainmail/node_owners.h"

#include "volumes/base/error.h"

namespace supple {

std::vector<Slot> NodeOwners::claim(const NodeSet& set, const std::string& name, bool may_share) {
  if (set.empty()) throw InputError({"", name, "no node", "at least one node"});
  std::vector<Slot> nodes;
  nodes.reserve(set.size());
  const int id = int(m_sets.size());
  m_sets.push_back({name, may_share});
  for (const int node : set) {
    if (node < 0 || std::size_t(node) >= m_owner.size()) {
      throw InputError({"", name, "node " + std::to_string(node),
                        "an index below " + std::to_string(m_owner.size())});
    }
    int& owner = m_owner[std::size_t(node)];
    if (owner == id) continue;
    if (owner < 0) {
      owner = id;
      nodes.push_back(Slot(node));
    } else if (!may_share || !m_sets[std::size_t(owner)].may_share) {
      throw InputError({"", m_sets[std::size_t(owner)].name + " and " + name,
                        "node " + std::to_string(node) + " in both", "every node in one of them"});
    }
  }
  return nodes;
}

}  // namespace supple
