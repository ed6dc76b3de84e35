// What handles, anchors and earlier moves hold of the finite elements of a voxel body, and what its
// solid gives back to it.
//
// What is held prescribes the corners of its voxels. Corners of an element follow its own offset
// and, where its neighbours are held by the same, the slope of their offsets: a turn turns the
// corners, too. The offset of a voxel is the mean of its eight corners; elements that are held get
// exactly the offset that they were to have.
#pragma once

#include <vector>

#include "lib/chainmail/held_voxels.h"
#include "lib/fem/fem.h"

namespace supple {

constexpr double kJoulePerMillijoule = 1e-3;

/// Elements that go, or stay, together.
struct FemGrip {
  SlotSet slots;
  std::vector<Vec3d> start, offsets;  // of each in voxels: where they are, and are to be
  bool is_anchor = false;
};

/// Handles, anchors, edges of handles, then what earlier moves left held: a corner of several obeys
/// the first. What of the last lies in a set of `told` is a grip of its own. Soft edges that
/// earlier drags left are let go in `found`: where they go is the material's. Throws InputError for
/// push handles, of this drag or still held: neither statics nor dynamics know sides.
std::vector<FemGrip> fem_grips(const Body& body, HeldVoxels& found,
                               const std::vector<SlotSet>& told);

/// With the corners where the grip's elements are to be, or where they are; trilinear between them.
HeldElements held_at_end(const Body& body, const FemGrip& grip);
HeldElements held_at_start(const Body& body, const FemGrip& grip);

/// Sums over what each of the sets holds, `of_grip` being those of the grips; the moment about the
/// mean of their nodes.
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

/// The other way round: the mean of the nodes of each element.
std::vector<Vec3d> at_centres(const HexMesh& mesh, const std::vector<double>& nodes);

/// Hands displacements and velocities of elements to the body, in the order of its bricks; without
/// velocities it is at rest. Elements of grips get exactly where they were to be, where
/// `are_at_end`. Throws InputError for an offset beyond the range, the body unchanged.
void give_to_body(const std::vector<Vec3d>& u_mm, const std::vector<Vec3d>& v_mm_s,
                  const std::vector<FemGrip>& grips, bool are_at_end, Body& body);

}  // namespace supple
