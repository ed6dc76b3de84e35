// Solution of a step of finite elements on tetrahedra (tet_step.h) in the body of a session.
#pragma once

#include <memory>

#include "lib/session/fem_task.h"
#include "lib/session/tets/tet_body.h"

namespace supple {

/// Moves the body: voxels follow the tetrahedra that hold them, and elements that are held go where
/// they were to be. `step.tets` is there; `tets` is its mesh of the body. Throws InputError for
/// what tetrahedra do not know and as TetModel, NotConverged, Cancelled; the body is unchanged
/// then.
FemRecord move_by_tets(const FemStep& step, const FemTask& task, const TetBody& tets,
                       const std::vector<Handle>& handles, Progress* progress);

}  // namespace supple
