// Poses of rigid pieces after finite elements, which know these as stiff elements only.
#pragma once

#include <cstdint>
#include <utility>

#include "lib/body/body.h"

namespace supple {

/// Pieces whose elements are not where their pose has them take the rigid pose nearest to where
/// these came to: linear equations let what turns grow. Returns how many did, and by how many
/// voxels that moved an element at most.
std::pair<std::int64_t, double> fit_pieces(Body& body);

}  // namespace supple
