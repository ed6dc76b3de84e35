// A camera that moves from key to key.
#pragma once

#include "raycast/scene/camera.h"
#include "volumes/geometry/keyframes.h"
#include "volumes/geometry/turn.h"

namespace supple {

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
