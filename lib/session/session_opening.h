// The body of a session from a file: a volume at rest, or a state that is continued.
#pragma once

#include <string>

#include "lib/session/session.h"
#include "lib/session/session_body.h"

namespace supple {

/// Reads the file, chooses the material and builds the body with its pieces and anchors. Warns as
/// Session's constructor does, and throws as it.
void open(SessionBody& in, const std::string& path, const SessionOptions& options,
          Progress* progress);

}  // namespace supple
