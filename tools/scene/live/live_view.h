// Choice of the view of a scene that a live session shows.
#pragma once

#include "tools/scene/file/scene.h"

namespace supple::tools {

/// The first view of the volume in space that shows the body as the steps leave it, or else the
/// first in space; null where there is none.
const SceneView* shown_view(const Scene& scene);

}  // namespace supple::tools
