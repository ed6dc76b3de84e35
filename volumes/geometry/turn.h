// Turns in space as unit quaternions.
#pragma once

#include <array>

#include "volumes/base/vec.h"

namespace supple {

struct Turn {
  double w = 1;  // cosine of half the angle
  Vec3d v{0, 0, 0};

  Turn operator*(const Turn& first) const;  // `first`, then this
  Turn inverse() const { return {w, -v}; }
  Vec3d operator()(const Vec3d& x) const;
  /// 0 to 180 degrees, about an axis of unit length.
  double angle_deg() const;
  Vec3d axis() const;
};

/// Right-handed; an axis of any length but 0.
Turn turn_about(const Vec3d& axis, double angle_deg);
/// The turn that takes x, y and z to three perpendicular unit vectors, right-handed.
Turn turn_to(const std::array<Vec3d, 3>& axes);

/// Along the shortest arc, at an even speed (slerp); beyond 0 and 1 it goes on.
Turn between(const Turn& a, const Turn& b, double s);

}  // namespace supple
