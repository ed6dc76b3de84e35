// A step of a session for one of its mesh bodies: the nodes that its places name, and the move.
#pragma once

#include "lib/session/deformable_mesh.h"
#include "lib/session/step.h"

namespace supple {

/// The move that a step asks of a mesh body. Places are found among the nodes at rest: a voxel or a
/// point names the nearest node, a box or a ball those inside. Handles that follow paths are at
/// their shifts at `time`. Throws InputError, naming the step's place, for what mesh bodies do not
/// know (cuts, rigid pieces, turns, densities and the like) and for a box or ball without node.
MeshMove mesh_move(const Step& step, const DeformableMesh& mesh, const Geometry& geometry,
                   double time);

/// Returns a move as a journal records it, with its nodes.
Value to_value(const MeshRecord& record, const Step& step);

}  // namespace supple
