// The marks of a view in space: arrows and surfaces of labels among the meshes of the picture, the
// grid on its tissue.
#pragma once

#include "raycast/drawings/annotations.h"
#include "tools/scene/run/view_pictures.h"

namespace supple::tools {

/// Adds mesh bodies as they are now to an effective view of a volume, where it shows them.
void add_mesh_bodies(const std::vector<DeformableMesh>& meshes, const Geometry& geometry,
                     SceneView& view);

/// All surfaces that a view shows with the subject in its pose: its meshes, arrows up to
/// `view.picture.offset_max_mm`, which is known, and labels. Throws InputError for marks that the
/// subject has no data for.
std::vector<Surface> surfaces_of(const PosedVolume& subject, const SceneView& view);

/// Finds where tissue that is seen at a place was at rest, also where samples solve for themselves.
/// Refers to the subject's data.
RestPlaceAt rest_place_of(const PosedVolume& subject);

/// Draws the grid on a picture with depths and normals, where no mesh is before the tissue.
void draw_grid(FloatImage& picture, const PosedVolume& subject, const SceneView& view,
               const Camera& camera);

/// The legend of the arrows' colours, the second of so many.
void add_arrow_legend(Annotations& annotations, const SceneView& view, int count);

}  // namespace supple::tools
