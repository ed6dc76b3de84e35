// Perspective and orthographic cameras in the world frame (LPS, mm).
#pragma once

#include <string>

#include "volumes/geometry/geometry.h"

namespace supple {

enum class Projection { perspective, orthographic };

struct Camera {
  Projection projection = Projection::perspective;
  Vec3d position_lps_mm{0, -1000, 0};
  Vec3d target_lps_mm{0, 0, 0};
  Vec3d up_lps{0, 0, 1};
  double vertical_fov_degrees = 30;  // perspective
  double height_mm = 300;            // orthographic: world height of the picture

  /// Throws InputError: not finite, position at target, up along the view, fov outside (0, 180).
  void validate(const std::string& file) const;
};

struct Ray {
  Vec3d origin_lps_mm;
  Vec3d direction_lps;  // unit
};

/// Ray through pixel coordinates (px, py), centres at +0.5, row 0 at the top.
Ray camera_ray(const Camera& camera, int width, int height, double px, double py);

/// World position to pixel coordinates; false when behind the camera.
bool project_to_pixel(const Camera& camera, int width, int height, const Vec3d& world_mm,
                      double& px, double& py);

/// Named view directions: "anterior" (default), "posterior", "left", "right", "superior",
/// "inferior"; superior up (superior and inferior views: anterior up). Frames the source box of
/// `geometry` with a 5 % margin. Throws InputError for another name.
Camera default_camera(const Geometry& geometry, double aspect,
                      const std::string& view = "anterior",
                      Projection projection = Projection::perspective);

}  // namespace supple
