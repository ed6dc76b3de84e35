#include "volumes/geometry/pose_path.h"

namespace supple {

namespace {

/// Sine of the angle below which two axes are one.
constexpr double kSameAxis = 1e-9;

}  // namespace

void PosePath::add_turn(double time, const Vec3d& axis, double angle_deg, Easing easing) {
  const Vec3d unit = axis.normalized();
  if (!m_axis) m_axis = unit;
  m_has_axes = m_has_axes || m_axis->cross(unit).length() > kSameAxis;
  m_angle_deg.add(time, m_axis->dot(unit) < 0 ? -angle_deg : angle_deg, easing);
  m_turn.add(time, turn_about(unit, angle_deg), easing);
}

PathPose PosePath::at(double time) const {
  PathPose pose;
  if (!m_shift.empty()) pose.shift_mm = m_shift.at(time);
  if (!m_scale.empty()) pose.scale = m_scale.at(time);
  if (!m_axis) return pose;
  if (m_has_axes) {
    const Turn turn = m_turn.at(time);
    pose.axis = turn.axis();
    pose.angle_deg = turn.angle_deg();
  } else {
    pose.axis = *m_axis;
    pose.angle_deg = m_angle_deg.at(time);
  }
  return pose;
}

}  // namespace supple
