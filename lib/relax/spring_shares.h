// How much of a body's elasticity the springs of each kind of link carry.
//
// A spring that stretches by u(x + l) - u(x) along the step l stores k (l . grad u)^2 / 2 in each
// coordinate, so that all kinds together are the continuum E |grad u|^2 / 2 per volume where
//   sum over kinds of k l_a l_b = E V delta_ab,
// V the volume of a voxel. Along the axes alone this is k = E V / h_a^2, Young's modulus times area
// over length. Diagonals in their four or two directions add nothing to a != b. With
//   k = w E V / (longest spacing along the diagonal)^2
// the axes carry the rest, which is always positive. Where the spacings are equal, w is that of the
// isotropic stencils of 18 and 26 neighbours (lattice Boltzmann's D3Q19 and D3Q27):
//   18: 1/3 along axes, 1/6 across faces;   26: 4/9 along axes, 1/9 across faces, 1/36 across
//   cells,
// for which the terms of fourth order are a multiple of (d^2)^2 as well: a handle's dimple is round
// already a few voxels from it (docs/models/relaxation.md).
#pragma once

#include "lib/relax/link_kinds.h"
#include "volumes/base/vec.h"

namespace supple {

/// Stiffness in N/m of a link of one kPa, for 6, 18 or 26 links per voxel.
std::array<double, kLinkKinds> spring_shares(const Vec3d& spacing_mm, int links);

}  // namespace supple
