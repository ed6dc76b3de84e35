// --dry-run: what a run of a scene would do, and its plan.
#pragma once

#include <string>

#include "tools/console/console.h"
#include "tools/scene/run/scene_run.h"

namespace supple::tools {

/// Checks the scene against its volume, prints what it would do and its plan, and writes
/// nothing. Reads the volume. Returns the exit code.
int tell_plan(const Scene& scene, const std::string& folder, const GlobalOptions& global,
              Console& console);

}  // namespace supple::tools
