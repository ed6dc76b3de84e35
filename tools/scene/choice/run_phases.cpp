#include "tools/scene/choice/run_phases.h"

#include "tools/scene/run/scene_run.h"

namespace supple::tools {

namespace {

bool begins_with(const std::string& name, const char* words) {
  return name.rfind(words, 0) == 0;
}

}  // namespace

RunPhases phases_of(const std::vector<std::pair<std::string, double>>& stages) {
  RunPhases phases;
  for (const auto& [name, seconds] : stages) {
    if (begins_with(name, "reading") || name == "building the body" || name == "labels" ||
        begins_with(name, "starting ")) {
      phases.prepare_s += seconds;
    } else if (name == kDisplacementStage || name == "inverting" || name == "sampling paths") {
      phases.invert_s += seconds;
    } else if (name == "rendering") {
      phases.render_s += seconds;
    } else if (!begins_with(name, "writing") && name != "offsets" && name != "compressing" &&
               name != "forces on handles") {
      phases.solve_s += seconds;  // models have stages of their own
    }
  }
  return phases;
}

}  // namespace supple::tools
