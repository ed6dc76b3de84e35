// Record of the file that a live session was opened from.
#pragma once

#include "tools/scene/live/live_session.h"
#include "volumes/base/value.h"

namespace supple::tools {

/// Keys of a file or a part of it with absolute paths of the inputs that have been read, so that
/// they mean the same in any folder.
Value with_absolute_paths(Value keys, const Table& read);

}  // namespace supple::tools
