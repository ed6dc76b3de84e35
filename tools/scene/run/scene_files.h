// Places of the files of a scene.
#pragma once

#include <string>
#include <vector>

#include "tools/scene/file/scene.h"
#include "tools/scene/run/output_plan.h"

namespace supple::tools {

/// The path of an output.
std::string path_in(const std::string& folder, const std::string& name);

/// Adds files that are no pictures.
void plan_outputs(const SceneOutput& output, const std::string& folder, OutputPlan& plan);

/// Throws InputError for an output by an absolute name or by "..", which lies outside of the
/// folder.
void require_inside(const Scene& scene, const std::string& folder);
/// The same for outputs of the file of another kind of scene.
void require_inside(const std::vector<std::string>& names, const std::string& file,
                    const std::string& folder);

}  // namespace supple::tools
