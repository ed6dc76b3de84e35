#include "tools/scene/run/scene_files.h"

#include <filesystem>

namespace supple::tools {

std::string path_in(const std::string& folder, const std::string& name) {
  return folder.empty() ? name : (std::filesystem::path(folder) / name).string();
}

void plan_outputs(const SceneOutput& output, const std::string& folder, OutputPlan& plan) {
  if (!output.state.empty()) plan.add_state(path_in(folder, output.state));
  for (const auto* names : {&output.offsets, &output.displacements, &output.volumes}) {
    for (const std::string& name : *names) plan.add_dense(path_in(folder, name));
  }
  for (const ElementOutput& elements : output.elements) {
    plan.add_dense(path_in(folder, elements.path));
  }
  if (!output.forces.empty()) plan.add_table(path_in(folder, output.forces));
  if (!output.motion.empty()) plan.add_table(path_in(folder, output.motion));
}

void require_inside(const Scene& scene, const std::string& folder) {
  require_inside(scene.outputs(), scene.file, folder);
}

void require_inside(const std::vector<std::string>& names, const std::string& file,
                    const std::string& folder) {
  namespace fs = std::filesystem;
  const fs::path root = fs::absolute(folder).lexically_normal();
  for (const std::string& name : names) {
    const fs::path path = fs::absolute(path_in(folder, name)).lexically_normal();
    const fs::path inside = path.lexically_relative(root);
    if (!inside.empty() && *inside.begin() != "..") continue;
    throw InputError({file, "output", name + ", outside of the folder " + folder,
                      "a name in the folder, or --allow-outside"});
  }
}

}  // namespace supple::tools
