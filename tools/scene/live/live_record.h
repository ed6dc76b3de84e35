// What a live session writes down of the file that it was opened from.
#pragma once

#include <nlohmann/json.hpp>

#include "tools/scene/live/live_session.h"

namespace supple::tools {

/// JSON of a file or a part of it, with absolute paths of the inputs that have been read, so that
/// it means the same in any folder.
nlohmann::ordered_json with_absolute_paths(const std::string& json, const Table& read);

}  // namespace supple::tools
