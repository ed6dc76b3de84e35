// Limits at which solutions of finite elements end.
#pragma once

#include "lib/session/fem_step.h"

namespace supple {

/// Returns the parameters with the limits that hold, which records have: where places and reactions
/// alone are asked for, and no `tolerance`, an error of a twentieth of the voxels' shortest edge.
/// Values at elements, means over labels where a body has some, a motion that goes on from here,
/// and equations that know no `error_mm` have the tolerances of their accuracy. What is told of a
/// step does not matter.
FemParams solved_params(const FemStep& step, bool has_labels, double shortest_edge_mm);

/// Asks for reactions to 0.1 %, unless the step's limits say something else or ask for more.
void settle_reactions(FemStep& step);

}  // namespace supple
