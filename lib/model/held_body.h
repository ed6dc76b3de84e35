// A body and what is held in it: beside the node state, all that its models share.
#pragma once

#include <vector>

#include "lib/chainmail/ecm.h"
#include "lib/chainmail/mesh_ecm.h"

namespace supple {

/// References: all outlive the models. Who changes anchors or holds makes a new model.
struct HeldBody {
  Body& body;
  const std::vector<Region>& anchors;  // fixed
  Holds& holds;                        // what handles hold; models add theirs
};

struct HeldMesh {
  MeshBody& body;
  const std::vector<NodeSet>& anchors;  // fixed
  NodeSet& still;                       // what handles hold; models add theirs
};

}  // namespace supple
