#include "lib/session/session.h"
#include "tools/scene/file/scene.h"
#include "tools/scene/plan/scene_plan.h"
#include "tools/scene/plan/unit_costs.h"
#include "tools/scene/run/scene_run.h"
#include "volumes/base/error.h"
#include "volumes/base/memory.h"
#include "volumes/base/stopwatch.h"

namespace supple::tools {

ScenePlan plan_of(const Scene& scene, const SceneRun& run) {
  const double held_mb = rss_mb(), peak_mb = peak_rss_mb();
  const State state = run.opened();
  return plan_scene(scene,
                    {run.session(), state, loading_seconds(), run.open_s(), held_mb, peak_mb},
                    read_costs(calibration_file()));
}

double planned_solve_s(const Scene& scene, const Session& session) {
  Scene solved = scene;
  solved.views.clear();
  solved.output = {};
  const State state = session.state();
  const ScenePlan plan = plan_scene(solved, {&session, state}, read_costs(calibration_file()));
  double seconds = 0;
  for (const PlanRow& row : plan.rows) {
    if (row.stage.rfind("step ", 0) == 0) seconds += row.seconds;
  }
  return seconds;
}

}  // namespace supple::tools
