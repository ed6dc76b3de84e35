#include "tools/scene/choice/run_phases.h"

#include <map>

#include "lib/session/hand/hand_level.h"
#include "tools/scene/run/scene_run.h"

namespace supple::tools {

namespace {

using Sum = double RunPhases::*;

/// Stages that do not solve; models have others of their own.
const std::map<std::string, Sum>& other_stages() {
  static const std::map<std::string, Sum> table = {
      {"reading", &RunPhases::prepare_s},           {"reading state", &RunPhases::prepare_s},
      {"building the body", &RunPhases::prepare_s}, {"labels", &RunPhases::prepare_s},
      {kSolidAheadStage, &RunPhases::prepare_s},    {"starting VTK", &RunPhases::prepare_s},
      {"starting DOLFINx", &RunPhases::prepare_s},  {kDisplacementStage, &RunPhases::invert_s},
      {"inverting", &RunPhases::invert_s},          {"sampling paths", &RunPhases::invert_s},
      {"rendering", &RunPhases::render_s},          {"offsets", &RunPhases::other_s},
      {"forces on handles", &RunPhases::other_s},   {"writing", &RunPhases::other_s},
      {"writing state", &RunPhases::other_s},       {"compressing", &RunPhases::other_s}};
  return table;
}

}  // namespace

RunPhases phases_of(const std::vector<std::pair<std::string, double>>& stages) {
  RunPhases phases;
  for (const auto& [name, seconds] : stages) {
    const auto found = other_stages().find(name);
    phases.*(found == other_stages().end() ? &RunPhases::solve_s : found->second) += seconds;
  }
  return phases;
}

}  // namespace supple::tools
