// Blocks of 4 x 4 pixels in which a camera may see triangles; the rays of all others need not ask.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "raycast/microscope/eye_lanes.h"
#include "volumes/base/vec.h"

namespace supple {

class SeenBlocks {
 public:
  static constexpr int kPixels = 4;  // across a block

  /// Forgets all triangles.
  void begin(const LensFloats& lens, int width, int height);
  /// Marks all blocks that any of the triangles may touch, and rather one more.
  void add(const std::vector<Vec3f>& vertices, const std::vector<std::array<int, 3>>& triangles);
  bool has(int x_pixel, int y_pixel) const {
    return m_is_seen[std::size_t(y_pixel / kPixels) * m_across + x_pixel / kPixels] != 0;
  }

 private:
  struct Projected {
    float x, y;  // in blocks
    bool is_in_front;
  };
  Projected project(const Vec3f& place) const;
  void add_triangle(const Projected& a, const Projected& b, const Projected& c);

  LensFloats m_lens{};
  int m_across = 0, m_down = 0;
  std::vector<std::uint8_t> m_is_seen;
  std::vector<Projected> m_projected;
};

}  // namespace supple
