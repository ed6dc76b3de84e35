// The one stage that runs a step, whether a scene or the options of `supple deform` ask for it.
#pragma once

#include <limits>

#include "lib/session/session.h"
#include "tools/scene/file/scene.h"

namespace supple::tools {

/// Voxels are checked before anything is solved; elements are known only to the body. Throws
/// InputError.
void check_step(const SceneStep& step, const Geometry& geometry);

/// Handles follow their paths from the first key to the last.
constexpr double kWholePaths = std::numeric_limits<double>::infinity();

/// The request of a step to the solver, on the grid of the volume. Handles that have a path are at
/// their poses at `time`, where a film takes them at once.
StepRequest request_of(const SceneStep& step, const Geometry& geometry, double time = kWholePaths);

/// Throws InputError, naming the step, for handles and fixed voxels that are no elements.
void check_step(const Session& session, const SceneStep& step);

/// Names the step in the errors of the solver. `tells_reactions`: the record holds the forces on
/// handles.
const StepRecord& run_step(Session& session, const SceneStep& step, bool tells_reactions,
                           Progress* progress, double time = kWholePaths);

}  // namespace supple::tools
