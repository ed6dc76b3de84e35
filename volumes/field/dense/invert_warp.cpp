#include "volumes/field/dense/invert_warp.h"

#include <numeric>

#include "volumes/base/parallel.h"
#include "volumes/field/dense/grid_positions.h"
#include "volumes/grid/voxel_sets.h"

namespace supple {

Displacement displacement_of_warp(const Warp& warp) {
  const Vec3i& dims = warp.geometry.dims();
  Displacement displacement{warp.geometry, {box_topology(dims), {}}};
  VectorBricks& u = displacement.u;
  u.vectors.resize(u.topology.brick_count());
  u.vectors.touch_all();
  parallel_for(u.topology.brick_count(), [&](std::size_t b) {
    Vec3f* const vectors = u.vectors.touch(b);
    for_each_active(u.topology.mask(b), [&](int offset) {
      const Vec3i voxel = u.topology.origin(b) + brick_local(offset);
      const std::size_t row = std::size_t(voxel.z) * dims.y + voxel.y;
      const Vec3d vector(warp.vectors[row * dims.x + voxel.x]);
      vectors[offset] = Vec3f(warp.geometry.index_vector_from_world(vector));
    });
  });
  return displacement;
}

std::int64_t count_uncovered(const OffsetField& offsets, const Geometry& grid) {
  const GridPositions positions(grid, offsets.geometry);
  const Vec3i& dims = grid.dims();
  std::vector<std::int64_t> uncovered(std::size_t(dims.z), 0);
  parallel_for(dims.z, [&](int k) {
    Vec3d offset;
    for (int j = 0; j < dims.y; ++j) {
      for (int i = 0; i < dims.x; ++i) {
        uncovered[k] += !offsets.sample(positions.at(i, j, k), offset);
      }
    }
  });
  return std::accumulate(uncovered.begin(), uncovered.end(), std::int64_t(0));
}

}  // namespace supple
