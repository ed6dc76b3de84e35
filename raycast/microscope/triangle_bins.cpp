#include "raycast/microscope/triangle_bins.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace supple {

namespace {

constexpr float kMarginBlocks = 0.25f;  // a pixel, for rounding
constexpr float kLeastDepth = 0.02f;    // mm along `forward`, from which on triangles count

/// A side of a triangle: positive towards the inside.
struct BlockSide {
  float x, y, constant;
  BlockSide(float from_x, float from_y, float to_x, float to_y, float turn, float margin)
      : x((from_y - to_y) * turn), y((to_x - from_x) * turn), constant(-x * from_x - y * from_y) {
    constant += (std::abs(x) + std::abs(y)) * (0.5f + margin);
  }
  /// False where all of a block lies outside.
  bool may_hold(float middle_x, float middle_y) const {
    return x * middle_x + y * middle_y + constant >= 0;
  }
};

}  // namespace

void TriangleRoom::clear() {
  numbers.clear();
  if (++turn != 0) return;
  std::fill(turns.begin(), turns.end(), 0);
  turn = 1;
}

void TriangleRoom::add(const TriangleList& list) {
  if (list.count == 0) return;
  const std::uint32_t highest = list.begin[list.count - 1];
  if (highest >= turns.size()) turns.resize(std::size_t(highest) + 1);
  for (int n = 0; n < list.count; ++n) {
    const std::uint32_t number = list.begin[n];
    if (std::exchange(turns[number], turn) != turn) numbers.push_back(number);
  }
}

void TriangleBins::begin(const LensFloats& lens, int width, int height, const DiscReach& reach) {
  m_lens = lens;
  m_across = (width + kPixels - 1) / kPixels;
  m_down = (height + kPixels - 1) / kPixels;
  m_reach = reach;
  m_is_undivided = false;
  m_entries.clear();
  m_numbers.clear();
}

void TriangleBins::begin_undivided() {
  begin(m_lens, kPixels, kPixels);
  m_is_undivided = true;
}

TriangleBins::Projected TriangleBins::project(const Vec3f& from_eye, float depth) const {
  const float x = m_lens.middle_x + from_eye.dot(m_lens.right) / (depth * m_lens.right.length2());
  const float y = m_lens.middle_y - from_eye.dot(m_lens.up) / (depth * m_lens.up.length2());
  return {x / kPixels, y / kPixels};
}

/// How far a triangle is seen aside of where it is, in lengths at unit depth, when the eye is
/// anywhere in the disc: at most radius * (1 / its depth - 1 / depth of the place behind it), and
/// the place lies in the ball. Depth of the ball's wall changes by no more than `slope` with the
/// direction.
float TriangleBins::reach_of(const Vec3f& middle, float radius_mm, float depth) const {
  const float r = m_reach.radius_mm;
  float reach = r / depth;
  const Vec3f to_centre = m_reach.centre - m_lens.origin;
  const float within = m_reach.ball_mm * m_reach.ball_mm - to_centre.length2();
  const float middle_depth = middle.dot(m_lens.forward);
  if (r <= 0 || !(within > 0) || !(middle_depth > kLeastDepth)) return reach;
  const Vec3f towards = middle / middle_depth;
  const float a = towards.length2(), b = towards.dot(to_centre);
  const float wall = (b + std::sqrt(b * b + a * within)) / a;
  const float widest = 2 * m_reach.ball_mm;
  const float slope = widest * m_reach.ball_mm / std::sqrt(within);
  for (int round = 0; round < 2; ++round) {
    const float furthest = std::min(wall + slope * (radius_mm / depth + reach), widest);
    reach = std::min(reach, r * std::max(1 / depth - 1 / furthest, 0.0f));
  }
  return reach;
}

void TriangleBins::add(std::uint32_t number, const std::array<Vec3f, 3>& corners) {
  if (m_is_undivided) return m_entries.push_back({0, number});
  constexpr int kHalvings = 7;
  add_part(number, corners, m_reach.radius_mm > 0 ? kHalvings : 0);
}

