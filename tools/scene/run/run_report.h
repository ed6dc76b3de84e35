// The report of a run that is over, as `supple run --json` prints it.
#pragma once

#include <string>

#include "tools/scene/run/scene_run.h"
#include "tools/scene/run/stage_times.h"
#include "volumes/base/value.h"

namespace supple::tools {

/// Steps, rigid pieces, certificate, seconds, peak memory so far, and outputs.
Value run_report(const SceneRun& run, const Scene& scene, const std::string& folder,
                 const StageSeconds& stages);

}  // namespace supple::tools
