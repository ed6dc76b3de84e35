// Reports of commands as JSON.
#pragma once

#include <vector>

#include "lib/session/session.h"
#include "lib/state/pose.h"
#include "raycast/render.h"
#include "volumes/base/value.h"

namespace supple::tools {

Value to_value(const BallReport& report, std::int64_t cut_links);
/// Reports name, elements, turn and shift of each piece.
Value to_value(const RigidPieces& pieces);
Value to_value(const StepRecord& record);
Value to_value(const std::vector<HandlePlace>& places);
Value to_value(const RenderReport& report);

}  // namespace supple::tools
