#include "tools/scene/file/scene_output.h"

namespace supple::tools {

std::vector<std::string> SceneOutput::all() const {
  std::vector<std::string> names;
  if (!state.empty()) names.push_back(state);
  for (const auto* list : {&offsets, &displacements, &volumes}) {
    names.insert(names.end(), list->begin(), list->end());
  }
  for (const ElementOutput& output : elements) names.push_back(output.path);
  for (const std::string* table : {&forces, &motion}) {
    if (!table->empty()) names.push_back(*table);
  }
  return names;
}

SceneOutput read_output(Table& table) {
  SceneOutput output;
  output.state = table.string("state").value_or("");
  output.refers = table.boolean("refer").value_or(false);
  output.offsets = table.strings("offsets").value_or(std::vector<std::string>{});
  output.displacements = table.strings("displacements").value_or(std::vector<std::string>{});
  output.volumes = table.strings("volumes").value_or(std::vector<std::string>{});
  output.forces = table.string("forces").value_or("");
  output.motion = table.string("motion").value_or("");
  if (auto elements = table.table("elements")) {
    for (const auto& [quantity, name] : kFemQuantities) {
      if (const auto path = elements->string(std::string(name))) {
        output.elements.push_back({quantity, *path, table.full_name("elements")});
      }
    }
    elements->finish();
  }
  if (output.refers && output.state.empty()) table.fail("refer", "no state", "state beside it");
  table.finish();
  return output;
}

}  // namespace supple::tools
