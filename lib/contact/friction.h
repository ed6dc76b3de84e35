// Coulomb's friction of nodes that a surface has pushed; collider_contact.h says why it is his law.
#pragma once

#include <algorithm>

#include "volumes/base/vec.h"

namespace supple {

/// The slip along a surface that friction takes back of a motion: all of it, up to mu times the
/// depth from which the surface has pushed.
inline Vec3d slip_taken_back(double friction, const Vec3d& normal, double depth_mm,
                             const Vec3d& moved_mm) {
  const Vec3d slip = moved_mm - normal * normal.dot(moved_mm);
  const double length = slip.length();
  if (length == 0) return Vec3d(0.0);
  return slip * std::min(1.0, friction * depth_mm / length);
}

}  // namespace supple
