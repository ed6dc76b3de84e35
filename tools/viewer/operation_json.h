// An operation as pages see it (docs/live.md, "Operations").
#pragma once

#include "tools/scene/operation/live_operation.h"
#include "tools/scene/operation/operation_loop.h"
#include "volumes/base/value.h"

namespace supple::tools {

/// What stays the same while it goes on.
Value operation_json(const LiveOperation& live);
/// What changes, but for the times of loop and pictures.
Value operation_status(const LiveOperation& live);
Value events_json(const std::vector<OperationEvent>& events);

}  // namespace supple::tools
