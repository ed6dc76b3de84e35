// The algebra of voxel sets: brick topologies and lists of voxels.
#pragma once

#include <algorithm>
#include <vector>

#include "volumes/grid/brick_topology.h"

namespace supple {

/// True if all voxels of a brick are set.
inline bool is_full(const BrickMask& mask) {
  return std::all_of(mask.begin(), mask.end(), [](std::uint64_t word) { return ~word == 0; });
}
/// True if `whole` has all voxels of `part`.
inline bool holds(const BrickMask& whole, const BrickMask& part) {
  std::uint64_t missing = 0;
  for (std::size_t word = 0; word < whole.size(); ++word) missing |= part[word] & ~whole[word];
  return missing == 0;
}

/// Hash for unordered sets and maps of voxels.
struct VoxelHash {
  std::size_t operator()(const Vec3i& v) const {
    std::uint64_t h = std::uint32_t(v.x);
    for (const int part : {v.y, v.z})
      h = (h ^ (h >> 29)) * 0x9E3779B97F4A7C15u + std::uint32_t(part);
    return std::size_t(h ^ (h >> 32));
  }
};

/// The voxels 0 … dims - 1.
BrickTopology box_topology(const Vec3i& dims);

/// The voxels of a list, in any order, each once or more often.
BrickTopology topology_of(const std::vector<Vec3i>& voxels);

/// The sorted union of two topologies.
BrickTopology unite(const BrickTopology& a, const BrickTopology& b);

/// The voxels that are active in both.
BrickTopology intersect(const BrickTopology& a, const BrickTopology& b);

/// The active voxels of `a` that are not active in `b`.
BrickTopology subtract(const BrickTopology& a, const BrickTopology& b);

/// The active voxels whose 26 neighbours are active too.
BrickTopology eroded(const BrickTopology& topology);

/// All voxels of the occupied bricks and of the 26 bricks around each.
BrickTopology touching_bricks(const BrickTopology& topology);

/// Sorts voxels ascending (voxel_less), each once.
void sort_unique(std::vector<Vec3i>& voxels);

}  // namespace supple
