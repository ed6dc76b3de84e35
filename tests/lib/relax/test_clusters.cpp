// Elements that step together, against a search by definition.
#include <algorithm>
#include <array>
#include <map>
#include <queue>
#include <random>
#include <set>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "lib/relax/clusters.h"
#include "tests/lib/relaxed_bodies.h"
#include "tests/support/sanitized.h"

namespace supple {
namespace {

using Link = std::tuple<Slot, Slot, bool, bool>;  // inside, outside, inside is low, shared

/// Members and links out of each cluster.
using Found = std::vector<std::pair<std::vector<Slot>, std::vector<Link>>>;

Found found(const Clusters& clusters) {
  Found all;
  for (std::size_t c = 0; c < clusters.count(); ++c) {
    const auto member = clusters.members.begin();
    all.push_back({{member + clusters.first[c], member + clusters.first[c + 1]}, {}});
    for (std::uint32_t n = clusters.first_link[c]; n < clusters.first_link[c + 1]; ++n) {
      const Clusters::Boundary& link = clusters.boundary[n];
      all.back().second.push_back({link.inside, link.outside, link.inside_is_low, link.shared});
    }
  }
  return all;
}

/// Finds clusters by flooding from each element, in ascending order.
Found flooded(const Body& body, const LinkTable& table, const std::set<std::uint32_t>& bricks,
              const Joins& joins) {
  std::map<Slot, std::set<Slot>> joined;
  for (const std::uint32_t b : bricks) {
    for_each_link(body, table.links(), b, [&](int kind, Slot low, Slot high) {
      if (!joins(kind, low, high)) return;
      joined[low].insert(high);
      joined[high].insert(low);
    });
  }
  Found all;
  std::set<Slot> seen;
  for (const auto& [start, beside] : joined) {
    if (seen.count(start) > 0) continue;
    std::set<Slot> members = {start};
    std::queue<Slot> open({start});
    for (; !open.empty(); open.pop()) {
      for (const Slot next : joined[open.front()]) {
        if (members.insert(next).second) open.push(next);
      }
    }
    seen.insert(members.begin(), members.end());
    std::vector<Link> links;
    for (const Slot slot : members) {
      for_each_neighbour(body, table.links(), slot, [&](int, bool upwards, Slot other) {
        if (members.count(other) == 0) {
          links.push_back({slot, other, upwards, joined.count(other) > 0});
        }
      });
    }
    all.push_back({{members.begin(), members.end()}, links});
  }
  return all;
}

TEST(PropertyClusters, GrowingOnesAreThoseOfAllBricksAtOnce) {
  LEFT_OUT_WHEN_SANITIZED();
  std::mt19937 random(7);
  int merged = 0;
  for (int round = 0; round < 12; ++round) {
    const int links = std::array{6, 18, 26}[std::size_t(round % 3)];
    const Body body = test::dragged(random, {28, 20, 24}, links).body;
    const LinkTable table(body, round % 3, RigidLinks::absent);
    const auto part = unsigned(round % 4 + 1);  // of ten links, with 26 of thirty
    const Joins joins = [&](int kind, Slot low, Slot high) {
      return (low * 2654435761u ^ high * 40503u ^ unsigned(kind) * 97u) % (10 * links / 6) < part;
    };
    GrowingClusters growing(body, table, joins);
    std::vector<std::uint32_t> left(body.elements.brick_count());
    for (std::size_t b = 0; b < left.size(); ++b) left[b] = std::uint32_t(b);
    std::shuffle(left.begin(), left.end(), random);
    std::set<std::uint32_t> known;
    std::size_t before = 0;
    while (!left.empty()) {
      const std::size_t count = std::min<std::size_t>(left.size(), 1 + random() % 9);
      std::vector<std::uint32_t> fresh(left.end() - std::ptrdiff_t(count), left.end());
      left.resize(left.size() - count);
      std::sort(fresh.begin(), fresh.end());
      known.insert(fresh.begin(), fresh.end());
      growing.add(fresh);
      const Found now = found(growing.find());
      ASSERT_EQ(now, flooded(body, table, known, joins)) << "round " << round;
      merged += now.size() < before;
      before = now.size();
    }
    EXPECT_EQ(found(find_clusters(body, table, {known.begin(), known.end()}, joins)),
              found(growing.find()));
  }
  EXPECT_GT(merged, 0);
}

}  // namespace
}  // namespace supple
