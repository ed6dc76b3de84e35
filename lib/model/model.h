// Interface that all models of a body share, so that a scene may exchange them while it runs
// (thesis chapter 5: "a simulation may change its algorithm").
//
// A model takes the node state of a body when it is made: offsets or positions, velocities where it
// knows motion. It moves the nodes step by step and hands them back with store(); the next model
// goes on from there. Nothing else passes from one to the other, and nothing is lost between them:
// a model leaves values that it does not know of (velocities, in ECM and relaxation) as they are.
// Under finite elements a body in equilibrium is at rest.
//
// | model   | voxel bodies     | mesh bodies     | a step is      | knows               |
// |---------|------------------|-----------------|----------------|---------------------|
// | ecm     | VoxelEcmModel    | MeshEcmModel    | nothing        | limits              |
// | relax   | RelaxModel       |                 | a pass         | limits, elasticity  |
// | springs | VoxelSpringModel | MeshSpringModel | a step of time | elasticity, inertia |
// | fem     | VoxelFemModel    |                 | nothing        | elasticity          |
// |         | VoxelFemMotion   |                 | a step of time | elasticity, inertia |
#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "lib/chainmail/drag.h"
#include "lib/chainmail/mesh_ecm.h"
#include "lib/relax/relax_report.h"
#include "volumes/base/progress.h"

namespace supple {

/// Energies that a model knows of, in J; 0 for the others.
struct ModelEnergy {
  double elastic_j = 0;
  double kinetic_j = 0;
  double gravity_j = 0;

  double total_j() const { return elastic_j + kinetic_j + gravity_j; }
};

/// Handle is that of the kind of body (chainmail/ecm.h, chainmail/mesh_ecm.h).
template <class Handle>
class Model {
 public:
  Model() = default;
  virtual ~Model() = default;
  Model(const Model&) = delete;
  Model& operator=(const Model&) = delete;

  /// Sends the handles on their way from where they are: models that know time move them evenly
  /// over the next `steps` steps, the others at once. At the end they stay held where they are,
  /// among the holds of the body, until those are changed. Throws InputError as the ECM drag of
  /// that body does: a handle without nodes, held twice, beyond the range. Nothing has moved then.
  virtual void move(const std::vector<Handle>& handles, int steps, Progress* progress) = 0;
  /// Makes one pass, or one step of time. False when the body has come to rest by the model's own
  /// measure: further steps change nothing. When `progress` cancels, long steps throw Cancelled,
  /// the body as it was before them.
  virtual bool step(const Progress* progress = nullptr) = 0;
  /// The part of its work that is done, where something other than a number of steps ends it.
  virtual double part_done() const { return 0; }
  /// The energy of the body as it is now.
  virtual ModelEnergy energy() = 0;
  /// The forces at these handles, now or in the last step of time, in their order; wherever they
  /// are to go. Throws InputError for one without nodes.
  virtual std::vector<Reaction> reactions(const std::vector<Handle>& handles) = 0;
  /// Hands the node state to the body. Other data of this model stay, so that it may go on.
  virtual void store() = 0;
};

/// Makes up to `steps` steps, fewer where the body comes to rest, then store(); returns how many.
/// When `progress` cancels, the state after the last finished step is stored and Cancelled thrown.
template <class Handle>
int run_model(Model<Handle>& model, int steps, Progress* progress = nullptr) {
  int done = 0;
  try {
    for (bool moves = true; moves && done < steps; ++done) {
      report(progress, std::max(double(done) / steps, model.part_done()));
      moves = model.step(progress);
    }
  } catch (const Cancelled&) {
    model.store();
    throw;
  }
  model.store();
  return done;
}

// A body with its anchors and holds: beside the node state, all that its models share.

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

/// Enhanced ChainMail (voxel_ecm_model.h), for models of one's own that go on with it.
std::unique_ptr<Model<Handle>> make_ecm_model(const HeldBody& held);

}  // namespace supple
