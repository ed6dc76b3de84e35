// Parts that a continued state has held, fixed and cut, as its file records them.
#pragma once

#include <optional>
#include <vector>

#include "lib/session/cut_surface.h"
#include "lib/state/state.h"
#include "volumes/base/value.h"

namespace supple::tools {

/// Keys as events have them. Anchors hold and cuts are open; handles, each once, say where the
/// tissue was led by, but nothing holds it there any more.
struct StateParts {
  struct Cut {
    Value keys;
    std::optional<CutSurface> surface;  // of a patch or a curve
  };
  std::vector<Value> handles, anchors;
  std::vector<Cut> cuts;
};
/// A record of another form than this program writes gives no handles and cuts.
StateParts parts_of(const State& state);

}  // namespace supple::tools
