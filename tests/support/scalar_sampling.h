// One sample at a time, straight from the definitions: what sample_batch is judged by.
#pragma once

#include "raycast/sample/offset_bricks.h"
#include "raycast/sample/source_bricks.h"

namespace supple {

/// A place in a cell: the node at its low corner and the position within, 0 … 1.
struct SourceCell {
  const std::int16_t* node = nullptr;
  float x = 0, y = 0, z = 0;
};

/// Bilinear value on the four nodes spanned by two steps; false when one of them is void.
inline bool sample_plane(const std::int16_t* node, int step_u, int step_v, float u, float v,
                         float& value) {
  const std::int16_t a = node[0], b = node[step_u], c = node[step_v], d = node[step_u + step_v];
  if ((a == SourceBricks::kVoid) | (b == SourceBricks::kVoid) | (c == SourceBricks::kVoid) |
      (d == SourceBricks::kVoid)) {
    return false;
  }
  const float low = float(a) + u * float(b - a);
  const float high = float(c) + u * float(d - c);
  value = low + v * (high - low);
  return true;
}

/// Trilinear value; false (empty) when any of the eight corners is void.
inline bool sample_cell(const SourceCell& cell, float& value) {
  constexpr int sx = SourceBricks::kStepX, sy = SourceBricks::kStepY, sz = SourceBricks::kStepZ;
  float low = 0, high = 0;
  if (!sample_plane(cell.node, sy, sz, cell.y, cell.z, low)) return false;
  if (!sample_plane(cell.node + sx, sy, sz, cell.y, cell.z, high)) return false;
  value = low + cell.x * (high - low);
  return true;
}

/// Value at one position along an axis: the difference quotient that its neighbours allow.
inline float difference(bool has_minus, float minus, float here, bool has_plus, float plus) {
  if (has_minus && has_plus) return 0.5f * (plus - minus);
  if (has_plus) return plus - here;
  if (has_minus) return here - minus;
  return 0;
}

/// Derivative along the axis of `step`; u and v are the other two axes.
inline float axis_gradient(const std::int16_t* node, int step, int step_u, int step_v, float t,
                           float u, float v, float here) {
  float before = 0, low = 0, high = 0, after = 0;
  sample_plane(node, step_u, step_v, u, v, low);
  sample_plane(node + step, step_u, step_v, u, v, high);
  const bool has_minus = sample_plane(node - step, step_u, step_v, u, v, before);
  const bool has_plus = sample_plane(node + 2 * step, step_u, step_v, u, v, after);
  const float minus = has_minus ? before + t * (low - before) : 0;
  const float plus = has_plus ? high + t * (after - high) : 0;
  return difference(has_minus, minus, here, has_plus, plus);
}

/// Index-space gradient by central differences of the trilinear density over +-1 voxel, one-sided
/// where a neighbour is void, 0 where both are. `value` is the density at the cell's position.
inline Vec3f sample_gradient(const SourceCell& cell, float value) {
  constexpr int sx = SourceBricks::kStepX, sy = SourceBricks::kStepY, sz = SourceBricks::kStepZ;
  return {axis_gradient(cell.node, sx, sy, sz, cell.x, cell.y, cell.z, value),
          axis_gradient(cell.node, sy, sx, sz, cell.y, cell.x, cell.z, value),
          axis_gradient(cell.node, sz, sx, sy, cell.z, cell.x, cell.y, value)};
}

/// Trilinear offset; not a number when a corner has none.
inline Vec3f sample_offset(const NodeCell& cell) {
  Vec3f sum(0);
  for (int c = 0; c < 8; ++c) {
    const int x = c >> 2, y = (c >> 1) & 1, z = c & 1;
    const float* node =
        cell.node + x * BrickNodes::kStepX + y * BrickNodes::kStepY + z * BrickNodes::kStepZ;
    const float weight =
        (x ? cell.x : 1 - cell.x) * (y ? cell.y : 1 - cell.y) * (z ? cell.z : 1 - cell.z);
    sum += Vec3f(node[0], node[1], node[2]) * weight;
  }
  return sum;
}

}  // namespace supple
