// Projection of an invalid configuration (design.md section 3).
//
// L_j = max_i (q_i - dist(i, j)) is the least valid majorant of q, U_j = min_i (q_i + dist(j, i))
// its greatest valid minorant. floor((L + U) / 2) is valid, since both are: the differences of the
// sums along a link are at most 2 W, of the floors W. Its largest move is the smallest possible:
// a broken chain of links between i and j costs at least half its excess at one of the ends.
#include <algorithm>
#include <cstdlib>

#include "lib/chainmail/ecm.h"
#include "lib/chainmail/propagate.h"

namespace supple {

namespace {

bool near_stored(const BrickTopology& elements, const BrickValues& values, std::size_t b) {
  if (values.brick(b) != nullptr) return true;
  for (int face = 0; face < 6; ++face) {
    const std::int32_t other = elements.neighbour(b, face);
    if (other >= 0 && values.brick(std::size_t(other)) != nullptr) return true;
  }
  return false;
}

/// Every element that may have a broken link, at its value; only those that have one will spread.
/// Links between bricks that are not stored hold, since both ends are at rest.
std::vector<Seed> seeds_of(const Body& body, const BrickValues& values) {
  std::vector<Seed> seeds;
  for (std::size_t b = 0; b < body.elements.brick_count(); ++b) {
    if (!near_stored(body.elements, values, b)) continue;
    const std::int32_t* present = values.brick_or_zero(b);
    for_each_active(body.elements.mask(b), [&](int offset) {
      seeds.push_back({Slot(b * kBrickVoxels + std::size_t(offset)), present[offset]});
    });
  }
  return seeds;
}

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

BrickValues projected(const Body& body, int c) {
  const std::vector<Seed> seeds = seeds_of(body, body.q[c]);
  BrickValues above = body.q[c], below = body.q[c];
  Propagator propagator(body, c, nullptr);
  propagator.run(Direction::raise, seeds, above, nullptr);
  propagator.run(Direction::lower, seeds, below, nullptr);
  average(above, below);
  return above;
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

ProjectionReport project(Body& body) {
  ProjectionReport report;
  report.violated_links = check_links(body).violated;
  if (report.violated_links > 0) {
    std::array<BrickValues, 3> valid;
    std::int64_t largest = 0;
    for (int c = 0; c < 3; ++c) {
      if (body.q[c].empty()) continue;
      valid[c] = projected(body, c);
      largest = std::max(largest, largest_move(body.q[c], valid[c]));
    }
    report.max_move_voxels = double(largest) / kFixedOne;
    body.q.swap(valid);
  }
  body.links_known_valid = true;
  return report;
}

}  // namespace supple
