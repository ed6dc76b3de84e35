// Regions and push handles against brute force, bit for bit: sequences of drags that keep hold of
// what they moved.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

#include "lib/chainmail/ecm.h"
#include "tests/lib/brute_force.h"
#include "tests/support/sanitized.h"

using namespace supple;
using namespace supple::test;

namespace {

struct RandomRegion {
  Region region;
  std::vector<int> nodes;
};

/// A voxel, a box, points (with duplicates) or a mask of elements that are not taken yet; no nodes
/// when it would meet one that is.
RandomRegion random_region(std::mt19937& random, const Block& block, std::vector<char>& taken) {
  const int corner = random_element(random, block);
  const Vec3i lo = block.voxel(corner);
  const unsigned kind = random() % 4;
  IndexBox box{lo, lo};
  if (kind != 0) box.hi += Vec3i(int(random() % 4), int(random() % 3), int(random() % 3));
  std::vector<int> nodes;
  for (int n = 0; n < block.size(); ++n) {
    const bool inside = block.element[n] && box.contains(block.voxel(n));
    // Points and masks need not be compact.
    if (inside && (kind < 2 || n == corner || random() % 2)) nodes.push_back(n);
  }
  if (std::any_of(nodes.begin(), nodes.end(), [&](int n) { return taken[n]; })) return {lo, {}};
  for (const int n : nodes) taken[n] = 1;
  if (kind < 2) return {box, nodes};

  std::vector<Vec3i> voxels;
  for (const int n : nodes) voxels.push_back(block.voxel(n));
  if (kind == 2) {
    voxels.push_back(voxels.front());
    return {Region::of_points(voxels, "points.csv:" + std::to_string(corner)), nodes};
  }
  std::vector<Vec3i> origins;
  std::vector<BrickMask> masks;
  for (const Vec3i& voxel : voxels) {
    const Vec3i origin(voxel.x & ~7, voxel.y & ~7, voxel.z & ~7);
    auto found = std::find(origins.begin(), origins.end(), origin);
    if (found == origins.end()) {
      found = origins.insert(found, origin);
      masks.push_back({});
    }
    mask_set(masks[std::size_t(found - origins.begin())], brick_offset(voxel));
  }
  return {Region::of_mask(std::make_shared<BrickTopology>(origins, masks),
                          "label " + std::to_string(corner)),
          nodes};
}

RandomDrag drag_of_regions(std::mt19937& random, const Block& block) {
  RandomDrag drag;
  std::vector<char> taken(std::size_t(block.size()), 0);
  if (random() % 3 == 0) {
    const RandomRegion fixed = random_region(random, block, taken);
    drag.fixed.push_back(fixed.region);
    drag.anchors = fixed.nodes;
  }
  const double reach = std::pow(10.0, std::uniform_real_distribution<double>(-1, 1.5)(random));
  std::array<std::int32_t, 3> common{};
  const int handles = 1 + int(random() % 4);
  for (int h = 0; h < handles; ++h) {
    const RandomRegion grabbed = random_region(random, block, taken);
    if (grabbed.nodes.empty()) continue;
    std::array<std::int32_t, 3> by{};
    for (int c = 0; c < 3; ++c) {
      const double voxels = std::uniform_real_distribution<double>(-reach, reach)(random);
      const unsigned choice = random() % 8;
      by[c] = choice == 0                          ? 0
              : choice < 3 || drag.handles.empty() ? std::int32_t(voxels * 65536)
              : choice < 5                         ? common[c]
                                                   : common[c] + std::int32_t(voxels * 3000);
    }
    if (drag.handles.empty()) common = by;
    const bool push = random() % 2;
    drag.handles.push_back({grabbed.region, by, push ? HandleKind::push : HandleKind::two_sided});
    drag.grabs.push_back({grabbed.nodes, {by[0], by[1], by[2]}, push});
  }
  return drag;
}

/// The same handles again, moved back or elsewhere, some among the same anchors.
RandomDrag moved_again(std::mt19937& random, RandomDrag drag) {
  if (random() % 2) {
    drag.fixed.clear();
    drag.anchors.clear();
  }
  for (std::size_t h = 0; h < drag.handles.size(); ++h) {
    for (int c = 0; c < 3; ++c) {
      std::int32_t& by = drag.handles[h].by_q[std::size_t(c)];
      by = random() % 3 != 0 ? -by : by / 2 + std::int32_t(random() % 20000);
      drag.grabs[h].by[std::size_t(c)] = by;
    }
  }
  return drag;
}

/// Some handles no longer move as one: every element goes a way of its own, near that of all.
void send_apart(std::mt19937& random, const Block& block, const Body& body, RandomDrag& drag) {
  for (std::size_t h = 0; h < drag.handles.size(); ++h) {
    Handle& handle = drag.handles[h];
    BruteForce::Grab& grab = drag.grabs[h];
    handle.each_by_q.clear();
    grab.each.assign(random() % 2 * grab.nodes.size(), grab.by);
    if (grab.each.empty()) continue;
    const int apart = 1 + int(random() % 6000);
    elements_of(body, handle.region, "grab").for_each([&](Slot slot) {
      auto& by = handle.each_by_q.emplace_back(handle.by_q);
      for (auto& along : by)
        along = along / int(1 + random() % 2) + int(random() % unsigned(apart));
      const Vec3i at = voxel_of(body.elements, slot);
      for (std::size_t n = 0; n < grab.nodes.size(); ++n) {
        if (block.voxel(grab.nodes[n]) == at) grab.each[n] = {by[0], by[1], by[2]};
      }
    });
  }
}

/// The message names the handle or the two handles whose missing distance is the largest there is.
void expect_names_regions(const std::string& message, const RandomDrag& drag, const Block& block,
                          const BruteForce& brute, const BruteForce::Outcome& outcome) {
  const std::size_t found = message.find(": found targets ");
  ASSERT_NE(found, std::string::npos) << message;
  double missing_mm = 0;
  char axis = ' ';
  ASSERT_EQ(std::sscanf(message.c_str() + found,
                        ": found targets %lf mm further apart along axis %c", &missing_mm, &axis),
            2);
  EXPECT_EQ(axis, "ijk"[outcome.conflict_axis]);
  const double expected_mm =
      double(outcome.missing) / 65536 * block.spacing_mm[outcome.conflict_axis];
  EXPECT_NEAR(missing_mm, expected_mm, 1e-5 * expected_mm);
  for (std::size_t a = 0; a < drag.handles.size(); ++a) {
    for (std::size_t b = 0; b < drag.handles.size(); ++b) {
      std::string names = "grab " + drag.handles[a].region.name();
      if (a != b) names += " and " + drag.handles[b].region.name();
      if (message.compare(0, found, names) != 0) continue;
      EXPECT_EQ(brute.missing(outcome.conflict_axis, drag.grabs[a], drag.grabs[b]),
                outcome.missing);
      return;
    }
  }
  ADD_FAILURE() << message;
}

struct RegionTally {
  int moved = 0, conflicts = 0, shortened = 0, held = 0;
};

/// Some drags of one random body, each among what the earlier ones hold.
void run_regions(unsigned seed, const Vec3i& max_dims, bool moves_apart, RegionTally& tally) {
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  Block block = random_block(random, max_dims);
  if (random() % 4 == 0) cut_randomly(random, block);
  Body body = body_of(block);
  EcmSolver solver(body);
  BruteForce brute(block);
  Holds holds;
  RandomDrag drag;
  for (int n = 0; n < 5; ++n) {
    if (random() % 6 == 0) {
      holds = {};
      brute.let_go();
    }
    drag = random() % 3 == 0 ? moved_again(random, drag) : drag_of_regions(random, block);
    if (moves_apart) send_apart(random, block, body, drag);
    const BruteForce::Outcome expected = brute.drag(drag.grabs, drag.anchors, true);
    EcmReport report;
    const std::string error =
        input_error([&] { report = solver.drag(drag.handles, drag.fixed, holds); });
    ASSERT_EQ(!error.empty(), expected.conflict) << error;
    if (expected.conflict) {
      ++tally.conflicts;
      expect_names_regions(error, drag, block, brute, expected);
    } else {
      EXPECT_EQ(report.fraction_numerator, expected.numerator);
      EXPECT_EQ(report.fraction_denominator, expected.denominator);
      tally.moved += report.moved > 0;
      tally.shortened += expected.numerator != 0 && expected.numerator != expected.denominator;
      tally.held += n > 0 && expected.numerator != expected.denominator;
    }
    expect_equal(body, block, brute);
    if (testing::Test::HasFailure()) return;
    ASSERT_EQ(check_links(body).violated, 0);
  }
}

}  // namespace

