// Places of the coordinates and normals of a mesh in its file, so that they can be replaced and
// every other byte kept. Cost: 48 bytes per vertex, 96 per normal.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "volumes/base/vec.h"

namespace supple {

/// How a number is written; `text_float`: with the digits that a float needs.
enum class NumberCode : std::uint8_t {
  text,
  text_float,
  float32_little,
  float32_big,
  float64_little,
  float64_big
};

struct NumberSlot {
  std::size_t begin = 0;  // offset in the file
  std::uint32_t size = 0;
  NumberCode code = NumberCode::text;
};
using VectorSlot = std::array<NumberSlot, 3>;

struct MeshSlots {
  struct Normal {
    VectorSlot slot;
    Vec3d direction;              // as in the file
    std::size_t first, count;     // the vertices that it belongs to: a range of `corners`
    bool is_of_triangle = false;  // follows from its three corners
  };

  std::vector<VectorSlot> positions;  // one per vertex
  std::vector<Normal> normals;
  std::vector<int> corners;

  void add_normal(const VectorSlot& slot, const Vec3d& direction, const std::vector<int>& of,
                  bool is_of_triangle = false) {
    normals.push_back({slot, direction, corners.size(), of.size(), is_of_triangle});
    corners.insert(corners.end(), of.begin(), of.end());
  }
};

}  // namespace supple
