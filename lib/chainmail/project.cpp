// Projection of an invalid configuration (design.md section 3).
//
// L_j = max_i (q_i - dist(i, j)) is the least valid majorant of q, U_j = min_i (q_i + dist(j, i))
// its greatest valid minorant. floor((L + U) / 2) is valid, since both are: the differences of the
// sums along a link are at most 2 W, of the floors W. Its largest move is the smallest possible:
// a broken chain of links between i and j costs at least half its excess at one of the ends.
//
// Elements a that are held lie between bounds l_a and u_b, l = u = q for those that stay. With
//   A_j = max over a (l_a - dist(a, j)),   B_j = min over b (u_b + dist(j, b))
// min(L, B) and max(U, A) are valid too, and so is floor of half their sum. If the bounds can be
// met at all, A <= B, and U_a <= q_a <= L_a makes both q_a where l_a = u_a = q_a.
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

HeldBounds held_bounds(const Body& body, int c, const SlotSet& anchored, const Holds& held) {
  HeldBounds bounds;
  anchored.for_each([&](Slot slot) { bounds.least.push_back({slot, body.q[c].at(slot)}); });
  bounds.most = bounds.least;
  for (const Bound& bound : held.at_least[c]) bounds.least.push_back({bound.slot, bound.value});
  for (const Bound& bound : held.at_most[c]) bounds.most.push_back({bound.slot, bound.value});
  return bounds;
}

bool meets(const BrickValues& values, const HeldBounds& bounds) {
  return std::all_of(bounds.least.begin(), bounds.least.end(),
                     [&](const Seed& seed) { return values.at(seed.slot) >= seed.value; }) &&
         std::all_of(bounds.most.begin(), bounds.most.end(),
                     [&](const Seed& seed) { return values.at(seed.slot) <= seed.value; });
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

BrickValues projected(const BrickValues& values, int coordinate, const HeldBounds& bounds,
                      Propagator& propagator, Progress* progress, const FreePieces& pieces) {
  const std::vector<std::size_t> of_pieces =
      pieces.empty() ? std::vector<std::size_t>() : pieces.bricks();
  const auto run = [&](Direction direction, BrickValues& moved, const std::vector<Seed>* seeds) {
    const PropagationTask task{coordinate, direction, moved, nullptr, progress};
    if (seeds == nullptr) {
      propagator.close(task);
    } else {
      propagator.run(task, *seeds);
    }
    while (!pieces.empty()) {
      const auto before = [&](std::size_t brick) { return values.brick_or_zero(brick); };
      const std::vector<Seed> more = pieces.lagging(moved, before, direction, of_pieces);
      if (more.empty()) return;
      propagator.run(task, more);
    }
  };
  BrickValues above = values, below = values;
  run(Direction::raise, above, nullptr);
  run(Direction::lower, below, nullptr);
  if (!bounds.least.empty() || !bounds.most.empty()) {
    BrickValues lowered = above, raised = below;
    run(Direction::lower, lowered, &bounds.most);
    run(Direction::raise, raised, &bounds.least);
    average(lowered, raised);
    if (meets(lowered, bounds)) return lowered;
  }
  average(above, below);
  return above;
}

ProjectionReport project(Body& body, const SlotSet& fixed, const Holds& held) {
  ProjectionReport report;
  report.violated_links = check_links(body).violated;
  if (report.violated_links > 0) {
    SlotSet anchored = held.anchored;
    anchored.add(fixed);
    Propagator propagator(body);
    const FreePieces pieces = body.rigid.empty() ? FreePieces() : FreePieces(body, {});
    std::array<BrickValues, 3> valid;
    std::int64_t largest = 0;
    for (int c = 0; c < 3; ++c) {
      if (body.q[c].empty()) continue;
      valid[c] = projected(body.q[c], c, held_bounds(body, c, anchored, held), propagator, nullptr,
                           pieces);
      largest = std::max(largest, largest_move(body.q[c], valid[c]));
    }
    report.max_move_voxels = double(largest) / kFixedOne;
    body.q.swap(valid);
    anchored.for_each([&](Slot slot) {
      bool has_moved = false;
      for (int c = 0; c < 3; ++c) has_moved |= body.q[c].at(slot) != valid[c].at(slot);
      report.held_moved += has_moved;
    });
    for (int c = 0; c < 3; ++c) {
      for (std::size_t b = 0; b < body.fraction[c].brick_count(); ++b) {
        body.drop_fractions(c, b, valid[c].brick_or_zero(b));
      }
    }
  }
  body.links_known_valid = true;
  return report;
}

}  // namespace supple
