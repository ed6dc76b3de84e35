// Boxes of numbers per voxel, worked on along lines of an axis by all cores.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "volumes/base/parallel.h"
#include "volumes/base/vec.h"

namespace supple {

/// A box of numbers, i fastest, whose lines along an axis are worked on row by row.
template <class T>
struct Box {
  Vec3i dims;
  std::vector<T>& values;

  T* row(int j, int k) const {
    return values.data() + (std::size_t(k) * std::size_t(dims.y) + std::size_t(j)) * dims.x;
  }
};

/// Calls work(source, out, n, count) for groups of lines along an axis. The lines of a group lie
/// side by side: value m of line i is at m * width + i. Sources have `margin` more at both ends,
/// which repeat the outermost value.
template <class T, class Work>
void for_each_lines(const Box<T>& box, int axis, int margin, const Work& work) {
  const int width = axis == 0 ? 1 : box.dims.x;
  const int length = box.dims[axis];
  const auto line_at = [&](int group, int m) {
    if (axis == 0) return box.row(group % box.dims.y, group / box.dims.y) + m;
    return axis == 1 ? box.row(m, group) : box.row(group, m);
  };
  const int groups = axis == 0 ? box.dims.y * box.dims.z : axis == 1 ? box.dims.z : box.dims.y;
  parallel_ranges(groups, Grain{std::size_t(axis == 0 ? 64 : 1)}, [&](int begin, int end) {
    std::vector<T> source(std::size_t(length + 2 * margin) * std::size_t(width));
    for (int group = begin; group < end; ++group) {
      for (int m = -margin; m < length + margin; ++m) {
        std::copy_n(line_at(group, std::clamp(m, 0, length - 1)), width,
                    source.data() + std::size_t(m + margin) * std::size_t(width));
      }
      work(source.data(), width, length, [&](int m) { return line_at(group, m); });
    }
  });
}

/// Calls work(n) for all values of a box.
template <class Work>
void for_each_value(const Vec3i& dims, const Work& work) {
  const std::size_t slice = std::size_t(dims.x) * std::size_t(dims.y);
  parallel_for(dims.z, [&](int k) {
    for (std::size_t n = slice * std::size_t(k); n < slice * std::size_t(k + 1); ++n) work(n);
  });
}

using VoxelFlags = std::vector<std::uint8_t>;

/// Takes the largest of the values within a radius along every axis, by windows that double.
inline void spread(const Vec3i& dims, const Vec3i& radius, VoxelFlags& bytes) {
  const Box<std::uint8_t> box{dims, bytes};
  for (int axis = 0; axis < 3; ++axis) {
    const int reach = radius[axis], window = 2 * reach + 1;
    for_each_lines(box, axis, reach, [&](std::uint8_t* values, int width, int length, auto&& line) {
      const auto step = [&](std::uint8_t* out, int ahead, int count) {
        const std::size_t offset = std::size_t(ahead) * std::size_t(width);
        const std::uint8_t *here = values, *there = values + offset;
        const std::size_t end = std::size_t(count) * std::size_t(width);
        for (std::size_t n = 0; n < end; ++n) out[n] = std::max(here[n], there[n]);
      };
      int covered = 1;
      for (; 2 * covered <= window; covered *= 2) {
        step(values, covered, length + 2 * reach - 2 * covered + 1);
      }
      step(values, window - covered, length);
      for (int m = 0; m < (axis == 0 ? 1 : length); ++m) {
        const std::size_t from = std::size_t(m) * std::size_t(width);
        std::copy_n(values + from, axis == 0 ? length : width, line(m));
      }
    });
  }
}

}  // namespace supple
