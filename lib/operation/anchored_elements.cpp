#include "lib/operation/anchored_elements.h"

#include <utility>

#include "volumes/grid/mask_steps.h"

namespace supple {

namespace {

constexpr BrickMask kNoVoxel{};

/// A flood that goes on from brick to brick.
class Flood {
 public:
  Flood(const BrickTopology& elements, const LinkCuts& cuts, const std::vector<BrickMask>& left)
      : m_elements(elements),
        m_cuts(cuts),
        m_left(left),
        m_reached(left.size(), kNoVoxel),
        m_waits(left.size(), 0) {}

  void begin(std::size_t brick, const BrickMask& anchors) {
    m_reached[brick] = anchors;
    keep(m_left[brick], m_reached[brick]);
    wait_around(brick);
  }

  std::vector<BrickMask> run() {
    for (std::size_t n = 0; n < m_queue.size(); ++n) {
      const std::size_t brick = m_queue[n];
      m_waits[brick] = 0;
      if (fill(brick)) wait_around(brick);
    }
    return std::move(m_reached);
  }

 private:
  const BrickMask& reached(std::int32_t brick) const {
    return brick < 0 ? kNoVoxel : m_reached[std::size_t(brick)];
  }
  /// Voxels whose links to the next ones along the axis are cut.
  const BrickMask& cut(std::int32_t brick, int axis) const {
    const auto* cuts = brick < 0 || m_cuts.empty() ? nullptr : m_cuts.brick(std::size_t(brick));
    return cuts == nullptr ? kNoVoxel : (*cuts)[std::size_t(axis)];
  }
  void wait_around(std::size_t brick) {
    const auto wait = [&](std::int32_t other) {
      if (other < 0 || std::exchange(m_waits[std::size_t(other)], 1) != 0) return;
      m_queue.push_back(std::size_t(other));
    };
    wait(std::int32_t(brick));
    for (int side = 0; side < 6; ++side) wait(m_elements.neighbour(brick, side));
  }

  /// One step along all axes, from within the brick and from the bricks around it.
  BrickMask step_from(std::size_t brick) const {
    const auto own = std::int32_t(brick);
    BrickMask next = m_reached[brick];
    for (int axis = 0; axis < 3; ++axis) {
      const std::int32_t below = m_elements.neighbour(brick, 2 * axis);
      BrickMask goes_up = m_reached[brick], comes_up = reached(below);
      take_out(cut(own, axis), goes_up);
      take_out(cut(below, axis), comes_up);
      add(shifted_up(goes_up, comes_up, axis), next);
      BrickMask down =
          shifted_down(m_reached[brick], reached(m_elements.neighbour(brick, 2 * axis + 1)), axis);
      take_out(cut(own, axis), down);
      add(down, next);
    }
    keep(m_left[brick], next);
    return next;
  }

  /// Goes on in a brick until nothing is added; true where something was.
  bool fill(std::size_t brick) {
    if (m_reached[brick] == m_left[brick]) return false;
    bool has_grown = false;
    for (BrickMask next = step_from(brick); next != m_reached[brick]; next = step_from(brick)) {
      m_reached[brick] = next;
      has_grown = true;
    }
    return has_grown;
  }

  const BrickTopology& m_elements;
  const LinkCuts& m_cuts;
  const std::vector<BrickMask>& m_left;
  std::vector<BrickMask> m_reached;
  std::vector<char> m_waits;         // per brick: it waits in the queue
  std::vector<std::size_t> m_queue;  // bricks
};

}  // namespace

std::vector<BrickMask> anchored_elements(const BrickTopology& elements, const LinkCuts& cuts,
                                         const std::vector<BrickMask>& left,
                                         const SlotSet& anchors) {
  Flood flood(elements, cuts, left);
  for (const SlotSet::Brick& held : anchors.bricks()) flood.begin(held.brick, held.mask);
  return flood.run();
}

}  // namespace supple
