// Owners of nodes: the sets, of those that one drag of a mesh body names, that nodes belong to.
#pragma once

#include <string>
#include <vector>

#include "lib/body/slot_set.h"
#include "lib/chainmail/mesh_ecm.h"
#include "volumes/base/error.h"

namespace supple {

class NodeOwners {
 public:
  explicit NodeOwners(std::size_t nodes) : m_owner(nodes, -1) {}

  /// The set's nodes, each once. `may_share`: those that an earlier such set has are left out.
  /// Throws InputError: no node at all, an index without node, a node of another set.
  std::vector<Slot> claim(const NodeSet& set, const std::string& name, bool may_share);

 private:
  struct Set {
    std::string name;
    bool may_share;
  };
  std::vector<int> m_owner;  // index into m_sets, or -1
  std::vector<Set> m_sets;
};

inline std::vector<Slot> NodeOwners::claim(const NodeSet& set, const std::string& name,
                                           bool may_share) {
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
