// Grips of handles, anchors and earlier moves on the finite elements of a voxel body, and values
// that its solid gives back to it.
//
// Held elements prescribe the corners of their voxels, which turn and scale as they do
// (held_corners.h). A corner that several hold goes with anchors first, then with holds of earlier
// moves, then handles of this one, then their soft edges; rigid pieces before tissue of the same
// kind. Several of one kind have it at their mean, weighted by their elements around it. The offset
// of a voxel is the mean of its eight corners; elements that are held get exactly the offset that
// they were to have, also where they share corners and the mean of these is another (GripReach).
#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "lib/chainmail/held_voxels.h"
#include "lib/fem/voxel/fem.h"

namespace supple {

/// Kinds of grips: the first has a corner that several hold; of each, rigid pieces before tissue.
enum class GripKind { anchor, held, handle, edge };

/// A motion that grips know beside their offsets: up to the start of a move, and up to its end.
struct GripMotion {
  GridSteps before = kUnitSteps, after = kUnitSteps;
  std::vector<Vec3d> from = {};  // offsets where it starts; empty: where the grip starts
};

/// Elements that go, or stay, together.
struct FemGrip {
  SlotSet slots;
  std::vector<Vec3d> start, offsets;  // of each in voxels: where they are, and are to be
  GripKind kind = GripKind::held;
  /// Grips of one field are parts of one motion: neighbours tell how their elements turn.
  int field = 0;
  std::optional<GripMotion> motion = {};
  std::size_t handle = 0;  // of the move, where it is one

  bool is_anchor() const { return kind == GripKind::anchor; }
  /// Rank of its elements around a corner: the lowest has it. A piece of an edge ranks as a handle.
  int rank(bool is_piece) const {
    return is_piece ? 2 * std::min(int(kind), int(GripKind::handle)) : 2 * int(kind) + 1;
  }
};

/// The grips of handles, anchors, edges of handles, then of what earlier moves left held. The part
/// of the last that lies in a set of `told` is a grip of its own. Single voxels that only shift are
/// points of one field. Soft edges that earlier drags left are let go in `found`: the material says
/// where they go. Throws InputError for push handles, of this drag or still held: neither statics
/// nor dynamics know sides.
std::vector<FemGrip> fem_grips(const Body& body, HeldVoxels& found,
                               const std::vector<SlotSet>& told);

/// A grip that has not all corners of its elements to itself: the mean offsets that its elements
/// were to have and have, in voxels, and by how much one of them is off at most.
struct GripReach {
  std::size_t grip;
  Vec3d asked, reached;
  double off_voxels;
};

/// Sums the reactions over each of the sets, `of_grip` being those of the grips; moments are about
/// the mean of their nodes.
std::vector<FemReaction> sums_over(const std::vector<SlotSet>& elements,
                                   const std::vector<FemGrip>& grips,
                                   const std::vector<FemReaction>& of_grip);

/// The value at the nodes of values at the centres of elements (in the order of the mesh): the mean
/// of what the elements around a node say, each with the slopes towards the neighbours to which a
/// face joins it. Exact for what is linear in space.
std::vector<double> at_nodes(const HexMesh& mesh, const Body& body,
                             const std::vector<Vec3d>& of_element);

/// Displacements of the body's elements in mm, LPS, in the order of the mesh.
std::vector<Vec3d> element_displacements(const HexMesh& mesh, const Body& body);
/// Velocities in mm/s, LPS; 0 where the body has none.
std::vector<Vec3d> element_velocities(const HexMesh& mesh, const Body& body);

/// Values at the centres of elements, of values at nodes: the mean of the nodes of each element.
std::vector<Vec3d> at_centres(const HexMesh& mesh, const std::vector<double>& nodes);

/// Hands displacements and velocities of elements to the body, in the order of its bricks; without
/// velocities it is at rest. Elements of grips get exactly where they were to be, where
/// `are_at_end`. Throws InputError for an offset beyond the range, the body unchanged.
void give_to_body(const std::vector<Vec3d>& u_mm, const std::vector<Vec3d>& v_mm_s,
                  const std::vector<FemGrip>& grips, bool are_at_end, Body& body);

}  // namespace supple
