#include "tools/scene/plan/moved_bricks.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <queue>

namespace supple::tools {

namespace {

constexpr int kStride[3] = {64, 8, 1};  // of an axis in a brick

/// The mean slack of links along an axis within a brick, in 2^-16 voxel; of all bricks where it has
/// no such link.
class MeanSlacks {
 public:
  MeanSlacks(const Body& body, int coordinate) : m_of(3 * body.elements.brick_count(), -1) {
    for (std::size_t b = 0; b < body.elements.brick_count(); ++b) {
      for (int axis = 0; axis < 3; ++axis)
        m_of[3 * b + std::size_t(axis)] = mean(body, coordinate, b, axis);
    }
    std::array<double, 3> sum{}, count{};
    for (std::size_t n = 0; n < m_of.size(); ++n) {
      if (m_of[n] < 0) continue;
      sum[n % 3] += m_of[n];
      ++count[n % 3];
    }
    for (std::size_t n = 0; n < m_of.size(); ++n) {
      if (m_of[n] < 0) m_of[n] = count[n % 3] > 0 ? sum[n % 3] / count[n % 3] : 0;
    }
  }
  double of(std::size_t b, int axis) const { return m_of[3 * b + std::size_t(axis)]; }

 private:
  static double mean(const Body& body, int coordinate, std::size_t b, int axis) {
    const std::uint8_t* const classes = &body.classes[b * kBrickVoxels];
    const BrickMask& mask = body.elements.mask(b);
    double sum = 0;
    int count = 0;
    for (int n = 0; n < kBrickVoxels; n += 7) {  // of all rows alike, as 7 and 8 share no factor
      const Vec3i at = brick_local(n);
      if (at[axis] == kBrickDim - 1 || !mask_test(mask, n) || !mask_test(mask, n + kStride[axis])) {
        continue;
      }
      const std::uint8_t a = classes[n], other = classes[n + kStride[axis]];
      const double upper = body.slacks.upper(axis, coordinate, a, other);
      const double lower = body.slacks.lower(axis, coordinate, a, other);
      sum += (upper + lower) / 2;
      ++count;
    }
    return count > 0 ? sum / count : -1;
  }

  std::vector<double> m_of;
};

struct Waiting {
  double left;
  std::size_t brick;
  bool operator<(const Waiting& other) const { return left < other.left; }
};

/// Finds the rest of the handles' way at the middle of every brick; negative: not reached.
std::vector<double> ways_left(const Body& body, const std::vector<PlannedGrip>& grips,
                              int coordinate, const MeanSlacks& slacks) {
  std::vector<double> left(body.elements.brick_count(), -1);
  std::priority_queue<Waiting> queue;
  const auto offer = [&](std::size_t brick, double way) {
    if (way <= left[brick]) return;
    left[brick] = way;
    queue.push({way, brick});
  };
  for (const PlannedGrip& grip : grips) {
    const double way = std::abs(double(grip.by_q[std::size_t(coordinate)]));
    for (const SlotSet::Brick& entry : grip.elements.bricks()) offer(entry.brick, way);
  }
  while (!queue.empty()) {
    const Waiting next = queue.top();
    queue.pop();
    if (next.left < left[next.brick]) continue;
    for (int face = 0; face < 6; ++face) {
      const std::int32_t beside = body.elements.neighbour(next.brick, face);
      if (beside < 0) continue;
      const double half = kBrickDim / 2.0;
      const double cost =
          half * (slacks.of(next.brick, face / 2) + slacks.of(std::size_t(beside), face / 2));
      // The brick counts as reached if the way reaches its near side.
      const double way = next.left - cost;
      if (way > -half * slacks.of(std::size_t(beside), face / 2))
        offer(std::size_t(beside), std::max(way, 0.0));
    }
  }
  return left;
}

}  // namespace

std::int64_t MovedBricks::count(int coordinate) const {
  const auto& of = bricks[std::size_t(coordinate)];
  return std::count(of.begin(), of.end(), std::uint8_t(1));
}

std::int64_t MovedBricks::count() const {
  std::int64_t sum = 0;
  const std::size_t all = std::max({bricks[0].size(), bricks[1].size(), bricks[2].size()});
  for (std::size_t b = 0; b < all; ++b) sum += moves_brick(b);
  return sum;
}

bool MovedBricks::moves_brick(std::size_t b) const {
  return std::any_of(bricks.begin(), bricks.end(),
                     [&](const auto& of) { return b < of.size() && of[b] != 0; });
}

void MovedBricks::add_all(int coordinate, const BrickTopology& topology) {
  bricks[std::size_t(coordinate)].assign(topology.brick_count(), 1);
  elements[std::size_t(coordinate)] = double(topology.active_count());
}

void MovedBricks::add(const MovedBricks& other) {
  split += other.split;
  for (std::size_t c = 0; c < 3; ++c) {
    elements[c] = std::max(elements[c], other.elements[c]);
    if (bricks[c].size() < other.bricks[c].size()) bricks[c].resize(other.bricks[c].size(), 0);
    for (std::size_t b = 0; b < other.bricks[c].size(); ++b) bricks[c][b] |= other.bricks[c][b];
  }
}

MovedBricks reach_of(const Body& body, const std::vector<PlannedGrip>& grips) {
  MovedBricks moved;
  for (int c = 0; c < 3; ++c) {
    const bool is_asked = std::any_of(grips.begin(), grips.end(), [&](const PlannedGrip& grip) {
      return grip.by_q[std::size_t(c)] != 0;
    });
    if (!is_asked) continue;
    const MeanSlacks slacks(body, c);
    const std::vector<double> left = ways_left(body, grips, c, slacks);
    auto& bricks = moved.bricks[std::size_t(c)];
    bricks.resize(left.size(), 0);
    for (std::size_t b = 0; b < left.size(); ++b) {
      if (left[b] < 0) continue;
      bricks[b] = 1;
      moved.elements[std::size_t(c)] += mask_count(body.elements.mask(b));
    }
  }
  return moved;
}

}  // namespace supple::tools
