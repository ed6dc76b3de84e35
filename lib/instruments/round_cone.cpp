#include "lib/instruments/round_cone.h"

#include <algorithm>
#include <cmath>

namespace supple {

namespace {

constexpr double kMetMm = 1e-4;
constexpr int kMaxAdvances = 1000;  // of one touch; tangential ways need the most

/// A unit vector perpendicular to a direction.
Vec3d across(const Vec3d& direction) {
  int least = 0;
  for (int c = 1; c < 3; ++c) {
    if (std::abs(direction[c]) < std::abs(direction[least])) least = c;
  }
  Vec3d world(0.0);
  world[least] = 1;
  const Vec3d side = direction.cross(world);
  const double length = side.length();
  return length > 0 ? side / length : Vec3d(1, 0, 0);
}

}  // namespace

double nearest_part(const Vec3d& point_mm, const RoundCone& cone) {
  // The distance to the ball at x along the axis is sqrt(off² + (along - x)²) - radius(x), convex
  // in x; it is least where along - x = slope sqrt(off² + (along - x)²).
  const Vec3d axis = cone.b_mm - cone.a_mm;
  const double length = axis.length();
  const double narrowing = cone.a_radius_mm - cone.b_radius_mm;
  if (!(length > std::abs(narrowing))) return narrowing < 0 ? 1 : 0;  // one ball holds the other
  const Vec3d from = point_mm - cone.a_mm;
  const double along = from.dot(axis) / length;
  const double off = (from - axis * (along / length)).length();
  const double slope = narrowing / length;
  const double x = along - off * slope / std::sqrt(1 - slope * slope);
  return std::clamp(x / length, 0.0, 1.0);
}

Approach approach(const Vec3d& point_mm, const RoundCone& cone) {
  const double part = nearest_part(point_mm, cone);
  const Vec3d centre = cone.a_mm + (cone.b_mm - cone.a_mm) * part;
  const double radius = cone.a_radius_mm + (cone.b_radius_mm - cone.a_radius_mm) * part;
  const Vec3d from = point_mm - centre;
  const double length = from.length();
  const Vec3d normal = length > 1e-300 ? from / length : across(cone.b_mm - cone.a_mm);
  return {length - radius, centre + normal * radius, normal};
}

RoundCone between(const RoundCone& from, const RoundCone& to, double part) {
  return {from.a_mm + (to.a_mm - from.a_mm) * part, from.b_mm + (to.b_mm - from.b_mm) * part,
          from.a_radius_mm + (to.a_radius_mm - from.a_radius_mm) * part,
          from.b_radius_mm + (to.b_radius_mm - from.b_radius_mm) * part};
}

std::optional<double> first_touch(const Vec3d& point_from_mm, const Vec3d& point_to_mm,
                                  const RoundCone& from, const RoundCone& to, double gap_mm) {
  const Vec3d way = point_to_mm - point_from_mm;
  const double fastest =
      std::max((to.a_mm - from.a_mm - way).length() + std::abs(to.a_radius_mm - from.a_radius_mm),
               (to.b_mm - from.b_mm - way).length() + std::abs(to.b_radius_mm - from.b_radius_mm));
  double part = 0;
  for (int n = 0; n < kMaxAdvances; ++n) {
    const double room =
        approach(point_from_mm + way * part, between(from, to, part)).distance_mm - gap_mm;
    if (room < kMetMm) return part;
    if (room >= (1 - part) * fastest) return std::nullopt;
    part += room / fastest;
  }
  return part;
}

}  // namespace supple