void TriangleBins::add_part(std::uint32_t number, const std::array<Vec3f, 3>& corners,
                            int halvings) {
  // The part before the eye is a polygon of up to four corners.
  std::array<Vec3f, 4> before;
  std::array<float, 3> depths;
  std::size_t count = 0;
  float least = INFINITY;
  for (std::size_t c = 0; c < 3; ++c) depths[c] = (corners[c] - m_lens.origin).dot(m_lens.forward);
  for (std::size_t c = 0; c < 3; ++c) {
    const std::size_t next = (c + 1) % 3;
    const float depth = depths[c] - kLeastDepth, next_depth = depths[next] - kLeastDepth;
    const Vec3f corner = corners[c] - m_lens.origin;
    if (depth >= 0) {
      before[count++] = corner;
      least = std::min(least, depths[c]);
    }
    if ((depth >= 0) == (next_depth >= 0)) continue;
    before[count++] = corner + (corners[next] - corners[c]) * (depth / (depth - next_depth));
    least = kLeastDepth;
  }
  if (count < 3) return;
  if (halvings > 0) {
    // A long one that comes near the eye would reach far with all of its length.
    constexpr float kLongest = 0.5f;  // in its least depth
    std::size_t longest = 0;
    float length2 = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const float side2 = (corners[(c + 1) % 3] - corners[c]).length2();
      if (side2 > length2) longest = c, length2 = side2;
    }
    if (length2 > kLongest * kLongest * least * least) {
      const Vec3f &a = corners[longest], &b = corners[(longest + 1) % 3],
                  &c = corners[(longest + 2) % 3];
      const Vec3f middle = (a + b) * 0.5f;
      add_part(number, {a, middle, c}, halvings - 1);
      return add_part(number, {middle, b, c}, halvings - 1);
    }
  }
  std::array<Projected, 4> places;
  for (std::size_t c = 0; c < count; ++c) {
    places[c] = project(before[c], std::max(before[c].dot(m_lens.forward), kLeastDepth));
  }
  float margin = kMarginBlocks;
  if (m_reach.radius_mm > 0) {
    const Vec3f middle = (corners[0] + corners[1] + corners[2]) / 3 - m_lens.origin;
    float radius = 0;
    for (std::size_t c = 0; c < count; ++c) {
      radius = std::max(radius, (before[c] - middle).length());
    }
    margin += reach_of(middle, radius, least) / (kPixels * m_lens.right.length());
  }
  add_before_eye(number, {places[0], places[1], places[2]}, margin);
  if (count == 4) add_before_eye(number, {places[0], places[2], places[3]}, margin);
}

void TriangleBins::add_before_eye(std::uint32_t number, const std::array<Projected, 3>& corners,
                                  float margin) {
  const auto& [a, b, c] = corners;
  const auto range = [&](float p, float q, float r, int count) {
    const float first = std::floor(std::min({p, q, r}) - margin);
    const float last = std::floor(std::max({p, q, r}) + margin);
    return std::array<int, 2>{int(std::clamp(first, 0.0f, float(count))),
                              int(std::clamp(last, -1.0f, float(count - 1)))};
  };
  const auto [left, right] = range(a.x, b.x, c.x, m_across);
  const auto [top, bottom] = range(a.y, b.y, c.y, m_down);
  const float area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  const float turn = area < 0 ? -1.0f : 1.0f;
  const BlockSide ab(a.x, a.y, b.x, b.y, turn, margin), bc(b.x, b.y, c.x, c.y, turn, margin),
      ca(c.x, c.y, a.x, a.y, turn, margin);
  for (int row = top; row <= bottom; ++row) {
    for (int column = left; column <= right; ++column) {
      const float x = float(column) + 0.5f, y = float(row) + 0.5f;
      if (!(ab.may_hold(x, y) && bc.may_hold(x, y) && ca.may_hold(x, y))) continue;
      const auto block = std::uint32_t(row * m_across + column);
      m_entries.push_back({block, number});
    }
  }
}

void TriangleBins::finish() {
  // Parts of a triangle may share a block.
  std::vector<std::uint32_t> last(std::size_t(m_across) * std::size_t(m_down), UINT32_MAX);
  const auto is_again = [&](const Entry& entry) {
    return std::exchange(last[entry.block], entry.number) == entry.number;
  };
  m_entries.erase(std::remove_if(m_entries.begin(), m_entries.end(), is_again), m_entries.end());
  m_first.assign(std::size_t(m_across) * std::size_t(m_down) + 1, 0);
  for (const Entry& entry : m_entries) ++m_first[entry.block + 1];
  for (std::size_t b = 1; b < m_first.size(); ++b) m_first[b] += m_first[b - 1];
  m_numbers.resize(m_entries.size());
  // Places move up as they are filled, to where the next block begins, and are moved back.
  for (const Entry& entry : m_entries) m_numbers[m_first[entry.block]++] = entry.number;
  std::copy_backward(m_first.begin(), m_first.end() - 1, m_first.end());
  m_first[0] = 0;
}

TriangleList TriangleBins::list_near(const PacketPixels& pixels, std::uint32_t& wanted,
                                     std::uint32_t& listed, TriangleRoom& room) const {
  listed = wanted;
  if (m_is_undivided) {
    wanted = 0;
    return list(0);
  }
  constexpr float kHalfWidth = 3 * kPixels;
  int first = 0;
  while ((wanted >> first & 1) == 0) ++first;
  const PixelCluster near = cluster_around(pixels, first, kHalfWidth, wanted);
  // A place that is no number is near no other.
  listed = near.lanes | 1u << first;
  wanted &= ~listed;
  const auto block = [](float pixel, int count) {
    return int(std::clamp(pixel / kPixels, 0.0f, float(count - 1)));
  };
  return list_in({block(near.left, m_across), block(near.top, m_down), block(near.right, m_across),
                  block(near.bottom, m_down)},
                 room);
}

TriangleList TriangleBins::list_in(const BlockRange& range, TriangleRoom& room) const {
  TriangleList only;
  int with_triangles = 0;
  for (int row = range.top; row <= range.bottom; ++row) {
    for (int column = range.left; column <= range.right; ++column) {
      const TriangleList found = list(row * m_across + column);
      if (found.count == 0) continue;
      if (with_triangles++ == 0) {
        only = found;
        continue;
      }
      if (with_triangles == 2) {
        room.clear();
        room.add(only);
      }
      room.add(found);
    }
  }
  if (with_triangles < 2) return only;
  return room.list();
}

}  // namespace supple
