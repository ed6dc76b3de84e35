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
  Vec3d operator()(const Vec3d& x) const { return x + way_of(x); }
  /// Way from x to where it goes; exactly 0 without a turn.
  Vec3d way_of(const Vec3d& x) const;
  bool operator==(const Turn& other) const { return w == other.w && v == other.v; }
  bool turns() const { return v != Vec3d(0); }
  double squared_length() const { return w * w + v.dot(v); }
  /// The same turn as a quaternion of length 1 with w >= 0.
  Turn unit() const;
  /// Angle of the turn, 0 to 180 degrees, and its axis, of unit length.
  double angle_deg() const;
  Vec3d axis() const;
};

/// A right-handed turn about an axis of any length but 0.
Turn turn_about(const Vec3d& axis, double angle_deg);
/// The turn that takes x, y and z to three perpendicular unit vectors, right-handed.
Turn turn_to(const std::array<Vec3d, 3>& axes);

/// A turn on the shortest arc, at an even speed (slerp); beyond 0 and 1 it goes on.
Turn between(const Turn& a, const Turn& b, double s);

}  // namespace supple
