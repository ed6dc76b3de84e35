// Pictures by VTK's ray caster (vtkFixedPointVolumeRayCastMapper), to set beside those of Supple:
// it draws the resampled volume, since it knows no offsets. Debian has it in python3-vtk9, and the
// screen that it needs in xvfb.
#pragma once

#include "raycast/pictures/image.h"
#include "tools/scene/run/view_pictures.h"
#include "volumes/base/progress.h"

namespace supple::tools {

/// Throws InputError for what VTK would not draw as the view asks.
void check_vtk_view(const SceneView& view);

/// An effective view. Gradients count in full for shading (full_shading_gradient is not known to
/// VTK). Throws InputError where VTK is not installed, Error where it fails, Cancelled.
FloatImage draw_by_vtk(const PosedVolume& subject, const SceneView& view, Progress& progress);

}  // namespace supple::tools
