#include "raycast/scene/camera_path.h"

#include <cmath>

#include "raycast/scene/framing.h"

namespace supple {

void CameraPath::add_place(double time, const Camera& camera, Easing easing) {
  const CameraFrame frame = camera_frame(camera);
  m_target.add(time, camera.target_lps_mm, easing);
  m_axes.add(time, turn_to({frame.right, frame.up, -frame.forward}), easing);
  const double distance = (camera.position_lps_mm - camera.target_lps_mm).length();
  m_log_distance.add(time, std::log(distance), easing);
}

void CameraPath::add_zoom(double time, double factor, Easing easing) {
  m_log_zoom.add(time, std::log(factor), easing);
}

Camera CameraPath::at(const Camera& start, double time) const {
  Camera camera = start;
  if (!m_target.empty()) {
    const Turn axes = m_axes.at(time);
    camera.target_lps_mm = m_target.at(time);
    camera.position_lps_mm =
        camera.target_lps_mm + axes({0, 0, 1}) * std::exp(m_log_distance.at(time));
    camera.up_lps = axes({0, 1, 0});
  }
  if (!m_fov.empty()) camera.vertical_fov_degrees = m_fov.at(time);
  if (!m_height.empty()) camera.height_mm = m_height.at(time);
  if (!m_log_zoom.empty()) camera = zoomed(camera, std::exp(m_log_zoom.at(time)));
  return m_turn.empty() ? camera : turned_about_target(camera, m_turn.at(time) / 360);
}

}  // namespace supple
