// A picture in one call, for those who do not keep a Renderer: a state or volume from a named side
// under a named preset.
#pragma once

#include <string>

#include "lib/state/pose.h"
#include "raycast/pictures/image.h"
#include "raycast/render.h"

namespace supple {

struct Look {
  std::string preset = "Bone";                                           // a name of presets.h
  std::string view = "anterior";                                         // a name of view_names()
  int width = RenderSettings().width, height = RenderSettings().height;  // pixels
  Quality quality = Quality::standard;
};

/// The state in its pose; at rest where `pose` is null. Throws InputError for an unknown name or a
/// bad size, Cancelled.
Image show(const State& state, const Pose* pose, const Look& look = {},
           Progress* progress = nullptr);

}  // namespace supple
