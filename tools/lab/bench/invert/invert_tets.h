// The inversion benchmark's reference: a displacement that is linear on six tetrahedra per cell
// (Kuhn's split), rasterised. Exact for that field, folds included; the smallest |o| wins.
#pragma once

#include "volumes/field/offset_field.h"

namespace supple::tools {

/// Offsets at the nodes that the tetrahedra of complete cells cover, borders included.
VectorBricks invert_by_tetrahedra(const Displacement& displacement);

}  // namespace supple::tools
