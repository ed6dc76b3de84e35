// The settings of a picture as its file keeps them.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "tools/scene/file/view.h"

namespace supple::tools {

/// Effective configuration of a picture, embedded in its file; `more` is an object with further
/// facts.
std::string describe_view(const SceneView& view, const nlohmann::ordered_json& more);

}  // namespace supple::tools
