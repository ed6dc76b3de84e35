#include "tools/scene/file/draw_method.h"

namespace supple::tools {

namespace {

void with_inverse(SceneView&) {}
void with_half_offsets(SceneView& view) {
  view.half_offsets = true;
}
void with_newton(SceneView& view) {
  view.inverse = false;
}
void with_cubic(SceneView& view) {
  view.sampling.interpolation = Interpolation::cubic;
}
void with_pre_integration(SceneView& view) {
  view.sampling.classification = Classification::pre_integrated;
}

void by_vtk(SceneView& view) {
  view.caster = Caster::vtk;
}

}  // namespace

const std::vector<DrawFamily>& draw_families() {
  static const char* const knob = "step in voxels";
  static const std::vector<double> steps = {4, 2, 1, 0.5, 0.25};
  static const std::vector<DrawFamily> families = {
      {{"draw", "inverse", knob, 0.01, 16, false, steps}, with_inverse},
      {{"draw-half", "inverse, half offsets", knob, 0.01, 16, false, steps}, with_half_offsets},
      {{"draw-preint", "inverse, pre-integrated", knob, 0.01, 16, false, steps},
       with_pre_integration},
      {{"draw-cubic", "inverse, cubic", knob, 0.01, 16, false, steps}, with_cubic},
      {{"draw-newton", "no inverse", knob, 0.01, 16, false, {4, 2, 1, 0.5, 0.25, 0.1}},
       with_newton},
      {{"draw-vtk", "VTK, resampled", knob, 0.01, 16, false, steps}, by_vtk},
  };
  return families;
}

DrawMethod parse_drawing(const std::string& text) {
  return parse_setting(text, draw_families(), "drawing");
}

bool is_drawn_by_rays(const SceneView& view) {
  return !view.slice && !view.lattice;
}

void draw_by(Scene& scene, const DrawMethod& method) {
  for (SceneView& view : scene.views) {
    if (!is_drawn_by_rays(view)) continue;
    view.inverse = true;
    view.half_offsets = false;
    view.caster = Caster::supple;
    view.sampling = Sampling();
    view.sampling.step_voxels = method.knob;
    method.family->draw(view);
  }
}

}  // namespace supple::tools
