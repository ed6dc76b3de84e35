// What a state that is continued has held, fixed and cut, as its file records it.
#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "volumes/state/state.h"

namespace supple::tools {

/// Keys as events have them. Anchors hold and cuts are open; handles, each once, say where the
/// tissue was led by, but nothing holds it there any more.
struct StateParts {
  std::vector<nlohmann::ordered_json> handles, anchors, cuts;
};
StateParts parts_of(const State& state);

}  // namespace supple::tools
