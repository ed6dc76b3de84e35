// Perspective and orthographic cameras in the world frame (LPS, mm; design.md section 5). Since
// the frame is the patient's and not the grid's, left-handed index frames give right-handed
// pictures: seen from anterior, the patient's left is on the picture's right.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "volumes/geometry/geometry.h"
#include "volumes/geometry/keyframes.h"

namespace supple {

/// Margin on each side of a framed picture, as a part of its size.
constexpr double kFramingMargin = 0.05;

enum class Projection { perspective, orthographic };

struct Camera {
  Projection projection = Projection::perspective;
  Vec3d position_lps_mm{0, -1000, 0};
  Vec3d target_lps_mm{0, 0, 0};
  Vec3d up_lps{0, 0, 1};
  double vertical_fov_degrees = 30;  // perspective
  double height_mm = 300;            // orthographic: world height of the picture
  /// The window moved to the right, in half heights of the picture: an off-axis camera of a stereo
  /// pair.
  double window_shift = 0;

  /// Throws InputError: not finite, position at target, up along the view, fov outside (0, 180),
  /// height not positive.
  void validate(const std::string& file) const;
};

struct Ray {
  Vec3d origin_lps_mm;
  Vec3d direction_lps;  // unit
};

/// Orthonormal axes of the picture; `right` and `up` follow columns and rows (upwards).
struct CameraFrame {
  Vec3d right, up, forward;
};
CameraFrame camera_frame(const Camera& camera);

/// Half the height of a perspective picture at a distance of 1 along the view.
double half_height_at_unit_distance(const Camera& camera);

/// The camera magnified about the middle of its picture by `factor` > 0: a narrower angle or less
/// height, from the same place.
Camera zoomed(const Camera& camera, double factor);

/// The rays of one picture, from its pixels and back.
class CameraRays {
 public:
  CameraRays(const Camera& camera, int width, int height);
  /// Ray through pixel coordinates (px, py), centres at +0.5, row 0 at the top. Orthographic rays
  /// start on the plane through the camera's position; places behind it are not seen.
  Ray at(double px, double py) const;
  /// World position to pixel coordinates; false when behind the camera.
  bool pixel_of(const Vec3d& world_mm, double& px, double& py) const;

 private:
  Camera m_camera;
  CameraFrame m_frame;
  double m_half_height;      // of the picture: mm, or of a perspective one at unit distance
  double m_width, m_height;  // pixels
};

/// LPS mm as row vectors with a 1 behind to the camera's own coordinates, right, up and forward in
/// mm, and to the picture, (0, 0) at its upper left and (1, 1) at its lower right corner, as
/// OpenEXR has it (worldToCamera, worldToNDC). 16 numbers each, row by row.
std::vector<std::array<double, 16>> camera_matrices(const Camera& camera, int width, int height);

/// One ray of CameraRays.
Ray camera_ray(const Camera& camera, int width, int height, double px, double py);

/// One place of CameraRays.
bool project_to_pixel(const Camera& camera, int width, int height, const Vec3d& world_mm,
                      double& px, double& py);

/// Named view directions: "anterior" (default), "posterior", "left", "right", "superior",
/// "inferior"; superior up (superior and inferior views: anterior up). Frames the source box of
/// `geometry` with a margin of 5 % of the picture on each side. Throws InputError for another name.
Camera default_camera(const Geometry& geometry, double aspect, const std::string& view = "anterior",
                      Projection projection = Projection::perspective,
                      double vertical_fov_degrees = Camera().vertical_fov_degrees);

/// The outer corners of the volume's box, half a voxel beyond the outermost centres.
std::vector<Vec3d> box_corners_lps_mm(const Geometry& geometry);

/// The names that default_camera knows.
std::vector<std::string> view_names();

// A camera that moves from key to key.

/// Place, angle, turn and magnification have keys of their own; those without keys stay as in the
/// camera that the path starts from. Between two places the target goes straight, and the eye
/// around it: the picture's axes turn by the shortest arc, and the distance changes by the same
/// factor in the same time. Angle and height change evenly, the magnification by factors.
class CameraPath {
 public:
  /// Adds a key of eye, target and upwards. Times of the keys of one kind ascend.
  void add_place(double time, const Camera& camera, Easing easing);
  void add_fov(double time, double degrees, Easing easing) { m_fov.add(time, degrees, easing); }
  void add_height(double time, double mm, Easing easing) { m_height.add(time, mm, easing); }
  /// Adds a turn about the patient's axis through the target, as turned_about_target().
  void add_turn(double time, double degrees, Easing easing) { m_turn.add(time, degrees, easing); }
  void add_zoom(double time, double factor, Easing easing);

  bool turns() const { return !m_turn.empty(); }
  Camera at(const Camera& start, double time) const;

 private:
  Track<Vec3d> m_target;
  Track<Turn> m_axes;  // right, up and towards the viewer
  Track<double> m_log_distance, m_fov, m_height, m_turn, m_log_zoom;
};

}  // namespace supple
