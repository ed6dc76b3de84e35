// The stages of a run as phases: what prepares, solves, inverts and renders.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace supple::tools {

struct RunPhases {
  double prepare_s = 0, solve_s = 0, invert_s = 0, render_s = 0;
  double other_s = 0;  // writing, and the forces that only a report tells
};

/// Seconds of each stage by name, as Console::stage_seconds() and `stage_seconds` of `supple run
/// --json` give them.
RunPhases phases_of(const std::vector<std::pair<std::string, double>>& stages);

}  // namespace supple::tools
