#include "tools/console/dry_run.h"

#include <cstdio>

#include "lib/session/step_model.h"
#include "tools/console/command.h"
#include "tools/console/result_lines.h"
#include "tools/scene/file/scene.h"
#include "tools/scene/plan/memory_need.h"
#include "tools/scene/plan/plan_text.h"
#include "tools/scene/plan/scene_plan.h"
#include "tools/scene/run/reports.h"
#include "tools/scene/run/scene_files.h"
#include "volumes/base/json.h"

namespace supple::tools {

namespace {

std::size_t fixed_count(const Step& step) {
  std::size_t count = 0;
  for (const ChosenPart& part : step.fix) {
    count += part.placed && part.placed->points ? part.placed->points->rows.size() : 1;
  }
  return count;
}

void print_scene(const Scene& scene, const std::string& folder, const SceneRun& run) {
  std::printf("volume  %s\n", scene.volume_path.c_str());
  for (std::size_t n = 0; n < scene.steps.size(); ++n) {
    const Step& step = scene.steps[n];
    const std::string of = step.body.empty() ? "" : " of body " + step.body;
    std::printf("step %zu%s  %zu handles, %zu fixed boxes, points and labels, %zu cuts%s%s\n",
                n + 1, of.c_str(), step.drags.size(), fixed_count(step), step.cuts.size(),
                step.release ? ", releases" : "",
                step.relax            ? ", relaxes"
                : has_own_model(step) ? (", " + model_of(step).title).c_str()
                                      : "");
    print_places(run.session()->places(step));
  }
  for (const std::string& name : scene.outputs()) {
    std::printf("writes  %s\n", path_in(folder, name).c_str());
  }
}

/// The scene's volume, steps with the places of handles, and outputs.
Value scene_json(const Scene& scene, const std::string& folder, const SceneRun& run) {
  Value json = {{"volume", scene.volume_path}};
  json["steps"] = Value::List();
  for (const Step& step : scene.steps) {
    json["steps"].push_back({{"handles", to_value(run.session()->places(step))},
                             {"fix", fixed_count(step)},
                             {"cuts", step.cuts.size()},
                             {"release", step.release},
                             {"relax", step.relax.has_value()}});
    for (std::size_t n = 1; n < step_models().size(); ++n) {
      json["steps"].back()[step_models()[n].name] = step_models()[n].moves(step);
    }
  }
  json["outputs"] = Value::List();
  for (const std::string& name : scene.outputs()) json["outputs"].push_back(path_in(folder, name));
  return json;
}

}  // namespace

int tell_plan(const Scene& scene, const std::string& folder, const GlobalOptions& global,
              Console& console) {
  require_memory_to_open(scene, &console);
  const SceneRun run(scene, folder, false, console);
  run.check_steps();
  const ScenePlan plan = plan_of(scene, run);
  if (global.json) {
    Value json = scene_json(scene, folder, run);
    json["plan"] = to_value(plan);
    std::printf("%s\n", json_text(json, 2).c_str());
  } else {
    print_scene(scene, folder, run);
    std::printf("\n%s", text_of_plan(plan).c_str());
  }
  return kOk;
}

}  // namespace supple::tools
