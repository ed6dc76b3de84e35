#include "volumes/grid/voxel_sets.h"

#include <algorithm>
#include <array>
#include <map>

#include "volumes/base/parallel.h"
#include "volumes/grid/mask_steps.h"

namespace supple {

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

BrickTopology topology_of(const std::vector<Vec3i>& voxels) {
  std::map<std::array<int, 3>, BrickMask> bricks;
  for (const Vec3i& voxel : voxels) {
    mask_set(bricks[{voxel.x & ~7, voxel.y & ~7, voxel.z & ~7}], brick_offset(voxel));
  }
  std::vector<Vec3i> origins;
  std::vector<BrickMask> masks;
  for (const auto& [origin, mask] : bricks) {
    origins.emplace_back(origin[0], origin[1], origin[2]);
    masks.push_back(mask);
  }
  return {std::move(origins), std::move(masks)};
}

BrickTopology unite(const BrickTopology& a, const BrickTopology& b) {
  std::vector<Vec3i> origins;
  std::vector<BrickMask> masks;
  std::size_t m = 0, n = 0;
  while (m < a.brick_count() || n < b.brick_count()) {
    const bool take_a =
        n == b.brick_count() || (m < a.brick_count() && !voxel_less(b.origin(n), a.origin(m)));
    const bool take_b =
        m == a.brick_count() || (n < b.brick_count() && !voxel_less(a.origin(m), b.origin(n)));
    BrickMask mask{};
    for (int word = 0; word < 8; ++word) {
      mask[word] = (take_a ? a.mask(m)[word] : 0) | (take_b ? b.mask(n)[word] : 0);
    }
    origins.push_back(take_a ? a.origin(m) : b.origin(n));
    masks.push_back(mask);
    m += take_a;
    n += take_b;
  }
  return {std::move(origins), std::move(masks)};
}

BrickTopology intersect(const BrickTopology& a, const BrickTopology& b) {
  std::vector<Vec3i> origins;
  std::vector<BrickMask> masks;
  for (std::size_t n = 0; n < a.brick_count(); ++n) {
    const std::int32_t other = b.find(a.origin(n));
    if (other < 0) continue;
    origins.push_back(a.origin(n));
    masks.push_back(a.mask(n));
    for (std::size_t word = 0; word < 8; ++word)
      masks.back()[word] &= b.mask(std::size_t(other))[word];
  }
  return {std::move(origins), std::move(masks)};
}

BrickTopology subtract(const BrickTopology& a, const BrickTopology& b) {
  std::vector<Vec3i> origins;
  std::vector<BrickMask> masks;
  for (std::size_t n = 0; n < a.brick_count(); ++n) {
    const std::int32_t other = b.find(a.origin(n));
    if (other >= 0 && b.mask(std::size_t(other)) == a.mask(n)) continue;
    origins.push_back(a.origin(n));
    masks.push_back(a.mask(n));
    if (other >= 0) take_out(b.mask(std::size_t(other)), masks.back());
  }
  return {std::move(origins), std::move(masks)};
}

BrickTopology eroded(const BrickTopology& topology) {
  std::vector<Vec3i> origins(topology.brick_count());
  std::vector<BrickMask> masks(topology.brick_count(), BrickMask{});
  parallel_for(topology.brick_count(), [&](std::size_t b) {
    origins[b] = topology.origin(b);
    // Voxels stay that touch no voxel that is not active.
    const auto absent = [](const BrickMask& mask) {
      BrickMask out;
      std::transform(mask.begin(), mask.end(), out.begin(), [](auto word) { return ~word; });
      return out;
    };
    MasksAround around =
        masks_around(surroundings_of(topology, b),
                     [&](std::int32_t m) -> const BrickMask& { return topology.mask(m); });
    std::array<BrickMask, 27> others;
    for (std::size_t n = 0; n < around.size(); ++n) {
      others[n] = absent(*around[n]);
      around[n] = &others[n];
    }
    masks[b] = absent(dilated(around));
  });
  return {std::move(origins), std::move(masks)};
}

BrickTopology touching_bricks(const BrickTopology& topology) {
  std::vector<Vec3i> origins;
  origins.reserve(topology.brick_count() * 27);
  for (std::size_t b = 0; b < topology.brick_count(); ++b) {
    for (int n = 0; n < 27; ++n) {
      origins.push_back(topology.origin(b) + surrounding_step(n) * kBrickDim);
    }
  }
  sort_unique(origins);
  BrickMask full;
  full.fill(~std::uint64_t(0));
  std::vector<BrickMask> masks(origins.size(), full);
  return {std::move(origins), std::move(masks)};
}

void sort_unique(std::vector<Vec3i>& voxels) {
  std::sort(voxels.begin(), voxels.end(), voxel_less);
  voxels.erase(std::unique(voxels.begin(), voxels.end()), voxels.end());
}

}  // namespace supple
