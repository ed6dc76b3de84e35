// Which voxels of a brick and around it are valid, as rows of bits along z, so that whole rows are
// tested at once.
#pragma once

#include "volumes/base/simd.h"
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

/// Local voxels -kPad … 7 + kPad along every axis: bit z + kPad of row (x + kPad, y + kPad).
template <int kPad>
struct PaddedRows {
  static constexpr int kRows = kBrickDim + 2 * kPad;
  std::uint16_t rows[kRows][kRows];

  /// `mask_at(n)`: pointer to the valid voxels of surrounding brick n, or null.
  template <class MaskAt>
  explicit PaddedRows(const MaskAt& mask_at) {
    constexpr unsigned kAbove = (1u << kPad) - 1;
    for (int x = 0; x < kRows; ++x) {
      const int layer = (x - kPad) & (kBrickDim - 1);
      for (int side = 0; side < 3; ++side) {  // the bricks below, beside and above along y
        const int first = surrounding_voxel({x - kPad, (side - 1) * kBrickDim, 0}).brick;
        const auto word_of = [&](int n) {
          const BrickMask* const mask = mask_at(n);
          return mask == nullptr ? 0 : (*mask)[std::size_t(layer)];
        };
        const std::uint64_t below = word_of(first - 1), own = word_of(first),
                            above = word_of(first + 1);
        const int end = side == 0 ? kPad : side == 1 ? kPad + kBrickDim : kRows;
        for (int y = side == 0 ? 0 : side == 1 ? kPad : kPad + kBrickDim; y < end; ++y) {
          const int shift = 8 * ((y - kPad) & (kBrickDim - 1));
          const auto row = [&](std::uint64_t word) { return unsigned(word >> shift) & 0xff; };
          rows[x][y] = std::uint16_t(row(below) >> (kBrickDim - kPad) | row(own) << kPad |
                                     (row(above) & kAbove) << (kBrickDim + kPad));
        }
      }
    }
  }

  bool test(const Vec3i& local) const {
    return (rows[local.x + kPad][local.y + kPad] >> (local.z + kPad)) & 1;
  }
  /// Bits z of row (x, y), z from 0 on.
  unsigned row(int x, int y) const { return rows[x + kPad][y + kPad] >> kPad; }
  /// Bits z, from 0 to 7 + kPad - 1, that are set or touch one that is.
  unsigned dilated_row(int x, int y) const {
    unsigned bits = 0;
    for (int n = 0; n < 9; ++n) bits |= rows[x + kPad + n / 3 - 1][y + kPad + n % 3 - 1];
    return ((bits | bits >> 1 | bits << 1) >> kPad) & kUpTo;
  }

 private:
  static constexpr unsigned kUpTo = (1u << (kBrickDim + kPad - 1)) - 1;
};

/// The value of a voxel that has none yet, from valid neighbours: their mean; or, when there are
/// two voxels in a row in some directions, the mean of their linear continuations. Differences of
/// more than a voxel are not continued. Summed in double: exact for constant fields.
class Extrapolation {
 public:
  void add(const Vec3f& near) {
    m_mean += lanes(near);
    ++m_count;
  }
  /// `far` lies behind `near`.
  void add_row(const Vec3f& near, const Vec3f& far) {
    const Lanes from = lanes(near), slope = from - lanes(far), one = Lanes{} + 1;
    m_linear += from + (slope > one ? one : slope < -one ? -one : slope);
    ++m_rows;
  }
  bool empty() const { return m_count + m_rows == 0; }
  Vec3f value() const {
    const Lanes mean = m_rows > 0 ? m_linear / double(m_rows) : m_mean / double(m_count);
    return Vec3f(Vec3d(mean[0], mean[1], mean[2]));
  }

 private:
  using Lanes = Pack<double, 4>;  // of which three count
  static Lanes lanes(const Vec3f& v) { return Lanes{double(v.x), double(v.y), double(v.z), 0}; }

  Lanes m_mean{}, m_linear{};
  int m_count = 0, m_rows = 0;
};

/// From the 26 neighbours and, for kLinear, the voxels behind them; `vectors_of(n)`: the 512 of
/// surrounding brick n. At least one neighbour is valid.
template <bool kLinear, int kPad, class VectorsOf>
Vec3f extrapolate(const PaddedRows<kPad>& padded, const Vec3i& local, VectorsOf&& vectors_of) {
  const auto vector_at = [&](const Vec3i& q) -> const Vec3f& {
    const SurroundingVoxel voxel = surrounding_voxel(q);
    return vectors_of(voxel.brick)[voxel.offset];
  };
  static_assert(!kLinear || kPad > 1);
  Extrapolation result;
  for (int row = 0; row < 9; ++row) {
    const Vec3i step(row / 3 - 1, row % 3 - 1, -1);
    unsigned bits =
        (padded.rows[local.x + step.x + kPad][local.y + step.y + kPad] >> (local.z + kPad - 1)) & 7;
    for (; bits != 0; bits &= bits - 1) {
      const Vec3i to = step + Vec3i(0, 0, __builtin_ctz(bits));
      const Vec3f& near = vector_at(local + to);
      if (kLinear && padded.test(local + 2 * to)) {
        result.add_row(near, vector_at(local + 2 * to));
      } else {
        result.add(near);
      }
    }
  }
  return result.value();
}

/// The 27 bricks around a brick, itself in the middle; -1 where there is none.
using Surroundings = std::array<std::int32_t, 27>;

inline Surroundings surroundings_of(const BrickTopology& bricks, std::size_t b) {
  Surroundings around;
  const Vec3i& origin = bricks.origin(b);
  // Within a region of 16^3 bricks all are in one table (BrickLookup).
  const auto is_inner = [](int voxel) { return (voxel >> 3 & 15) % 15 != 0; };
  if (is_inner(origin.x) && is_inner(origin.y) && is_inner(origin.z)) {
    const std::int32_t* own = bricks.index().lookup().tables + bricks.index().place(b);
    for (int n = 0; n < 27; ++n)
      around[n] = own[256 * (n / 9 - 1) + 16 * (n / 3 % 3 - 1) + n % 3 - 1];
    return around;
  }
  for (int n = 0; n < 27; ++n) {
    around[n] = bricks.find(origin + surrounding_step(n) * kBrickDim);
  }
  return around;
}

/// `mask_of(b)`: valid voxels of brick b.
template <int kPad, class MaskOf>
PaddedRows<kPad> padded_rows(const Surroundings& around, MaskOf&& mask_of) {
  return PaddedRows<kPad>(
      [&](int n) -> const BrickMask* { return around[n] < 0 ? nullptr : &mask_of(around[n]); });
}

}  // namespace supple
