// Displacements that the inversion benchmark inverts. Every voxel moves in all of them, so that no
// part is inverted for nothing. The same values whatever the number of threads.
#pragma once

#include <string>

#include "volumes/field/offset_field.h"

namespace supple::tools {

/// A full block of size^3 voxels, spacing 1 mm:
///   smooth   a Gaussian bump, det F from 0.7 to 1.3;
///   extreme  the block twisted by 2 radians about k after a bump with det F down to 0.15, without
///            folds;
///   fold     a bump with det F down to -0.5, so that its front side folds over;
///   noisy    the result of Enhanced ChainMail for a diagonal pull in the middle of noise, under
///            the example table of design.md section 2, which lets cells fold; less the mean, in
///            whole voxels.
Displacement field_to_invert(const std::string& name, int size);

/// Lattice nodes that lie inside the six tetrahedra of a deformed cell and have no offset. Cells
/// with a face on the border of the valid ones are left out. Some 200 ns per cell and core.
std::int64_t missing_nodes(const VectorBricks& u, const VectorBricks& o);

/// Nodes of the displacement's own box that its material covers now: where methods that fill the
/// whole box are judged.
BrickTopology inner_nodes(const Displacement& displacement);

/// Residuals |o + u(x + o)| of any method's offsets at these nodes; a node without an offset, with
/// one that leads out of the material, or half a voxel off counts as missing.
struct Judgement {
  double residual_max = 0, residual_p999 = 0;
  std::int64_t missing = 0;
};
Judgement judge(const VectorBricks& u, const VectorBricks& o, const BrickTopology& nodes);

}  // namespace supple::tools
