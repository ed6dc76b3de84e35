// Handles that have not all corners of their elements to themselves (lib/model/fem_grips.h).
#pragma once

#include <string>
#include <vector>

#include "lib/fem/fem_report.h"
#include "lib/model/fem_grips.h"
#include "volumes/base/progress.h"

namespace supple {

/// Finds such handles; leaves out soft edges, which promise no place.
std::vector<SharedHandle> shared_handles(const std::vector<GripReach>& reaches,
                                         const std::vector<FemGrip>& grips,
                                         const std::vector<Handle>& handles,
                                         const Geometry& geometry);

/// Says how many there are, and where the worst is.
void warn_of_shared(const std::vector<SharedHandle>& shared, Progress* progress);

}  // namespace supple
