// The plan of a scene that a run has opened.
#pragma once

#include "tools/scene/plan/scene_plan.h"
#include "tools/scene/run/scene_run.h"

namespace supple::tools {

/// Plans with the costs of the user's calibration. Throws InputError where that is damaged.
ScenePlan plan_of(const Scene& scene, const SceneRun& run);

/// Seconds that the steps of a scene take in the session of its volume, which has taken none of
/// them. Throws InputError where the calibration is damaged.
double planned_solve_s(const Scene& scene, const Session& session);

}  // namespace supple::tools
