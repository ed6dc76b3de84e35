// A body with its anchors and holds: beside the node state, all that its models share.
#pragma once

#include <vector>

#include "lib/chainmail/ecm.h"
#include "lib/chainmail/mesh_ecm.h"

namespace supple {

/// References: all outlive the models. Code that changes anchors or holds tells models of
/// relaxation and springs by a move(), of no handle if need be. VoxelEcmModel looks at them in
/// every move() anyway.
struct HeldBody {
  Body& body;
  const std::vector<Region>& anchors;  // fixed
  Holds& holds;                        // elements that handles hold; models add theirs
};

struct HeldMesh {
  MeshBody& body;
  const std::vector<NodeSet>& anchors;  // fixed
  NodeSet& anchored;                    // nodes that handles hold; models add theirs
};

/// Adds nodes to a set that stays ascending, each once.
void add_nodes(NodeSet& set, const NodeSet& more);
/// Takes nodes out of a set.
void remove_nodes(NodeSet& set, const NodeSet& less);

}  // namespace supple
