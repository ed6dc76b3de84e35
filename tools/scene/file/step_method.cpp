#include "tools/scene/file/step_method.h"

#include <algorithm>

#include "lib/fem/voxel/fem.h"
#include "volumes/base/error.h"

namespace supple::tools {

namespace {

/// Time that springs have to follow their handles and come to rest. Short of a second they still
/// swing, in which case their error says so.
constexpr double kSpringTime_s = 1.0;
constexpr double kFineTolerance = 1e-6;

void by_box(Step&, double) {}
void by_ball(Step& step, double) {
  step.limits = Limits::ball;
}
void by_relaxation(Step& step, double passes) {
  step.no_relax = false;
  step.relax = RelaxParams();
  step.relax->passes = int(passes);
}
void by_elastic_relaxation(Step& step, double passes) {
  by_relaxation(step, passes);
  step.relax->poisson = true;
}
void by_springs_at_rest(Step& step, double steps) {
  step.springs = SpringStep();
  step.springs->motion.minimise = true;
  step.springs->most_steps = int(steps);
}
template <SpringMethod integrator>
void by_springs(Step& step, double steps) {
  step.springs = SpringStep();
  step.springs->motion.method = integrator;
  step.springs->time_s = kSpringTime_s;
  step.springs->motion.step_s = kSpringTime_s / steps;
}
void by_fem(Step& step, double tolerance) {
  if (!step.fem) step.fem.emplace();
  step.fem->params.set_accuracy(FemAccuracy::exact);  // from rest, whatever came before
  step.fem->params.tolerance = tolerance;
  step.fem->params.reaction_tolerance = std::max(1e-9, tolerance);
  step.fem->params.max_iterations = 5000;
}

/// Elements of parts of a voxel say how far those of whole voxels are from their limit.
void by_fine_fem(Step& step, double halvings) {
  by_fem(step, kFineTolerance);
  step.fem->halvings = int(halvings);
}

/// The best that elements of several voxels can do; their own error is far larger.
void by_coarse_fem(Step& step, double doublings) {
  constexpr double kCoarseTolerance = 1e-4;
  by_fem(step, kCoarseTolerance);
  step.fem->params.doublings = int(doublings);
}

/// Solves the same elements, but for their dilatation, by another program.
void by_calculix(Step& step, double solver) {
  by_fem(step, kFineTolerance);
  step.fem->params.solver = EquationSolver(int(solver));
}

/// Solves the same elements by a library for any equations.
void by_dolfinx(Step& step, double tolerance) {
  by_fem(step, tolerance);
  step.fem->params.solver = EquationSolver::dolfinx;
}

bool is_by_fem(const MethodFamily& family) {
  return family.solve == by_fem || family.solve == by_fine_fem || family.solve == by_coarse_fem ||
         family.solve == by_calculix || family.solve == by_dolfinx;
}

const std::vector<double> kPasses = {1, 4, 16, 64, 256, 1024};

}  // namespace

const std::vector<MethodFamily>& method_families() {
  constexpr int kMostSteps = SpringStep::kMostSteps;
  static const std::vector<MethodFamily> families = {
      {{"ecm", "ECM", "links", 6, 26, true, {6, 18, 26}, true}, kKnobLinks, by_box},
      {{"ecm-ball", "ECM, ball limits", "links", 6, 6, true, {6}, true}, kKnobLinks, by_ball},
      {{"relax-6", "relaxed, 6 links", "passes", 1, kMaxPasses, true, kPasses}, 6, by_relaxation},
      {{"relax-18", "relaxed, 18 links", "passes", 1, kMaxPasses, true, kPasses},
       18,
       by_relaxation},
      {{"relax-26", "relaxed, 26 links", "passes", 1, kMaxPasses, true, kPasses},
       26,
       by_relaxation},
      {{"relax-poisson", "relaxed, volume by \u03bd", "passes", 1, kMaxPasses, true, kPasses},
       6,
       by_elastic_relaxation},
      {{"springs", "springs, to rest", "steps", 1, kMostSteps, true, {2, 8, 32, 128}},
       0,
       by_springs_at_rest},
      {{"springs-implicit", "implicit Euler, 1 s", "steps", 1, kMostSteps, true, {2, 8, 32}},
       0,
       by_springs<SpringMethod::implicit>},
      {{"springs-projective", "projective dyn., 1 s", "steps", 1, kMostSteps, true, {2, 8, 32}},
       0,
       by_springs<SpringMethod::projective>},
      {{"springs-xpbd", "XPBD, 1 s", "steps", 1, kMostSteps, true, {8, 32}},
       0,
       by_springs<SpringMethod::xpbd>},
      {{"springs-symplectic", "symplectic Euler, 1 s", "steps", 1, kMostSteps, true, {32}},
       0,
       by_springs<SpringMethod::symplectic>},
      {{"fem",
        "finite elements",
        "tolerance",
        1e-12,
        0.5,
        false,
        {1e-1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8}},
       0,
       by_fem},
      {{"fem-coarse",
        "elements of 2, 4, 8 voxels",
        "doublings",
        1,
        kMostDoublings,
        true,
        {1, 2, 3}},
       0,
       by_coarse_fem},
      {{"fem-fine", "elements of parts of a voxel", "halvings", 1, kMostHalvings, true, {1}},
       0,
       by_fine_fem},
      {{"calculix", "CalculiX: direct, iterative", "solver", 1, 2, true, {2, 1}}, 0, by_calculix},
      {{"dolfinx", "DOLFINx with GAMG", "tolerance", 1e-12, 0.5, false, {1e-4, 1e-6}},
       0,
       by_dolfinx},
  };
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
  if (step.fem && has_own_loads(*step.fem) && !is_by_fem(*method.family)) {
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
  step.springs.reset();
  step.fem.reset();
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
    if (!step.fem) continue;
    step.fem->params.set_accuracy(accuracy);
    has_fem = true;
  }
  if (has_fem) return;
  throw InputError(
      {scene.file, "--accuracy", "no step of finite elements", "a step with model = \"fem\""});
}

}  // namespace supple::tools
