// Method by which the views of a scene are drawn, in place of their own: "draw-newton:0.5" solves
// for the source of every sample, half a voxel apart. Everything else of the views stays.
#pragma once

#include "lib/model/knob_family.h"
#include "tools/scene/file/scene.h"

namespace supple::tools {

struct DrawFamily : KnobFamily {
  void (*draw)(SceneView& view);  // what it is beside its step
};
using DrawMethod = KnobSetting<DrawFamily>;

/// All of them, in the order of charts. The knob is the distance of samples in voxels.
const std::vector<DrawFamily>& draw_families();

/// Throws InputError as parse_knob.
DrawMethod parse_drawing(const std::string& text);

/// True if a view is drawn by rays, so that the method matters.
bool is_drawn_by_rays(const SceneView& view);

void draw_by(Scene& scene, const DrawMethod& method);

}  // namespace supple::tools
