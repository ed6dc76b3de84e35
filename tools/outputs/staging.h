// How a picture in space is staged: from where it is taken so that what matters fills it, what is
// behind it, and what is written over it.
#pragma once

#include "raycast/scene/framing.h"
#include "tools/outputs/view_pictures.h"

namespace supple::tools {

/// What annotations of a view need beside its subject.
FramingMargins framing_margins(const SceneView& view);

/// The camera of an effective view, fitted and zoomed as it asks for. `renderer` shows the subject;
/// null for a lattice. What is visible is found in small pictures: where their opacity is at least
/// a tenth; inside of the volume's box, or of the camera's picture where the view names a place.
Camera framed_camera(const PosedVolume& subject, const Renderer* renderer, const SceneView& view,
                     Console& console);

/// Puts the background behind a picture of an effective view and writes its annotations over it.
void decorate(FloatImage& picture, const PosedVolume& subject, const SceneView& view);

}  // namespace supple::tools
