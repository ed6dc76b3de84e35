// Soft edges of handles: wishes that anchors cut short, element by element (drag_algebra.h).
#include <algorithm>

#include <gtest/gtest.h>

#include "lib/chainmail/ecm.h"
#include "tests/lib/brute_force.h"
#include "tests/support/sanitized.h"

using namespace supple;
using namespace supple::test;

namespace {

struct SoftDrag {
  std::vector<Handle> handles;  // a voxel, and its edge
  std::vector<BruteForce::Grab> grabs;
  std::vector<int> anchors;
  std::vector<Region> fixed;
};

SoftDrag random_soft_drag(std::mt19937& random, const Block& block, const Body& body) {
  SoftDrag drag;
  std::vector<int> taken;
  const auto take = [&] {
    const int node = random_element(random, block);
    if (std::find(taken.begin(), taken.end(), node) != taken.end()) return -1;
    taken.push_back(node);
    return node;
  };
  for (int n = 0; n < 2; ++n) {
    const int node = take();
    if (node < 0) continue;
    drag.anchors.push_back(node);
    drag.fixed.push_back(Region(block.voxel(node)));
  }
  const int core = take();
  if (core < 0) return drag;
  std::array<std::int32_t, 3> by;
  for (auto& way : by) way = std::int32_t(random() % (6u * kVoxel)) - 3 * kVoxel;
  drag.handles.push_back({block.voxel(core), by});
  drag.grabs.push_back({{core}, {by[0], by[1], by[2]}});

  std::vector<Vec3i> voxels;
  for (int n = 0; n < 8; ++n) {
    const int node = take();
    if (node >= 0) voxels.push_back(block.voxel(node));
  }
  if (voxels.empty()) return drag;
  const Region region = Region::of_points(voxels, "edge");
  Handle edge(region, {0, 0, 0}, HandleKind::push);
  edge.is_edge = true;
  BruteForce::Grab grab{{}, {0, 0, 0}, true};
  elements_of(body, region, "grab").for_each([&](Slot slot) {
    const Vec3i v = voxel_of(body.elements, slot) - block.origin;
    grab.nodes.push_back(block.index(v.x, v.y, v.z));
    auto& part = edge.each_by_q.emplace_back();
    for (std::size_t c = 0; c < 3; ++c) part[c] = std::int32_t(by[c] * pick(random, 0, 1));
    grab.each.push_back({part[0], part[1], part[2]});
  });
  drag.handles.push_back(std::move(edge));
  drag.grabs.push_back(std::move(grab));
  return drag;
}

/// The edge as far as the anchors of a body at rest let each of its elements go by itself; how many
/// displacements that cuts short.
int cut_short(const BruteForce& rest, const SoftDrag& drag, BruteForce::Grab& edge) {
  int cut = 0;
  for (int c = 0; c < 3; ++c) {
    for (std::size_t n = 0; n < edge.nodes.size(); ++n) {
      Wide& by = edge.each[n][std::size_t(c)];
      const Wide wish = by;
      for (const int anchor : drag.anchors) {
        if (by > 0) {
          by = std::min(by, rest.distances_from(c, edge.nodes[n])[std::size_t(anchor)]);
        } else {
          by = std::max(by, -rest.distances_from(c, anchor)[std::size_t(edge.nodes[n])]);
        }
      }
      cut += by != wish;
    }
  }
  return cut;
}

}  // namespace

TEST(PropertyEcm, EdgesGoAsFarAsAnchorsLetThemAndShortenNothing) {
  LEFT_OUT_WHEN_SANITIZED();
  std::mt19937 random(19);
  int drags = 0, cut = 0, whole = 0;
  for (int n = 0; n < 200; ++n) {
    Block block = random_block(random, {9, 8, 7});
    if (n % 3 == 0) block.table.links = 26;
    Body body = body_of(block);
    const SoftDrag drag = random_soft_drag(random, block, body);
    if (drag.handles.size() < 2) continue;
    BruteForce rest(block), brute = rest, wishes = rest;
    if (wishes.drag(drag.grabs, {}).conflict) continue;
    std::vector<BruteForce::Grab> grabs = drag.grabs;
    const int cut_here = cut_short(rest, drag, grabs[1]);
    const BruteForce::Outcome expected = brute.drag(grabs, drag.anchors);
    ASSERT_FALSE(expected.conflict);
    const EcmReport report =
        EcmSolver(body, n % 2 ? Engine::flat : Engine::block).drag(drag.handles, drag.fixed);
    ASSERT_EQ(report.fraction_numerator, expected.numerator) << n;
    ASSERT_EQ(report.fraction_denominator, expected.denominator) << n;
    for (int node = 0; node < block.size(); ++node) {
      if (block.element[std::size_t(node)] == 0) continue;
      for (int c = 0; c < 3; ++c) {
        ASSERT_EQ(body.offset(block.voxel(node), c), brute.q[std::size_t(c)][std::size_t(node)]);
      }
    }
    ASSERT_EQ(check_links(body).violated, 0);
    ++drags;
    cut += cut_here;
    whole += cut_here > 0 && expected.numerator == expected.denominator;
  }
  EXPECT_GT(drags, 60);
  EXPECT_GT(cut, 60);
  EXPECT_GE(whole, 4);
}
