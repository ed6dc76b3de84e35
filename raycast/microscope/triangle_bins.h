// Triangles by the blocks of a perspective picture in which they may be met, so that rays of a
// block ask a few triangles and no tree: scenes change with every picture, and trees take longer to
// build and to walk. The lamp's light is such a picture, too (E. Haines and D. Greenberg, The light
// buffer, 1986).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "raycast/microscope/eye_lanes.h"
#include "raycast/microscope/packet.h"
#include "volumes/base/vec.h"

namespace supple {

/// Numbers of triangles, each once.
struct TriangleList {
  const std::uint32_t* begin = nullptr;
  int count = 0;
};

/// Light from a disc that is perpendicular to the eye's direction, to places within a ball.
struct DiscReach {
  float radius_mm = 0;
  Vec3f centre{0, 0, 0};
  float ball_mm = 0;  // the ball's radius; 0: places may be anywhere
};

/// Room of a thread for a list of its own, and which triangles are in it.
struct TriangleRoom {
  std::vector<std::uint32_t> numbers, turns;  // turns: of triangle n the last list that holds it
  std::uint32_t turn = 0;

  void clear();
  void add(const TriangleList& list);
  TriangleList list() const { return {numbers.data(), int(numbers.size())}; }
};

class TriangleBins {
 public:
  static constexpr int kPixels = 4;  // across a block

  /// Forgets all triangles.
  void begin(const LensFloats& lens, int width, int height, const DiscReach& reach = {});
  /// Forgets all triangles; a single block holds whatever is added.
  void begin_undivided();
  /// Adds a triangle with a number above those before it to all blocks that it may touch, and
  /// rather to one more.
  void add(std::uint32_t number, const std::array<Vec3f, 3>& corners);
  /// Makes the lists of what was added.
  void finish();

  TriangleList at_pixel(int x, int y) const { return list(y / kPixels * m_across + x / kPixels); }
  /// Pixel coordinates of places before the eye.
  PacketPixels pixels_of(const LaneVectors& places) const { return project_packet(m_lens, places); }
  /// The list of the first wanted pixel and of all that are near it, which are then no longer
  /// wanted but `listed`. It may be made in `room`.
  TriangleList list_near(const PacketPixels& pixels, std::uint32_t& wanted, std::uint32_t& listed,
                         TriangleRoom& room) const;
  bool is_empty() const { return m_numbers.empty(); }

 private:
  struct Entry {
    std::uint32_t block, number;
  };
  struct Projected {
    float x, y;  // in blocks
  };
  /// From one corner to the other, both included.
  struct BlockRange {
    int left, top, right, bottom;
  };
  void add_part(std::uint32_t number, const std::array<Vec3f, 3>& corners, int halvings);
  Projected project(const Vec3f& from_eye, float depth) const;
  float reach_of(const Vec3f& middle, float radius_mm, float depth) const;
  TriangleList list_in(const BlockRange& range, TriangleRoom& room) const;
  void add_before_eye(std::uint32_t number, const std::array<Projected, 3>& corners, float margin);
  TriangleList list(int block) const {
    const std::uint32_t first = m_first[std::size_t(block)];
    return {m_numbers.data() + first, int(m_first[std::size_t(block) + 1] - first)};
  }

  LensFloats m_lens{};
  DiscReach m_reach;
  int m_across = 1, m_down = 1;
  bool m_is_undivided = false;
  std::vector<Entry> m_entries;
  std::vector<std::uint32_t> m_first, m_numbers;  // those of block b from m_first[b] on
};

}  // namespace supple
