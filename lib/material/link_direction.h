// Directions of the links of a voxel: steps d in {-1, 0, 1}^3 along the grid axes, numbered 9 (d_i
// + 1) + 3 (d_j + 1) + d_k + 1. Opposite directions add up to 26; 13 is no step, and directions
// above 13 lead to the later voxel in the order of slots.
#pragma once

#include <array>

namespace supple {

constexpr int kDirections = 27, kNoStep = 13;
using LinkStep = std::array<int, 3>;

constexpr LinkStep step_of_direction(int direction) {
  return {direction / 9 - 1, direction / 3 % 3 - 1, direction % 3 - 1};
}
constexpr int direction_of_step(int i, int j, int k) {
  return 9 * (i + 1) + 3 * (j + 1) + k + 1;
}
constexpr int opposite_direction(int direction) {
  return kDirections - 1 - direction;
}
constexpr int direction_along(int axis, bool positive) {
  return kNoStep + (positive ? 1 : -1) * (axis == 0 ? 9 : axis == 1 ? 3 : 1);
}

/// Axes along which a direction steps: 1 for axes, 2 for diagonals of faces, 3 for those of cells.
constexpr int axes_of_direction(int direction) {
  return (direction / 9 != 1) + (direction / 3 % 3 != 1) + (direction % 3 != 1);
}
/// The first axis along which a direction steps.
constexpr int axis_of_direction(int direction) {
  return direction / 9 != 1 ? 0 : direction / 3 % 3 != 1 ? 1 : 2;
}
constexpr bool is_diagonal(int direction) {
  return axes_of_direction(direction) > 1;
}
/// True where a body of 6, 18 or 26 links per voxel has links of that direction.
constexpr bool has_direction(int links, int direction) {
  const int axes = axes_of_direction(direction);
  return axes >= 1 && axes <= (links == 6 ? 1 : links == 18 ? 2 : 3);
}

}  // namespace supple
