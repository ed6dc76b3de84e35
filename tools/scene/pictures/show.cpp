#include "tools/scene/pictures/show.h"

#include "raycast/scene/presets.h"

namespace supple {

Image show(const State& state, const Pose* pose, const Look& look, Progress* progress) {
  RenderSettings settings;
  settings.width = look.width;
  settings.height = look.height;
  settings.set_quality(look.quality);
  settings.validate();
  Renderer renderer(state.geometry, state.density);
  if (pose != nullptr) renderer.set_offsets(&pose->offsets);
  const Camera camera = default_camera(state.geometry, double(look.width) / look.height, look.view);
  return renderer.render(camera, preset(look.preset), settings, nullptr, progress);
}

}  // namespace supple
