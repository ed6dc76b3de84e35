// Method by which the steps of a scene are solved, in place of its own: "relax-26:64" is Enhanced
// ChainMail with 26 links, then 64 passes of relaxation. Loads, anchors, cuts, views and outputs
// stay those of the scene, so that methods are compared under one load.
#pragma once

#include "lib/session/step_model.h"
#include "tools/scene/file/scene.h"

namespace supple::tools {

struct MethodFamily : ModelMethod {
  const StepModel* model;
};
using StepMethod = KnobSetting<MethodFamily>;

/// The methods of all models (lib/session/step_model.h), in the order of charts.
const std::vector<MethodFamily>& method_families();

/// Throws InputError as parse_knob.
StepMethod parse_method(const std::string& text);

/// Steps that only relaxed, or only named a model, are left out; views go by the steps that stay.
/// Throws InputError, with the step's place, where the method cannot take what a step asks for:
/// forces and shapes in contact without the model that knows them, tightened limits; and for links
/// of a scene without material, for films and journals.
void solve_by(Scene& scene, const StepMethod& method);

/// Finite elements of all steps end at this accuracy, in place of the tolerances that the scene
/// says. Throws InputError for a scene without finite elements.
void solve_to(Scene& scene, FemAccuracy accuracy);

}  // namespace supple::tools
