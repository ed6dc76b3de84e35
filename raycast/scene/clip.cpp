#include "raycast/scene/clip.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "volumes/base/error.h"

namespace supple {

void Clip::validate(const std::string& file) const {
  if (region.empty()) throw InputError({file, "clip", "no half-space", "at least one"});
  for (const HalfSpace& half : region) {
    if (!is_finite(half.point_lps_mm)) {
      throw InputError({file, "clip", "a point that is not finite", "finite numbers"});
    }
    if (!is_finite(half.normal_lps) || half.normal_lps == Vec3d(0)) {
      throw InputError(
          {file, "clip", "a normal without direction", "a finite vector that is not 0"});
    }
  }
}

std::vector<HalfSpace> box_region(const Geometry& geometry, const Vec3d& corner,
                                  const Vec3d& opposite) {
  std::vector<HalfSpace> region;
  for (int axis = 0; axis < 3; ++axis) {
    // The gradient of the index coordinate is the normal of its slices, oblique or not.
    Vec3d gradient(0);
    gradient[axis] = 1;
    const Vec3d normal = geometry.world_gradient_from_index(gradient);
    Vec3d lo = corner, hi = corner;
    lo[axis] = std::min(corner[axis], opposite[axis]);
    hi[axis] = std::max(corner[axis], opposite[axis]);
    region.push_back({geometry.world_from_index(lo), normal});
    region.push_back({geometry.world_from_index(hi), -normal});
  }
  return region;
}

IndexClip::IndexClip(const Clip& clip, const Geometry& geometry)
    : m_keep(clip.keep), m_space(clip.space) {
  for (const HalfSpace& half : clip.region) {
    const Vec3d unit = half.normal_lps.normalized();
    Plane plane{};
    for (int axis = 0; axis < 3; ++axis) {
      Vec3d step(0);
      step[axis] = 1;
      plane.normal[axis] = geometry.world_vector_from_index(step).dot(unit);
    }
    plane.distance = plane.normal.dot(geometry.index_from_world(half.point_lps_mm));
    m_planes.push_back(plane);
  }
}

bool IndexClip::contains(const Vec3d& x) const {
  return std::all_of(m_planes.begin(), m_planes.end(),
                     [&](const Plane& plane) { return plane.depth_mm(x) >= 0; });
}

Interval IndexClip::along(const IndexRay& ray) const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Interval part{-kInfinity, kInfinity};
  for (const Plane& plane : m_planes) {
    const double room = -plane.depth_mm(ray.origin);
    const double speed = plane.normal.dot(ray.direction);
    if (speed > 0) part.begin = std::max(part.begin, room / speed);
    if (speed < 0) part.end = std::min(part.end, room / speed);
    if (speed == 0 && room > 0) return {kInfinity, -kInfinity};
  }
  return part;
}

Interval clip_to_box(const IndexRay& ray, const Vec3d& lo, const Vec3d& hi, Interval within) {
  for (int a = 0; a < 3; ++a) {
    if (ray.direction[a] == 0) {
      if (ray.origin[a] < lo[a] || ray.origin[a] > hi[a]) return {1, 0};
      continue;
    }
    const double t0 = (lo[a] - ray.origin[a]) / ray.direction[a];
    const double t1 = (hi[a] - ray.origin[a]) / ray.direction[a];
    within.begin = std::max(within.begin, std::min(t0, t1));
    within.end = std::min(within.end, std::max(t0, t1));
  }
  return within;
}

}  // namespace supple
