#include "tools/scene/file/step_method.h"

#include "lib/model/refined_shape.h"
#include "volumes/base/error.h"

namespace supple::tools {

const std::vector<MethodFamily>& method_families() {
  static const std::vector<MethodFamily> families = [] {
    std::vector<MethodFamily> all;
    for (const StepModel& model : step_models()) {
      for (const ModelMethod& method : model.methods) all.push_back({method, &model});
    }
    return all;
  }();
  return families;
}

StepMethod parse_method(const std::string& text) {
  return parse_setting(text, method_families(), "method");
}

namespace {

bool has_own_loads(const FemStep& fem) {
  return !fem.loads.empty() || fem.gravity_m_s2 != Vec3d(0);
}

bool has_own_loads(const SpringStep& springs) {
  return !springs.motion.colliders.empty() || springs.motion.gravity_m_s2 != Vec3d(0);
}

void require_common_loads(const Step& step, const StepMethod& method) {
  const auto refuse = [&](const char* field, const char* found, const char* expected) {
    throw InputError({step.place, field, std::string(found) + " under " + method.name(), expected});
  };
  if (step.fem && has_own_loads(*step.fem) && method.family->model != &model_of(step)) {
    refuse("fem", "forces, pressures, swellings or gravity", "handles and anchors, or fem");
  }
  if (step.fem && step.fem->motion) refuse("motion", "a motion in time", "an equilibrium");
  if (step.springs && has_own_loads(*step.springs)) {
    refuse("springs", "shapes in contact or gravity", "handles and anchors");
  }
  if (step.limits == Limits::tighten) refuse("limits", "tighten", "a step without it");
}

void choose_links(MaterialTable& material, const StepMethod& method) {
  if (method.family->links == 0) return;
  material.links = method.family->links == kKnobLinks ? int(method.knob) : method.family->links;
}

/// Drops the scene's solver of the step; false for steps without anything else altogether.
bool take_loads_alone(Step& step) {
  const std::optional<FemStep> fem = step.fem;
  step.relax.reset();
  take_model({}, step);
  step.limits = Limits::box;
  step.no_relax = true;
  const bool has_forces = fem && has_own_loads(*fem);
  if (has_forces) step.fem = fem;
  return has_forces || !step.does_nothing();
}

}  // namespace

void solve_by(Scene& scene, const StepMethod& method) {
  if (scene.film) throw InputError({scene.file, "film", "a film", "a scene of one result"});
  if (!scene.output.elements.empty()) {
    throw InputError({scene.file, "output.elements", "values of elements under " + method.name(),
                      "a scene without them"});
  }
  if (scene.material) {
    choose_links(*scene.material, method);
  } else if (method.family->links != 0) {
    throw InputError({scene.file, "material", "none under " + method.name(), "a table"});
  }
  std::vector<Step> steps;
  std::vector<int> kept_until = {0};  // steps that stay, of so many first ones
  for (Step& step : scene.steps) {
    require_common_loads(step, method);
    if (take_loads_alone(step)) {
      if (step.material) choose_links(*step.material, method);
      method.family->solve(step, method.knob);
      steps.push_back(std::move(step));
    }
    kept_until.push_back(int(steps.size()));
  }
  scene.steps = std::move(steps);
  for (SceneView& view : scene.views) {
    if (view.after_step) view.after_step = kept_until[std::size_t(*view.after_step)];
  }
}

void solve_to(Scene& scene, FemAccuracy accuracy) {
  bool has_fem = false;
  for (Step& step : scene.steps) {
    if (!step.fem || step.fem->tets) continue;
    step.fem->params.set_accuracy(accuracy);
    has_fem = true;
  }
  if (has_fem) return;
  throw InputError(
      {scene.file, "--accuracy", "no step of finite elements", "a step with model = \"fem\""});
}

}  // namespace supple::tools