TEST(PropertyRegions, DragsOfRegionsAndPushesEqualBruteForceBitForBitAmongEarlierHolds) {
  RegionTally tally;
  for (unsigned seed = 0; seed < unsigned(cases(400)) && !HasFailure(); ++seed) {
    const Vec3i max_dims = seed % 20 == 0  ? Vec3i(18, 12, 6)
                           : seed % 3 == 0 ? Vec3i(12, 12, 1)
                                           : Vec3i(7, 6, 5);
    run_regions(seed, max_dims, false, tally);
  }
  std::printf("moved %d, conflicts %d, shortened %d, stopped by holds %d\n", tally.moved,
              tally.conflicts, tally.shortened, tally.held);
  EXPECT_GE(tally.moved, cases(500));
  EXPECT_GE(tally.conflicts, cases(200));
  EXPECT_GE(tally.shortened, cases(100));
  EXPECT_GE(tally.held, cases(100));
}

TEST(PropertyRegions, TargetsOfEveryElementEqualBruteForceBitForBit) {
  LEFT_OUT_WHEN_SANITIZED();
  RegionTally tally;
  for (unsigned seed = 0; seed < unsigned(cases(300)) && !HasFailure(); ++seed) {
    run_regions(seed + 5000, seed % 3 == 0 ? Vec3i(10, 10, 1) : Vec3i(7, 6, 5), true, tally);
  }
  std::printf("moved %d, conflicts %d, shortened %d, stopped by holds %d\n", tally.moved,
              tally.conflicts, tally.shortened, tally.held);
  EXPECT_GE(tally.moved, cases(200));
  EXPECT_GE(tally.conflicts, cases(100));
  EXPECT_GE(tally.shortened, cases(50));
  EXPECT_GE(tally.held, cases(50));
}
