// Round cones: the shape of which instruments are made, and how near points come to it.
#pragma once

#include <optional>

#include "volumes/base/vec.h"

namespace supple {

/// Balls around all points of a segment; their radius changes evenly from one end to the other.
struct RoundCone {
  Vec3d a_mm, b_mm;
  double a_radius_mm, b_radius_mm;
};

/// Distance to a surface, negative behind it; the point of the surface that is nearest, and the
/// unit normal there into free space.
struct Approach {
  double distance_mm;
  Vec3d place_mm, normal;
};

/// Finds how near a point is to a round cone, exactly, inside too; some 10 ns.
Approach approach(const Vec3d& point_mm, const RoundCone& cone);

/// Part of the axis, 0 at a to 1 at b, whose ball is nearest to a point (or deepest around it).
double nearest_part(const Vec3d& point_mm, const RoundCone& cone);

/// A round cone in motion, at a part of the step: ends go straight, radii change evenly.
RoundCone between(const RoundCone& from, const RoundCone& to, double part);

/// First part of a step, 0 to 1, at which a point that goes straight comes within `gap_mm` of a
/// round cone in motion, so that neither passes the other; none where it stays clear.
/// Conservative advancement: never late, and early by less than 1e-4 mm.
std::optional<double> first_touch(const Vec3d& point_from_mm, const Vec3d& point_to_mm,
                                  const RoundCone& from, const RoundCone& to, double gap_mm = 0);

}  // namespace supple
