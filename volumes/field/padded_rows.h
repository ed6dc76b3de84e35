// Which voxels of a brick and around it are valid, as rows of bits along z, so that whole rows are
// tested at once.
#pragma once

#include "volumes/grid/brick_topology.h"

namespace supple {

/// The 27 bricks around a brick are numbered x slowest, itself in the middle: the number, and the
/// offset in that brick, of a local position in [-8, 15]^3.
struct SurroundingVoxel {
  int brick;
  int offset;
};
inline SurroundingVoxel surrounding_voxel(const Vec3i& local) {
  const int x = (local.x + 8) >> 3, y = (local.y + 8) >> 3, z = (local.z + 8) >> 3;
  return {9 * x + 3 * y + z, brick_offset(local)};
}

/// The step to surrounding brick, or voxel, n.
inline Vec3i surrounding_step(int n) {
  return {n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1};
}

/// Local voxels -1 … kLast along every axis: bit z + 1 of row (x + 1, y + 1).
template <int kLast>
struct PaddedRows {
  static constexpr int kRows = kLast + 2;
  std::uint16_t rows[kRows][kRows];

  /// `mask_at(n)`: pointer to the valid voxels of surrounding brick n, or null.
  template <class MaskAt>
  explicit PaddedRows(MaskAt&& mask_at) {
    for (int x = -1; x <= kLast; ++x) {
      for (int y = -1; y <= kLast; ++y) {
        const SurroundingVoxel voxel = surrounding_voxel({x, y, 0});
        const auto row = [&](int dz) -> unsigned {
          const BrickMask* mask = mask_at(voxel.brick + dz);
          return mask == nullptr ? 0 : ((*mask)[voxel.offset >> 6] >> (voxel.offset & 63)) & 0xff;
        };
        constexpr unsigned kAbove = (1u << (kLast - 7)) - 1;
        rows[x + 1][y + 1] = std::uint16_t(row(-1) >> 7 | row(0) << 1 | (row(1) & kAbove) << 9);
      }
    }
  }

  bool test(const Vec3i& local) const {
    return (rows[local.x + 1][local.y + 1] >> (local.z + 1)) & 1;
  }
  /// Bits z of row (x, y), z from 0 on.
  unsigned row(int x, int y) const { return rows[x + 1][y + 1] >> 1; }
  /// Bits z, from 0 to kLast - 1, whose 27 neighbours are all set.
  unsigned eroded_row(int x, int y) const {
    unsigned bits = ~0u;
    for (int dx = 0; dx < 3; ++dx) {
      for (int dy = 0; dy < 3; ++dy) bits &= rows[x + dx][y + dy];
    }
    return ((bits & bits >> 1 & bits << 1) >> 1) & ((1u << kLast) - 1);
  }
  /// Bits z, from 0 to kLast - 1, that are set or touch one that is.
  unsigned dilated_row(int x, int y) const {
    unsigned bits = 0;
    for (int dx = 0; dx < 3; ++dx) {
      for (int dy = 0; dy < 3; ++dy) bits |= rows[x + dx][y + dy];
    }
    return ((bits | bits >> 1 | bits << 1) >> 1) & ((1u << kLast) - 1);
  }
};

/// The mean over the voxel and those of its 26 neighbours that are valid, summed in double and in
/// one fixed order. `vectors_of(n)`: the 512 of surrounding brick n. At least one is valid.
template <int kLast, class VectorsOf>
Vec3f mean_of_neighbours(const PaddedRows<kLast>& padded, const Vec3i& local,
                         VectorsOf&& vectors_of) {
  double sum[3] = {0, 0, 0};
  int count = 0;
  for (int row = 0; row < 9; ++row) {
    const int x = local.x + row / 3 - 1, y = local.y + row % 3 - 1;
    unsigned bits = (padded.rows[x + 1][y + 1] >> local.z) & 7;
    if (bits == 0) continue;
    count += __builtin_popcount(bits);
    const SurroundingVoxel start = surrounding_voxel({x, y, 0});
    for (; bits != 0; bits &= bits - 1) {
      const int z = local.z - 1 + __builtin_ctz(bits);
      const Vec3f& v = vectors_of(start.brick + ((z + 8) >> 3) - 1)[start.offset + (z & 7)];
      sum[0] += v.x;
      sum[1] += v.y;
      sum[2] += v.z;
    }
  }
  return Vec3f(Vec3d(sum[0], sum[1], sum[2]) / double(count));
}

}  // namespace supple
