// Cameras moved so that given points fill the picture. The points are those of the things to be
// seen: the volume's box, the elements of a body, or the visible parts of a picture.
#pragma once

#include <vector>

#include "raycast/scene/camera.h"

namespace supple {

/// How a framed camera is going to move.
enum class CameraMotion { still, turntable };

/// Free margins at the sides of a framed picture, as parts of its width and height.
struct FramingMargins {
  double left = kFramingMargin, right = kFramingMargin;
  double top = kFramingMargin, bottom = kFramingMargin;
};

/// The camera with its direction, upwards and angle kept, moved to where every point is seen as
/// large as fits between the margins; `aspect` is width by height. In perspective this is the
/// nearest such place, an exact solution of the four half-planes that each point gives. The target
/// is the middle of the points' depths, on the central ray. For a turntable the target lies on the
/// patient's axis through the middle of the points, and every point is seen all the way round,
/// between the wider margins of each pair. Without points the camera as it is. Cost: one pass, or
/// 24 of a turntable.
Camera framed(const Camera& camera, double aspect, const std::vector<Vec3d>& points_lps_mm,
              CameraMotion motion = CameraMotion::still, const FramingMargins& margins = {});

/// The camera moved about the patient's axis through its target, by `share` of a full turn; from
/// above against the clock.
Camera turned_about_target(const Camera& camera, double share);

}  // namespace supple
