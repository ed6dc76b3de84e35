// Dilation of a brick topology by Chebyshev rings: a box filter, one axis at a time.
#include <algorithm>
#include <stdexcept>

#include "volumes/grid/brick_topology.h"

namespace supple {

namespace {

/// Origins of all bricks within one brick of an occupied one, unique and sorted.
std::vector<Vec3i> candidate_origins(const BrickTopology& topology) {
  std::vector<Vec3i> origins;
  origins.reserve(topology.brick_count() * 27);
  for (std::size_t b = 0; b < topology.brick_count(); ++b) {
    for (int dx = -8; dx <= 8; dx += 8) {
      for (int dy = -8; dy <= 8; dy += 8) {
        for (int dz = -8; dz <= 8; dz += 8) origins.push_back(topology.origin(b) + Vec3i(dx, dy, dz));
      }
    }
  }
  const auto less = [](const Vec3i& a, const Vec3i& b) {
    return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
  };
  std::sort(origins.begin(), origins.end(), less);
  origins.erase(std::unique(origins.begin(), origins.end()), origins.end());
  return origins;
}

/// Occupancy of a brick and `rings` voxels around it, (8 + 2 rings)^3 bytes, k fastest.
bool gather(const BrickTopology& topology, const Vec3i& origin, int rings,
            std::vector<std::uint8_t>& cube) {
  const int n = kBrickDim + 2 * rings;
  std::fill(cube.begin(), cube.end(), std::uint8_t(0));
  bool any = false;
  for (int dx = -8; dx <= 8; dx += 8) {
    for (int dy = -8; dy <= 8; dy += 8) {
      for (int dz = -8; dz <= 8; dz += 8) {
        const Vec3i shift(dx, dy, dz);
        const std::int32_t b = topology.find(origin + shift);
        if (b < 0) continue;
        for_each_active(topology.mask(b), [&](int offset) {
          const Vec3i p = brick_local(offset) + shift + Vec3i(rings);
          if (std::min({p.x, p.y, p.z}) < 0 || std::max({p.x, p.y, p.z}) >= n) return;
          cube[(std::size_t(p.x) * n + p.y) * n + p.z] = 1;
          any = true;
        });
      }
    }
  }
  return any;
}

/// Largest value within `rings` along one axis of stride `stride`.
void dilate_axis(std::vector<std::uint8_t>& cube, int n, int stride, int rings) {
  std::vector<std::uint8_t> line(n);
  const int total = n * n * n;
  for (int start = 0; start < total; ++start) {
    if ((start / stride) % n != 0) continue;
    for (int i = 0; i < n; ++i) line[i] = cube[start + i * stride];
    for (int i = 0; i < n; ++i) {
      const int lo = std::max(0, i - rings), hi = std::min(n - 1, i + rings);
      cube[start + i * stride] = *std::max_element(line.begin() + lo, line.begin() + hi + 1);
    }
  }
}

}  // namespace

BrickTopology dilate(const BrickTopology& topology, int rings) {
  if (rings < 0 || rings > kBrickDim) throw std::invalid_argument("dilate: rings must be 0 to 8");
  if (rings == 0 || topology.empty()) return topology;
  const int n = kBrickDim + 2 * rings;
  std::vector<std::uint8_t> cube(std::size_t(n) * n * n);
  const std::vector<Vec3i> origins = candidate_origins(topology);
  std::vector<BrickMask> masks(origins.size(), BrickMask{});
  for (std::size_t b = 0; b < origins.size(); ++b) {
    if (!gather(topology, origins[b], rings, cube)) continue;
    dilate_axis(cube, n, 1, rings);
    dilate_axis(cube, n, n, rings);
    dilate_axis(cube, n, n * n, rings);
    for (int offset = 0; offset < kBrickVoxels; ++offset) {
      const Vec3i p = brick_local(offset) + Vec3i(rings);
      if (cube[(std::size_t(p.x) * n + p.y) * n + p.z]) mask_set(masks[b], offset);
    }
  }
  return {origins, masks};
}

}  // namespace supple
