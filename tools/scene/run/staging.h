// Staging of a picture in space: a camera that its subject fills, the background, and annotations.
#pragma once

#include "raycast/scene/framing.h"
#include "tools/scene/run/view_pictures.h"

namespace supple::tools {

/// Margins that the annotations of a view need beside its subject.
FramingMargins framing_margins(const SceneView& view);

/// The camera of an effective view, fitted and zoomed as it asks for. `renderer` shows the subject;
/// null for a lattice. The visible part is found in small pictures: where their opacity is at least
/// a tenth; inside of the volume's box, or of the camera's picture where the view names a place.
Camera framed_camera(const PosedVolume& subject, const Renderer* renderer, const SceneView& view,
                     Progress& progress);

/// Puts the background behind a picture of an effective view and writes its annotations over it.
void decorate(FloatImage& picture, const PosedVolume& subject, const SceneView& view);

}  // namespace supple::tools
