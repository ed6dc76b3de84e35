// Elements that hang by edges or corners and can turn there: mechanisms, whose motions no elastic
// energy resists.
//
// Elements that are joined over faces are a piece; without strain it has its six rigid motions and
// no others. So the body moves without strain as its pieces do rigidly where they agree at the
// nodes that they share and leave what is held: by the null space of
//
//   G = sum over these conditions of  c c^T,   u_p - u_q = 0 at a shared node, u_p = 0 where held,
//
// with six unknowns per piece. eps (G + eps)^-1 leaves of a random vector what lies in it.
// Cost: a sparse factorisation of the pieces that share nodes; nothing where none do.
#pragma once

#include <vector>

#include "lib/fem/nodal_loads.h"
#include "lib/fem/voxel/hex_mesh.h"

namespace supple {

/// Tells for each element of the voxel mesh whether it lies in a piece that can move without
/// strain; empty where none does. Islands whose rigid motions nothing prevents are to be held.
/// Where nothing is held at all, the largest piece of each island counts as held.
std::vector<bool> hinged_elements(const HexMesh& voxels, const HeldBits& held);

}  // namespace supple
