// Single pictures of views by a renderer that is kept between them.
#pragma once

#include <string>

#include "raycast/progressive.h"
#include "tools/scene/run/view_pictures.h"

namespace supple::tools {

/// A renderer that shows the subject of a view in its pose, and its last pictures.
struct KeptRenderer {
  Renderer& renderer;
  FollowedPictures& followed;
};

/// A picture, and the record in a file of it.
struct SinglePicture {
  FloatImage picture;
  std::string configuration;
};

/// The picture of an effective view that is no series, as draw_view() files it. `kept`: of a view
/// that is marched; null: a renderer is made where one is needed. Throws as draw_view().
SinglePicture draw_single(const PosedVolume& subject, const SceneView& view,
                          const KeptRenderer* kept, RenderReport* report, Progress& progress);

/// True if a view shows meshes, arrows or labels as surfaces.
bool has_surfaces(const SceneView& view);
/// Moves these surfaces of a renderer to where the subject is.
void pose_surfaces(Renderer& renderer, const PosedVolume& subject, const SceneView& view);
/// One picture as draw() makes it, which follows the last one where it may; `followed` null: none.
FloatImage draw_following(const PosedVolume& subject, const Renderer* renderer,
                          const SceneView& view, FollowedPictures* followed, RenderReport* report,
                          Progress& progress);

}  // namespace supple::tools
