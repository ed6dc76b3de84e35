// Checks every link against its limits and against the no-fold condition (design.md section 2).
//
// No cell folds when every column of F = I + grad u is diagonally dominant with a positive
// diagonal, in mm relative to the rest lengths: min_length > shear1 + shear2 on each link.
#include <algorithm>
#include <array>

#include "lib/body/body.h"
#include "lib/body/link_masks.h"
#include "lib/body/slot_set.h"
#include "volumes/base/parallel.h"

namespace supple {

namespace {

/// Table of the links, by axis and classes of both ends, that can fold a cell; like SlackTable.
class FoldTable {
 public:
  explicit FoldTable(const Body& body) : m_stride(body.slacks.stride()) {
    const IndexBox& bounds = body.elements.active_bounds();
    const MaterialClasses classes(body.material);
    for (int axis = 0; axis < 3; ++axis) {
      m_can_fold[axis].resize(std::size_t(255) * m_stride + 256);
      const int first = axis == 0 ? 1 : 0, second = axis == 2 ? 1 : 2;
      const bool thick1 = bounds.hi[first] > bounds.lo[first];
      const bool thick2 = bounds.hi[second] > bounds.lo[second];
      classes.for_each_pair(axis, [&](int a, int b, const LinkLimits& limits) {
        const double shear = (thick1 ? limits.shear1 : 0) + (thick2 ? limits.shear2 : 0);
        m_can_fold[axis][std::size_t(a) * m_stride + b] = limits.min_length <= shear;
      });
    }
  }
  bool can_fold(int axis, std::uint8_t a, std::uint8_t b) const {
    return m_can_fold[axis][a * m_stride + b] != 0;
  }

 private:
  int m_stride;
  std::array<std::vector<std::uint8_t>, 3> m_can_fold;
};

/// Units by which coordinate c of a link exceeds its limits; 0 when it holds.
std::int64_t excess_of(const Body& body, int axis, Slot low, Slot high, int c) {
  if (body.q[c].empty()) return 0;
  const std::uint8_t a = body.classes[low], b = body.classes[high];
  const std::int64_t stretch = std::int64_t(body.q[c].at(high)) - body.q[c].at(low);
  const std::int32_t limit =
      stretch > 0 ? body.slacks.upper(axis, c, a, b) : body.slacks.lower(axis, c, a, b);
  if (limit >= kUnlimitedSlack) return 0;
  return std::max<std::int64_t>(0, std::abs(stretch) - limit);
}

struct Counts {
  std::int64_t links = 0, violated = 0, worst = 0;
  bool can_fold = false;
};

/// Diagonals towards later voxels.
void count_diagonals(const Body& body, std::size_t b, Counts& counts) {
  const BrickNeighbours bricks = neighbours_of(body.elements, b);
  LinkMasks links;
  find_links(body.elements, body.cuts, body.slacks.links(), bricks, links);
  for (int direction = kNoStep + 1; direction < kDirections; ++direction) {
    if (!is_diagonal(direction)) continue;
    const LinkStep step = step_of_direction(direction);
    for_each_active(links[std::size_t(direction)], [&](int offset) {
      const Vec3i end = brick_local(offset) + Vec3i(step[0], step[1], step[2]);
      const auto other =
          std::size_t(bricks[std::size_t(direction_of_step(end.x >> 3, end.y >> 3, end.z >> 3))]);
      const int there = brick_offset(end);
      const std::uint8_t from_class = body.classes[b * kBrickVoxels + std::size_t(offset)];
      const std::uint8_t to_class = body.classes[other * kBrickVoxels + std::size_t(there)];
      std::int64_t excess = 0;
      for (int c = 0; c < 3; ++c) {
        const BrickValues& q = body.q[std::size_t(c)];
        if (q.empty()) continue;
        const std::int64_t stretch =
            std::int64_t(q.brick_or_zero(other)[there]) - q.brick_or_zero(b)[offset];
        if (stretch == 0) continue;
        const std::int32_t limit = body.slacks.fall(
            stretch > 0 ? opposite_direction(direction) : direction, c, from_class, to_class);
        if (limit < kUnlimitedSlack) excess = std::max(excess, std::abs(stretch) - limit);
      }
      ++counts.links;
      counts.violated += excess > 0;
      counts.worst = std::max(counts.worst, excess);
    });
  }
}

void count_brick(const Body& body, const FoldTable& folds, std::size_t b, Counts& counts) {
  for_each_link(body.elements, body.cuts, b, [&](int axis, Slot low, Slot high) {
    ++counts.links;
    counts.can_fold |= folds.can_fold(axis, body.classes[low], body.classes[high]);
    std::int64_t excess = 0;
    for (int c = 0; c < 3; ++c) {
      excess = std::max(excess, excess_of(body, axis, low, high, c));
    }
    counts.violated += excess > 0;
    counts.worst = std::max(counts.worst, excess);
  });
  if (body.slacks.links() != 6) count_diagonals(body, b, counts);
}

}  // namespace

LinkCheck check_links(const Body& body) {
  const FoldTable folds(body);
  const Counts total = parallel_reduce(
      body.elements.brick_count(), Grain{64}, Counts{},
      [&](std::size_t b, Counts& counts) { count_brick(body, folds, b, counts); },
      [](const Counts& x, const Counts& y) {
        return Counts{x.links + y.links, x.violated + y.violated, std::max(x.worst, y.worst),
                      x.can_fold || y.can_fold};
      });
  const bool fold_free = !total.can_fold && body.cuts.empty();
  return {total.links, total.violated, double(total.worst) / kFixedOne, fold_free};
}

}  // namespace supple
