// Values of one row of voxels at places of a volume of which a box is in memory: the inner loops of
// block_warp.h. Whole numbers are interpolated as they are stored, in doubles, without a copy of
// the volume as floats. Corners are fetched by plain loads, all else runs side by side in lanes.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>
#include <vector>

#include "volumes/base/vec.h"
#include "volumes/grid/cell.h"

namespace supple {

/// Values of a box of a larger grid, i fastest.
template <class T>
struct BlockOf {
  IndexBox box;
  const T* values = nullptr;
};

/// Number of a voxel in a box of a larger grid.
inline std::size_t index_in(const IndexBox& box, int x, int y, int z) {
  const Vec3i dims = box.hi - box.lo + Vec3i(1);
  return (std::size_t(z - box.lo.z) * std::size_t(dims.y) + std::size_t(y - box.lo.y)) *
             std::size_t(dims.x) +
         std::size_t(x - box.lo.x);
}

/// Places of the voxels of a row in the volume's index frame, and what they are read at.
struct RowPlaces {
  explicit RowPlaces(std::size_t voxels) : count(voxels), at(count), inside(count), lacks(count) {
    for (int a = 0; a < 3; ++a) {
      place[a].resize(count);
      offset[a].resize(count, 0.0f);
      weight[a].resize(count);
    }
  }
  std::size_t count;
  std::array<std::vector<double>, 3> place;
  std::array<std::vector<float>, 3> offset;   // in voxels; NaN: void
  std::array<std::vector<double>, 3> weight;  // of the upper corners
  std::vector<std::int32_t> at, inside, lacks;
};

/// The number that a file of this type holds: halves go away from zero, as in store_values(), which
/// gets numbers of at most 16 bits as floats.
template <class T>
inline T stored_as(double value) {
  if constexpr (std::is_floating_point_v<T>) {
    return T(value);
  } else {
    using Limits = std::numeric_limits<T>;
    if constexpr (sizeof(T) <= 2) value = double(float(value));
    value = value == value ? value : 0;
    value += value < 0 ? -0.5 : 0.5;
    if (value >= double(Limits::max())) return Limits::max();
    if (value <= double(Limits::lowest())) return Limits::lowest();
    if constexpr (sizeof(T) <= 2) return T(std::int32_t(value));
    return T(value);
  }
}

/// The same of a number between such ones, which needs no limits where doubles hold all of them.
template <class T>
inline T rounded_between(double value) {
  if constexpr (std::is_floating_point_v<T> || sizeof(T) > 4) {
    return stored_as<T>(value);
  } else {
    if constexpr (sizeof(T) <= 2) value = double(float(value));
    value += value < 0 ? -0.5 : 0.5;
    if constexpr (sizeof(T) <= 2) return T(std::int32_t(value));
    return T(std::int64_t(value));
  }
}

template <class T>
class RowSource {
 public:
  /// Boxes are at least two voxels wide along axes on which the volume is.
  RowSource(const BlockOf<T>& source, const Vec3i& dims, double fill)
      : m_source(source), m_fill(fill), m_filling(stored_as<T>(fill)) {
    const Vec3i held = source.box.hi - source.box.lo + Vec3i(1);
    m_stride = {1, held.x, held.x * held.y};
    for (int a = 0; a < 3; ++a) {
      m_last[a] = dims[a] - 1;
      m_up[a] = m_last[a] > 0 ? m_stride[a] : 0;
      // A volume of one slice has nothing beside it: what leads less than a voxel out stays.
      m_lowest[a] = m_last[a] > 0 ? -kBeyondBorder : std::nextafter(-1.0, 0.0);
      m_highest[a] = m_last[a] > 0 ? m_last[a] + kBeyondBorder : std::nextafter(1.0, 0.0);
    }
  }

  /// False where the box lacks a voxel that is read.
  bool read(RowPlaces& places, bool is_nearest, T* out) const {
    std::fill(places.at.begin(), places.at.end(), 0);
    std::fill(places.inside.begin(), places.inside.end(), 1);
    std::fill(places.lacks.begin(), places.lacks.end(), 0);
    for (int a = 0; a < 3; ++a) locate(places, a, is_nearest);
    std::int32_t lacks = 0;
    for (std::size_t n = 0; n < places.count; ++n) lacks |= -places.inside[n] & places.lacks[n];
    if (lacks != 0) return false;
    constexpr std::size_t kPiece = 256;
    for (std::size_t n = 0; n < places.count; n += kPiece) {
      const int count = int(std::min(kPiece, places.count - n));
      if (is_nearest) {
        take(places, n, count, out + n);
      } else {
        interpolate(places, n, count, out + n);
      }
    }
    return true;
  }

