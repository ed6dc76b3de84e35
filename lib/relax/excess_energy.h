// How far a relaxation may be above the least energy: from the forces that are left, whatever the
// last steps were.
//
// The energy E of one coordinate is a parabola. With the residual forces r and the minimum u*,
//   E(u) - E* = s^2 / 2,  s^2 = |u* - u|_K^2 = r.(u* - u).
// Nothing of u* lies outside the range of present offsets R (maximum principle). Of a cluster of
// elements that stiff links join, the net force F acts over R and the rest d of the forces, which
// adds up to zero, over the cluster's own give: paths of at most n links of k or more between its n
// elements. Elements outside are clusters of one. So
//   s^2 <= R sum |F| + s sqrt(sum n (sum |d|)^2 / k).
// Limits: a set of elements that links at their limits join counts by its net force, and not at all
// where a limit stops it; forces between its elements are taken for the limits' load. The bound is
// rigorous where no limit is reached.
#pragma once

#include <vector>

#include "lib/body/body.h"
#include "lib/body/region.h"
#include "lib/body/slot_set.h"
#include "lib/relax/movable.h"

namespace supple {

/// Twice the bound in N/m (2^-32 voxel)^2. `bricks`: those that hold offsets, ascending.
double excess_energy(const Body& body, const LinkTable& table, const Movable& elements,
                     const BrickArray<double>& now, const std::vector<Bound>& at_least,
                     const std::vector<Bound>& at_most, const std::vector<std::uint32_t>& bricks);

}  // namespace supple
