// The plan of a scene that a run has opened: printed in place of the run (--dry-run), or ahead of
// it and compared with it afterwards (--plan).
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "tools/console/console.h"
#include "tools/scene/plan/scene_plan.h"
#include "tools/scene/run/scene_run.h"

namespace supple::tools {

/// With the costs of the user's calibration. Throws InputError where that is damaged.
ScenePlan plan_of(const Scene& scene, const SceneRun& run, Console& console);

/// Seconds that the steps of a scene take in the session of its volume, which has taken none of
/// them. Throws InputError where the calibration is damaged.
double planned_solve_s(const Scene& scene, const Session& session);

/// The scene's volume, steps with the places of handles, and outputs.
nlohmann::ordered_json scene_json(const Scene& scene, const std::string& folder,
                                  const SceneRun& run);

/// --dry-run: checks the scene against its volume, prints what it would do and its plan, and writes
/// nothing. Reads the volume. Returns the exit code.
int tell_plan(const Scene& scene, const std::string& folder, const GlobalOptions& global,
              Console& console);

}  // namespace supple::tools