 private:
  void locate(RowPlaces& places, int axis, bool is_nearest) const {
    const double lowest = m_lowest[axis], highest = m_highest[axis], last = m_last[axis];
    const int lo = m_source.box.lo[axis], stride = m_stride[axis];
    const int top = is_nearest || m_last[axis] == 0 ? 0 : 1;  // voxels above the one that is found
    const int hi = m_source.box.hi[axis] - top, end = m_last[axis] - top;
    // Halves go down to the nearest voxel, as in on_grid(): places are far fewer than 2^30.
    const double shift = is_nearest ? 0.5 - std::ldexp(1.0, -22) : 0;
    const std::size_t count = places.count;
    const double* __restrict const place = places.place[axis].data();
    const float* __restrict const offset = places.offset[axis].data();
    double* __restrict const weight = places.weight[axis].data();
    std::int32_t* __restrict const at = places.at.data();
    std::int32_t* __restrict const inside = places.inside.data();
    std::int32_t* __restrict const lacks = places.lacks.data();
    for (std::size_t n = 0; n < count; ++n) {
      double y = place[n] + double(offset[n]);
      const int is_inside = y >= lowest ? (y <= highest ? 1 : 0) : 0;
      y = y > 0 ? y : 0;
      y = y < last ? y : last;
      int voxel = int(y + shift);
      voxel = voxel < end ? voxel : end;
      int held = voxel < hi ? voxel : hi;
      held = held > lo ? held : lo;
      inside[n] &= is_inside;
      lacks[n] |= held ^ voxel;
      weight[n] = y - voxel;
      at[n] += (held - lo) * stride;
    }
  }

  static double number_of(T value, double fill) {
    if constexpr (std::is_floating_point_v<T>) {
      return value - value == 0 ? double(value) : fill;
    } else {
      return double(value);
    }
  }

  void take(const RowPlaces& places, std::size_t first, int count, T* out) const {
    for (int n = 0; n < count; ++n) {
      T value = m_source.values[places.at[first + n]];
      if constexpr (std::is_floating_point_v<T>) value = std::isfinite(value) ? value : m_filling;
      out[n] = places.inside[first + n] != 0 ? value : m_filling;
    }
  }

  void interpolate(const RowPlaces& places, std::size_t first, int count, T* out) const {
    T pairs[4][512];
    const std::int32_t* const at = places.at.data() + first;
    for (int row = 0; row < 4; ++row) {
      const T* const from = m_source.values + (row & 1) * m_up[1] + (row >> 1) * m_up[2];
      T* const to = pairs[row];
      if (m_up[0] != 0) {
        for (int n = 0; n < count; ++n) std::memcpy(to + 2 * n, from + at[n], 2 * sizeof(T));
      } else {
        for (int n = 0; n < count; ++n) to[2 * n] = to[2 * n + 1] = from[at[n]];
      }
    }
    const double* __restrict const wx = places.weight[0].data() + first;
    const double* __restrict const wy = places.weight[1].data() + first;
    const double* __restrict const wz = places.weight[2].data() + first;
    const std::int32_t* __restrict const inside = places.inside.data() + first;
    T* __restrict const values = out;
    const double fill = m_fill;
    const T filling = m_filling;
    for (int n = 0; n < count; ++n) {
      const auto along_x = [&](int row) {
        const double low = number_of(pairs[row][2 * n], fill);
        return low * (1 - wx[n]) + number_of(pairs[row][2 * n + 1], fill) * wx[n];
      };
      const double below = along_x(0) * (1 - wy[n]) + along_x(1) * wy[n];
      const double above = along_x(2) * (1 - wy[n]) + along_x(3) * wy[n];
      const T value = rounded_between<T>(below * (1 - wz[n]) + above * wz[n]);
      values[n] = inside[n] != 0 ? value : filling;
    }
  }

  const BlockOf<T>& m_source;
  double m_fill;
  T m_filling;
  std::array<int, 3> m_stride, m_last, m_up;
  std::array<double, 3> m_lowest, m_highest;
};

}  // namespace supple
