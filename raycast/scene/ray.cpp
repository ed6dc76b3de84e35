#include "raycast/scene/ray.h"

#include <algorithm>
#include <cmath>

namespace supple {

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
