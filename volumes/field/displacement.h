// Displacement fields: extension into the air around the elements (design.md section 4).
// Cost of the extension: about 100 ns per new voxel and core.
#pragma once

#include "volumes/field/vector_bricks.h"

namespace supple {

/// Extends u from its valid voxels onto the active voxels of `target` ring by ring: each new voxel
/// takes the mean of its valid 26-neighbours of the ring before. Voxels of `target` that no ring
/// reaches stay invalid. Without it u = 0 in the air tears the surface (SSIM 0.89 against 0.9988).
Displacement extend(const Displacement& displacement, const BrickTopology& target);

}  // namespace supple
