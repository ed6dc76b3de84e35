// A state's body as hexahedra for other programs: one per element, corners shared where a link
// joins elements and apart across cuts and gaps.
//
// The displacement of a corner is the mean, over the elements around it, of each one's own plus its
// gradient (linked_elements.h) times the way to the corner: exact for affine motions up to the
// surface, of second order otherwise.
// Cost: 60 bytes per element beside the result, 1 µs per element and core.
#pragma once

#include <string>
#include <vector>

#include "lib/state/state.h"
#include "volumes/io/vtu/solid_file.h"

namespace supple {

/// Points at rest with `displacement` in mm, LPS; cells with `density`, `jacobian` (det F), where
/// there are some `label` and `piece`, and `more`, whose values are in the order of the elements.
/// Throws InputError for a state without elements or with a damaged material table; Cancelled.
HexSolid solid_of(const State& state, const std::string& path, std::vector<SolidArray> more,
                  Progress* progress = nullptr);

/// The voxels of the elements, in the order of the cells of solid_of().
std::vector<Vec3i> voxels_of(const BrickTopology& elements);

}  // namespace supple
