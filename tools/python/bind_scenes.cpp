// Scenes from files and dicts, what they are going to take, and names of presets and materials.
#include "lib/material/presets.h"
#include "lib/session/step_model.h"
#include "lib/state/state.h"
#include "raycast/scene/transfer_function.h"
#include "tools/python/attended.h"
#include "tools/python/bindings.h"
#include "tools/python/python_values.h"
#include "tools/scene/file/scene.h"
#include "tools/scene/plan/memory_need.h"
#include "tools/scene/plan/plan_text.h"
#include "tools/scene/run/output_plan.h"
#include "tools/scene/run/run_report.h"
#include "tools/scene/run/scene_run.h"
#include "volumes/base/relayed_progress.h"

namespace py = pybind11;

namespace supple::python {

namespace {

/// A path, or the keys themselves.
tools::Scene scene_of(const Value& source) {
  if (source.is_text()) return tools::read_scene(source.text());
  return tools::read_scene(Table(source, "scene"));  // has a file: folders are made
}

/// Takes the time of stages.
class TimedProgress final : public RelayedProgress {
 public:
  using RelayedProgress::RelayedProgress;
  void stage(std::string_view name) override {
    m_times.begin(name);
    RelayedProgress::stage(name);
  }
  const tools::StageSeconds& seconds() {
    m_times.end();
    return m_times.seconds();
  }

 private:
  tools::StageTimes m_times;
};

Value run_scene(const Value& source, const std::string& folder, bool may_overwrite,
                const py::object& callback) {
  return attended(callback, [&](Progress& listener) {
    TimedProgress progress(&listener);
    const tools::Scene scene = scene_of(source);
    for (const std::string& line : scene.warnings) progress.warn(line);
    tools::check_scene(scene, folder, may_overwrite);
    tools::require_memory_to_run(scene, &progress);
    tools::SceneRun run(scene, folder, true, progress);
    tools::require_memory(scene, run);
    run.run();
    return tools::run_report(run, scene, folder, progress.seconds());
  });
}

Value plan_scene(const Value& source, const std::string& folder, const py::object& callback) {
  return attended(callback, [&](Progress& progress) {
    const tools::Scene scene = scene_of(source);
    const tools::OutputPlan files = tools::check_scene(scene, folder, true);
    tools::SceneRun run(scene, folder, false, progress);
    run.check_steps();
    Value plan = tools::to_value(tools::plan_of(scene, run));
    plan["files"] = files.files();
    return plan;
  });
}

}  // namespace

void bind_scenes(py::module_& module) {
  module.def("run_scene", &run_scene);
  module.def("plan_scene", &plan_scene);
  module.def("is_state", &is_state_file);
  module.def("presets", [] { return Value(preset_names()); });
  module.def("materials", [] {
    Value names = Value::List();
    for (const TissuePreset& preset : tissue_presets()) names.push_back(preset.name);
    for (const MaterialPreset& preset : material_presets()) names.push_back(preset.name);
    return names;
  });
  module.def("models", [] {
    Value names = Value::List();
    for (const StepModel& model : step_models()) names.push_back(model.name);
    return names;
  });
}

}  // namespace supple::python
