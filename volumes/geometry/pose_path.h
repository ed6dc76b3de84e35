// The path of something that is scaled, turned and shifted from pose to pose.
#pragma once

#include <optional>

#include "volumes/geometry/geometry.h"
#include "volumes/geometry/keyframes.h"

namespace supple {

struct PathPose {
  Vec3d shift_mm{0, 0, 0};
  Vec3d axis{0, 0, 1};
  double angle_deg = 0;  // about the axis, right-handed
  Vec3d scale{1, 1, 1};
};

/// Shift, turn and scale have keys of their own. Turns about one axis, either way along it, are
/// interpolated by their angle and may go round more than once; those about several by the shortest
/// arc.
class PosePath {
 public:
  /// Adds a key of the shift; times ascend.
  void add_shift(double time, const Vec3d& shift_mm, Easing easing) {
    m_shift.add(time, shift_mm, easing);
  }
  void add_turn(double time, const Vec3d& axis, double angle_deg, Easing easing);
  void add_scale(double time, const Vec3d& scale, Easing easing) {
    m_scale.add(time, scale, easing);
  }

  PathPose at(double time) const;

 private:
  Track<Vec3d> m_shift, m_scale;
  Track<double> m_angle_deg;  // about m_axis
  Track<Turn> m_turn;
  std::optional<Vec3d> m_axis;
  bool m_has_axes = false;  // more than one
};

}  // namespace supple
