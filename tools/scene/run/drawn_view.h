// A view of a scene as it is drawn after a step.
#pragma once

#include "tools/scene/run/scene_run.h"
#include "tools/scene/run/view_pictures.h"

namespace supple::tools {

/// The effective view with its subject.
struct SceneRun::Drawn {
  SceneView view;
  PosedVolume subject;
};

}  // namespace supple::tools
