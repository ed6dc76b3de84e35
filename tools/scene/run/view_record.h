// The settings of a picture as its file keeps them.
#pragma once

#include <string>

#include "tools/scene/file/view.h"
#include "volumes/base/value.h"

namespace supple::tools {

/// Effective configuration of a picture, embedded in its file; `more` is an object with further
/// facts.
std::string describe_view(const SceneView& view, const Value& more);

}  // namespace supple::tools
