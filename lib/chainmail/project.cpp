// Projection of an invalid configuration (design.md section 3).
//
// L_j = max_i (q_i - dist(i, j)) is the least valid majorant of q, U_j = min_i (q_i + dist(j, i))
// its greatest valid minorant. floor((L + U) / 2) is valid, since both are: the differences of the
// sums along a link are at most 2 W, of the floors W. Its largest move is the smallest possible:
// a broken chain of links between i and j costs at least half its excess at one of the ends.
#include <algorithm>
#include <cstdlib>

#include "lib/chainmail/ecm.h"
#include "lib/chainmail/projection.h"

namespace supple {

namespace {

/// floor((above + below) / 2) in place of `above`.
void average(BrickValues& above, const BrickValues& below) {
  for (std::size_t b = 0; b < above.brick_count(); ++b) {
    if (above.brick(b) == nullptr && below.brick(b) == nullptr) continue;
    std::int32_t* upper = above.touch(b);
    const std::int32_t* lower = below.brick_or_zero(b);
    for (int offset = 0; offset < kBrickVoxels; ++offset) {
      const std::int64_t sum = std::int64_t(upper[offset]) + lower[offset];
      upper[offset] = std::int32_t(sum >= 0 ? sum / 2 : -((1 - sum) / 2));
    }
  }
}

std::int64_t largest_move(const BrickValues& before, const BrickValues& after) {
  std::int64_t largest = 0;
  for (std::size_t b = 0; b < after.brick_count(); ++b) {
    if (after.brick(b) == nullptr) continue;
    const std::int32_t* from = before.brick_or_zero(b);
    const std::int32_t* to = after.brick(b);
    for (int offset = 0; offset < kBrickVoxels; ++offset) {
      largest = std::max(largest, std::abs(std::int64_t(to[offset]) - from[offset]));
    }
  }
  return largest;
}

}  // namespace

BrickValues projected(const BrickValues& values, int coordinate, Propagator& propagator,
                      Progress* progress) {
  BrickValues above = values, below = values;
  propagator.close({coordinate, Direction::raise, above, nullptr, progress});
  propagator.close({coordinate, Direction::lower, below, nullptr, progress});
  average(above, below);
  return above;
}

ProjectionReport project(Body& body) {
  ProjectionReport report;
  report.violated_links = check_links(body).violated;
  if (report.violated_links > 0) {
    Propagator propagator(body);
    std::array<BrickValues, 3> valid;
    std::int64_t largest = 0;
    for (int c = 0; c < 3; ++c) {
      if (body.q[c].empty()) continue;
      valid[c] = projected(body.q[c], c, propagator);
      largest = std::max(largest, largest_move(body.q[c], valid[c]));
    }
    report.max_move_voxels = double(largest) / kFixedOne;
    body.q.swap(valid);
  }
  body.links_known_valid = true;
  return report;
}

}  // namespace supple
