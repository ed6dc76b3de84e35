// The tables `springs` and `fem` of what moves a body, in a step of a scene or for the drags of a
// live session.
#pragma once

#include "tools/scene/file/scene.h"

namespace supple::tools {

/// Reads `springs` or `fem` of the step, unless the model is ECM; without a table its defaults.
/// Throws InputError for the table of another model, and for relax or limits beside one.
void read_model(Table& table, const LabelNames& names, StepModel model, Step& step);

}  // namespace supple::tools
