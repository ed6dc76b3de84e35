// Gibson's original ChainMail (thesis section 4.1.1, steps 1 to 6) with one candidate list per
// direction: four in 2D, six in 3D. It tears inhomogeneous bodies (figure 4.5); it is kept to show
// that. In a homogeneous one that is valid it moves exactly the elements that a staircase from the
// grabbed voxel reaches inside the body (along i, then j, then k), as ECM does, and no others: all
// of them in a box, and in other bodies, convex or not, where the grabbed voxel sees them so.
//
// Cost: one visit per node, no ordering.
#pragma once

#include <array>
#include <cstdint>

#include "lib/chainmail/reference/reference_lattice.h"

namespace supple::reference {

struct OriginalReport {
  std::int64_t processed = 0;  // list entries checked
  std::int64_t moved = 0;      // and found to need a move
};

/// Moves a node (counted from the lattice's origin) and processes the lists once, in the order
/// right (+i), left (-i), top (+j), bottom (-j), front (+k), back (-k).
OriginalReport original_chainmail(const ReferenceLattice& lattice, const Vec3i& node,
                                  const std::array<std::int32_t, 3>& by_q, Offsets& offsets);

/// The same for a voxel of a body: the body as original ChainMail leaves it. Its links need not
/// hold. `voxel` must be an element.
Body original_chainmail(const Body& body, const Vec3i& voxel,
                        const std::array<std::int32_t, 3>& by_q);

}  // namespace supple::reference
