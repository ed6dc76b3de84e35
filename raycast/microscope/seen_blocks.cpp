#include "raycast/microscope/seen_blocks.h"

#include <algorithm>
#include <cmath>

namespace supple {

namespace {

constexpr float kMarginBlocks = 0.25f;  // a pixel, for rounding
constexpr float kLeastDepth = 1e-3f;    // lengths of `forward`

/// A side of a triangle: positive towards the inside.
struct BlockSide {
  float x, y, constant;
  BlockSide(float from_x, float from_y, float to_x, float to_y, float turn)
      : x((from_y - to_y) * turn), y((to_x - from_x) * turn), constant(-x * from_x - y * from_y) {
    constant += (std::abs(x) + std::abs(y)) * (0.5f + kMarginBlocks);
  }
  /// False where all of a block lies outside.
  bool may_hold(float middle_x, float middle_y) const {
    return x * middle_x + y * middle_y + constant >= 0;
  }
};

}  // namespace

void SeenBlocks::begin(const LensFloats& lens, int width, int height) {
  m_lens = lens;
  m_across = (width + kPixels - 1) / kPixels;
  m_down = (height + kPixels - 1) / kPixels;
  m_is_seen.assign(std::size_t(m_across) * m_down, 0);
}

SeenBlocks::Projected SeenBlocks::project(const Vec3f& place) const {
  const Vec3f v = place - m_lens.origin;
  const float depth = v.dot(m_lens.forward);
  if (!(depth > kLeastDepth)) return {0, 0, false};
  const float x = m_lens.middle_x + v.dot(m_lens.right) / (depth * m_lens.right.length2());
  const float y = m_lens.middle_y - v.dot(m_lens.up) / (depth * m_lens.up.length2());
  return {x / kPixels, y / kPixels, true};
}

void SeenBlocks::add(const std::vector<Vec3f>& vertices,
                     const std::vector<std::array<int, 3>>& triangles) {
  m_projected.clear();
  for (const Vec3f& vertex : vertices) m_projected.push_back(project(vertex));
  for (const auto& triangle : triangles) {
    add_triangle(m_projected[std::size_t(triangle[0])], m_projected[std::size_t(triangle[1])],
                 m_projected[std::size_t(triangle[2])]);
  }
}

void SeenBlocks::add_triangle(const Projected& a, const Projected& b, const Projected& c) {
  const int in_front = int(a.is_in_front) + int(b.is_in_front) + int(c.is_in_front);
  if (in_front == 0) return;
  if (in_front < 3) {
    std::fill(m_is_seen.begin(), m_is_seen.end(), std::uint8_t(1));
    return;
  }
  const auto range = [](float p, float q, float r, int count) {
    const float first = std::floor(std::min({p, q, r}) - kMarginBlocks);
    const float last = std::floor(std::max({p, q, r}) + kMarginBlocks);
    return std::array<int, 2>{int(std::clamp(first, 0.0f, float(count))),
                              int(std::clamp(last, -1.0f, float(count - 1)))};
  };
  const auto [left, right] = range(a.x, b.x, c.x, m_across);
  const auto [top, bottom] = range(a.y, b.y, c.y, m_down);
  const float area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  const float turn = area < 0 ? -1.0f : 1.0f;
  const BlockSide ab(a.x, a.y, b.x, b.y, turn), bc(b.x, b.y, c.x, c.y, turn),
      ca(c.x, c.y, a.x, a.y, turn);
  for (int row = top; row <= bottom; ++row) {
    for (int column = left; column <= right; ++column) {
      const float x = float(column) + 0.5f, y = float(row) + 0.5f;
      if (!(ab.may_hold(x, y) && bc.may_hold(x, y) && ca.may_hold(x, y))) continue;
      m_is_seen[std::size_t(row) * m_across + column] = 1;
    }
  }
}

}  // namespace supple
