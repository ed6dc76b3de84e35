#include "volumes/field/invert_warp.h"

#include <numeric>

#include <tbb/parallel_for.h>

#include "volumes/field/grid_positions.h"

namespace supple {

namespace {

/// All voxels of a box.
BrickTopology box_topology(const Vec3i& dims) {
  std::vector<Vec3i> origins;
  std::vector<BrickMask> masks;
  for (int x = 0; x < dims.x; x += kBrickDim) {
    for (int y = 0; y < dims.y; y += kBrickDim) {
      for (int z = 0; z < dims.z; z += kBrickDim) {
        BrickMask mask{};
        for (int offset = 0; offset < kBrickVoxels; ++offset) {
          const Vec3i voxel = Vec3i(x, y, z) + brick_local(offset);
          if (voxel.x < dims.x && voxel.y < dims.y && voxel.z < dims.z) mask_set(mask, offset);
        }
        origins.emplace_back(x, y, z);
        masks.push_back(mask);
      }
    }
  }
  return {std::move(origins), std::move(masks)};
}

}  // namespace

Displacement displacement_of_warp(const Warp& warp) {
  const Vec3i& dims = warp.geometry.dims();
  Displacement displacement{warp.geometry, {box_topology(dims), {}}};
  VectorBricks& u = displacement.u;
  u.vectors.assign(u.topology.brick_count() * kBrickVoxels, Vec3f(0));
  tbb::parallel_for(std::size_t(0), u.topology.brick_count(), [&](std::size_t b) {
    for_each_active(u.topology.mask(b), [&](int offset) {
      const Vec3i voxel = u.topology.origin(b) + brick_local(offset);
      const std::size_t row = std::size_t(voxel.z) * dims.y + voxel.y;
      const Vec3d vector(warp.vectors[row * dims.x + voxel.x]);
      u.vectors[b * kBrickVoxels + offset] = Vec3f(warp.geometry.index_vector_from_world(vector));
    });
  });
  return displacement;
}

std::int64_t count_uncovered(const OffsetField& offsets, const Geometry& grid) {
  const GridPositions positions(grid, offsets.geometry);
  const Vec3i& dims = grid.dims();
  std::vector<std::int64_t> uncovered(std::size_t(dims.z), 0);
  tbb::parallel_for(0, dims.z, [&](int k) {
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
