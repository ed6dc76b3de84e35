// Which of the sets that one drag of a mesh body names a node belongs to.
#pragma once

#include <string>
#include <vector>

#include "lib/body/lattice.h"
#include "lib/chainmail/mesh_ecm.h"

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

}  // namespace supple
