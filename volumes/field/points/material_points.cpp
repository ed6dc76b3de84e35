#include "volumes/field/points/material_points.h"

#include "volumes/field/dense/smooth_extension.h"

namespace supple {

std::vector<Vec3d> moved_along(const Displacement& displacement,
                               const std::vector<Vec3d>& points_lps_mm) {
  const SmoothExtension u(displacement.u);
  const Geometry& geometry = displacement.geometry;
  std::vector<Vec3d> moved;
  moved.reserve(points_lps_mm.size());
  for (const Vec3d& point : points_lps_mm) {
    const Vec3d by = u.sample(geometry.index_from_world(point));
    moved.push_back(point + geometry.world_vector_from_index(by));
  }
  return moved;
}

}  // namespace supple
