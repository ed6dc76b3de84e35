#include "volumes/field/displacement.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "volumes/field/ring_fill.h"

namespace supple {

Displacement extend(const Displacement& displacement, const BrickTopology& target) {
  constexpr int kAllRings = std::numeric_limits<int>::max();
  return {displacement.geometry, fill_rings(displacement.u, target, kAllRings)};
}

DeformedBounds deformed_bounds(const Displacement& displacement) {
  const BrickTopology& bricks = displacement.u.topology;
  if (bricks.empty()) return {Vec3d(0), Vec3d(0)};
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  DeformedBounds bounds{Vec3d(kInfinity), Vec3d(-kInfinity)};
  for (std::size_t b = 0; b < bricks.brick_count(); ++b) {
    for_each_active(bricks.mask(b), [&](int offset) {
      const Vec3d moved = Vec3d(bricks.origin(b) + brick_local(offset)) +
                          Vec3d(displacement.u.vectors[b * kBrickVoxels + offset]);
      for (int a = 0; a < 3; ++a) {
        bounds.lo_index[a] = std::min(bounds.lo_index[a], moved[a]);
        bounds.hi_index[a] = std::max(bounds.hi_index[a], moved[a]);
      }
    });
  }
  return bounds;
}

double max_length_voxels(const Displacement& displacement) {
  const BrickTopology& bricks = displacement.u.topology;
  double max_squared = 0;
  for (std::size_t b = 0; b < bricks.brick_count(); ++b) {
    for_each_active(bricks.mask(b), [&](int offset) {
      const Vec3d u(displacement.u.vectors[b * kBrickVoxels + offset]);
      max_squared = std::max(max_squared, u.length2());
    });
  }
  return std::sqrt(max_squared);
}

}  // namespace supple
