// Rays in index space.
#pragma once

#include <limits>

#include "volumes/base/vec.h"

namespace supple {

/// A ray in index space: origin + t * direction, t in mm.
struct IndexRay {
  Vec3d origin;
  Vec3d direction;
  Vec3d at(double t) const { return origin + direction * t; }
};

/// The end of a ray that nothing ends.
constexpr double kEndless = std::numeric_limits<double>::infinity();

struct Interval {
  double begin, end;
};

/// Part of the ray's [begin, end] inside the box lo … hi; empty (begin > end) when it misses.
Interval clip_to_box(const IndexRay& ray, const Vec3d& lo, const Vec3d& hi, Interval within);

}  // namespace supple
