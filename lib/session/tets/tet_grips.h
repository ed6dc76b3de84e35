// Nodes of a mesh of tetrahedra that handles, anchors and earlier moves hold (lib/model/fem_grips.h
// has the elements of the body that they hold).
//
// A node goes with the element of the body nearest to it. Between the centres of elements a grip
// moves as the linear map nearest to what its elements do, so that turns and scales are exact. A
// grip without nodes, smaller than the tetrahedra, has for each element that corner of its
// tetrahedron which has the largest part in it.
#pragma once

#include <vector>

#include "lib/fem/tet/tet_fem.h"
#include "lib/model/fem_grips.h"
#include "lib/session/tets/voxel_sites.h"

namespace supple {

/// In the order of the grips; a node has one at most. Throws InputError where a grip gets none.
std::vector<TetHeld> held_nodes(const std::vector<FemGrip>& grips, const Body& body,
                                const TetModel& model, const std::vector<VoxelSite>& sites);

}  // namespace supple
