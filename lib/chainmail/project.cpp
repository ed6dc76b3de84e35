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

/// Every element at its value; only those at broken links will spread further.
std::vector<Seed> all_elements(const Body& body, const std::vector<std::int32_t>& values) {
  std::vector<Seed> seeds;
  seeds.reserve(std::size_t(body.elements.active_count()));
  for_each_element(body.elements, [&](Slot slot) { seeds.push_back({slot, values[slot]}); });
  return seeds;
}

std::vector<std::int32_t> projected(const Body& body, int c) {
  const std::vector<Seed> seeds = all_elements(body, body.q[c]);
  std::vector<std::int32_t> above = body.q[c], below = body.q[c];
  Propagator propagator(body, c, nullptr);
  propagator.run(Direction::raise, seeds, above, nullptr);
  propagator.run(Direction::lower, seeds, below, nullptr);
  for (std::size_t slot = 0; slot < above.size(); ++slot) {
    const std::int64_t sum = std::int64_t(above[slot]) + below[slot];
    above[slot] = std::int32_t(sum >= 0 ? sum / 2 : -((1 - sum) / 2));
  }
  return above;
}

}  // namespace

ProjectionReport project(Body& body) {
  ProjectionReport report;
  report.violated_links = check_links(body).violated;
  if (report.violated_links > 0) {
    std::array<std::vector<std::int32_t>, 3> valid;
    std::int64_t largest = 0;
    for (int c = 0; c < 3; ++c) {
      if (body.q[c].empty()) continue;
      valid[c] = projected(body, c);
      for (std::size_t slot = 0; slot < valid[c].size(); ++slot) {
        const std::int64_t move = std::int64_t(valid[c][slot]) - body.q[c][slot];
        largest = std::max(largest, std::abs(move));
      }
    }
    report.max_move_voxels = double(largest) / kFixedOne;
    body.q.swap(valid);
  }
  body.links_known_valid = true;
  return report;
}

}  // namespace supple
