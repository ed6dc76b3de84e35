// The ECM engine against brute force, bit for bit, on random bodies.
#include <algorithm>
#include <cstdio>

#include <gtest/gtest.h>

#include "lib/body/rigid_links.h"
#include "lib/chainmail/ecm.h"
#include "tests/lib/brute_force.h"
#include "tests/support/sanitized.h"
#include "volumes/base/error.h"

using namespace supple;
using namespace supple::test;

namespace {

RandomDrag random_drag(std::mt19937& random, const Block& block) {
  RandomDrag drag;
  std::vector<int> taken;
  if (random() % 2) {
    const Vec3i lo = block.voxel(random_element(random, block));
    const Vec3i hi = lo + Vec3i(int(random() % 3), int(random() % 3), int(random() % 2));
    const IndexBox box{lo, hi};
    drag.fixed.push_back(box);
    for (int n = 0; n < block.size(); ++n) {
      if (block.element[n] && box.contains(block.voxel(n))) drag.anchors.push_back(n);
    }
    taken = drag.anchors;
  }
  const int handles = random() % 3 ? 1 : 1 + int(random() % 4);
  const double reach = std::pow(10.0, std::uniform_real_distribution<double>(-1, 1.5)(random));
  std::array<std::int32_t, 3> common{};
  for (int h = 0; h < handles; ++h) {
    const int node = random_element(random, block);
    if (std::find(taken.begin(), taken.end(), node) != taken.end()) continue;
    taken.push_back(node);
    std::array<std::int32_t, 3> by{};
    for (int c = 0; c < 3; ++c) {
      const double voxels = std::uniform_real_distribution<double>(-reach, reach)(random);
      // Mostly nearly the same displacement, so that several handles can agree.
      const bool near_first = h > 0 && random() % 4 != 0;
      by[c] = near_first ? common[c] + std::int32_t(voxels * 3000) : std::int32_t(voxels * 65536);
      if (random() % 5 == 0) by[c] = 0;
    }
    if (h == 0) common = by;
    drag.handles.push_back({block.voxel(node), by});
    drag.grabs.push_back({{node}, {by[0], by[1], by[2]}});
  }
  return drag;
}

/// The message names a pair whose missing distance is the largest there is.
void expect_names_conflict(const std::string& message, const RandomDrag& drag, const Block& block,
                           const BruteForce& brute, const BruteForce::Outcome& outcome) {
  Vec3i voxels[2];
  double missing_mm = 0;
  char axis = ' ';
  ASSERT_EQ(std::sscanf(message.c_str(),
                        "grab %d,%d,%d and %d,%d,%d: found targets %lf mm further apart along "
                        "axis %c",
                        &voxels[0].x, &voxels[0].y, &voxels[0].z, &voxels[1].x, &voxels[1].y,
                        &voxels[1].z, &missing_mm, &axis),
            8)
      << message;
  EXPECT_EQ(axis, "ijk"[outcome.conflict_axis]);
  const double expected_mm =
      double(outcome.missing) / 65536 * block.spacing_mm[outcome.conflict_axis];
  EXPECT_NEAR(missing_mm, expected_mm, 1e-5 * expected_mm);
  const BruteForce::Grab* pair[2] = {nullptr, nullptr};
  for (const auto& grab : drag.grabs) {
    for (int n = 0; n < 2; ++n) {
      if (block.voxel(grab.nodes[0]) == voxels[n]) pair[n] = &grab;
    }
  }
  ASSERT_TRUE(pair[0] != nullptr && pair[1] != nullptr) << message;
  EXPECT_EQ(brute.missing(outcome.conflict_axis, *pair[0], *pair[1]), outcome.missing);
}

struct Tally {
  int drags = 0, moved = 0, conflicts = 0, stopped = 0, shortened = 0, unlimited = 0;
};

enum class With { nothing, cuts, labels, diagonals, pieces };

/// Boxes of elements, each a piece; links inside and between them are cut.
std::vector<std::vector<int>> random_pieces(std::mt19937& random, Block& block) {
  std::vector<int> piece_of(std::size_t(block.size()), -1);
  std::vector<std::vector<int>> pieces(1 + random() % 4);
  for (int p = 0; p < int(pieces.size()); ++p) {
    const Vec3i lo = block.voxel(random_element(random, block));
    const IndexBox box{lo, lo + Vec3i(int(random() % 4), int(random() % 4), int(random() % 3))};
    for (int n = 0; n < block.size(); ++n) {
      if (block.element[std::size_t(n)] && box.contains(block.voxel(n))) {
        piece_of[std::size_t(n)] = p;
      }
    }
  }
  if (block.cut.empty()) block.cut.assign(std::size_t(block.size()), 0);
  const int step[3] = {1, block.dims.x, block.dims.x * block.dims.y};
  for (int n = 0; n < block.size(); ++n) {
    if (piece_of[std::size_t(n)] < 0) continue;
    pieces[std::size_t(piece_of[std::size_t(n)])].push_back(n);
    const Vec3i at = block.voxel(n) - block.origin;
    for (int axis = 0; axis < 3; ++axis) {
      if (at[axis] + 1 == block.dims[axis]) continue;
      if (piece_of[std::size_t(n + step[axis])] >= 0) {
        block.cut[std::size_t(n)] = char(block.cut[std::size_t(n)] | 1 << axis);
      }
    }
  }
  return pieces;
}

/// The body and brute force with pieces.
void make_rigid(const Block& block, const std::vector<std::vector<int>>& pieces, Body& body,
                BruteForce& brute) {
  std::vector<RigidPiece> list;
  for (const std::vector<int>& nodes : pieces) {
    std::vector<Slot> slots;
    for (const int node : nodes) {
      Slot slot = 0;
      ASSERT_TRUE(slot_of(body.elements, block.voxel(node), slot));
      slots.push_back(slot);
    }
    list.emplace_back();
    list.back().elements = std::make_shared<SlotSet>(std::move(slots));
    brute.join(nodes);
  }
  body.rigid = numbered(std::move(list), body.elements);
}

/// Drags one random body several times, comparing after each.
void run_case(unsigned seed, const Vec3i& max_dims, With with, Tally& tally) {
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  Block block = random_block(random, max_dims);
  if (with == With::diagonals) block.table.links = random() % 3 == 0 ? 18 : 26;
  if (with == With::cuts || (with == With::diagonals && random() % 2 == 0))
    cut_randomly(random, block);
  if (with == With::labels) label_randomly(random, block);
  std::vector<std::vector<int>> pieces;
  if (with == With::pieces) {
    if (random() % 3 == 0) block.table.links = 26;
    pieces = random_pieces(random, block);
  }
  Body body = body_of(block);
  BruteForce brute(block);
  make_rigid(block, pieces, body, brute);
  EcmSolver solver(body, seed % 2 ? Engine::flat : Engine::block);
  for (int n = 0; n < 4; ++n) {
    const RandomDrag drag = random_drag(random, block);
    const BruteForce::Outcome expected = brute.drag(drag.grabs, drag.anchors);
    EcmReport report;
    const std::string error = input_error([&] { report = solver.drag(drag.handles, drag.fixed); });
    ++tally.drags;
    ASSERT_EQ(!error.empty(), expected.conflict) << error;
    if (expected.conflict) {
      ++tally.conflicts;
      expect_names_conflict(error, drag, block, brute, expected);
    } else {
      EXPECT_EQ(report.fraction_numerator, expected.numerator);
      EXPECT_EQ(report.fraction_denominator, expected.denominator);
      tally.moved += report.moved > 0;
      tally.stopped += expected.numerator == 0;
      tally.shortened += expected.numerator != 0 && expected.numerator != expected.denominator;
    }
    expect_equal(body, block, brute);
    if (testing::Test::HasFailure()) return;
    ASSERT_EQ(check_links(body).violated, 0);
    ASSERT_EQ(brute.broken_links(), 0);
  }
}

}  // namespace

TEST(PropertyEcm, EqualsBruteForceBitForBitOnRandomBodiesHandlesAndAnchors) {
  LEFT_OUT_WHEN_SANITIZED();
  Tally tally;
  for (unsigned seed = 0; seed < unsigned(cases(600)) && !HasFailure(); ++seed) {
    const Vec3i max_dims = seed % 10 < 2   ? Vec3i(20, 20, 6)
                           : seed % 3 == 0 ? Vec3i(12, 12, 1)
                                           : Vec3i(7, 6, 5);
    run_case(seed, max_dims, With::nothing, tally);
  }
  std::printf("drags %d, moved %d, conflicts %d, stopped at once %d, shortened %d\n", tally.drags,
              tally.moved, tally.conflicts, tally.stopped, tally.shortened);
  EXPECT_GE(tally.moved, cases(400));
  EXPECT_GE(tally.conflicts, cases(50));
  EXPECT_GE(tally.shortened, cases(50));
}

TEST(PropertyEcm, EqualsBruteForceBitForBitWhereLinksAreCut) {
  Tally tally;
  for (unsigned seed = 1000; seed < 1000 + unsigned(cases(300)) && !HasFailure(); ++seed) {
    const Vec3i max_dims = seed % 3 == 0 ? Vec3i(12, 12, 1) : Vec3i(10, 9, 5);
    run_case(seed, max_dims, With::cuts, tally);
  }
  std::printf("drags %d, moved %d, conflicts %d, stopped at once %d, shortened %d\n", tally.drags,
              tally.moved, tally.conflicts, tally.stopped, tally.shortened);
  EXPECT_GE(tally.moved, cases(400));
  EXPECT_GE(tally.conflicts, cases(20));
  EXPECT_GE(tally.shortened, cases(20));
}

TEST(PropertyEcm, EqualsBruteForceBitForBitWhereLabelsHaveTablesOfTheirOwn) {
  LEFT_OUT_WHEN_SANITIZED();
  Tally tally;
  for (unsigned seed = 2000; seed < 2000 + unsigned(cases(300)) && !HasFailure(); ++seed) {
    const Vec3i max_dims = seed % 3 == 0 ? Vec3i(12, 12, 1) : Vec3i(10, 9, 5);
    run_case(seed, max_dims, With::labels, tally);
  }
  std::printf("drags %d, moved %d, conflicts %d, stopped at once %d, shortened %d\n", tally.drags,
              tally.moved, tally.conflicts, tally.stopped, tally.shortened);
  EXPECT_GE(tally.moved, cases(400));
  EXPECT_GE(tally.conflicts, cases(20));
  EXPECT_GE(tally.shortened, cases(20));
}

TEST(PropertyEcm, EqualsBruteForceBitForBitWithDiagonalLinks) {
  Tally tally;
  for (unsigned seed = 3000; seed < 3000 + unsigned(cases(300)) && !HasFailure(); ++seed) {
    const Vec3i max_dims = seed % 3 == 0 ? Vec3i(12, 12, 2) : Vec3i(8, 7, 5);
    run_case(seed, max_dims, With::diagonals, tally);
  }
  std::printf("drags %d, moved %d, conflicts %d, stopped at once %d, shortened %d\n", tally.drags,
              tally.moved, tally.conflicts, tally.stopped, tally.shortened);
  EXPECT_GE(tally.moved, cases(400));
  EXPECT_GE(tally.conflicts, cases(20));
  EXPECT_GE(tally.shortened, cases(20));
}

TEST(PropertyEcm, EqualsBruteForceBitForBitWithPiecesThatShiftAsOne) {
  LEFT_OUT_WHEN_SANITIZED();
  Tally tally;
  for (unsigned seed = 4000; seed < 4000 + unsigned(cases(300)) && !HasFailure(); ++seed) {
    const Vec3i max_dims = seed % 3 == 0 ? Vec3i(12, 12, 2) : Vec3i(9, 8, 5);
    run_case(seed, max_dims, With::pieces, tally);
  }
  std::printf("drags %d, moved %d, conflicts %d, stopped at once %d, shortened %d\n", tally.drags,
              tally.moved, tally.conflicts, tally.stopped, tally.shortened);
  EXPECT_GE(tally.moved, cases(400));
  EXPECT_GE(tally.conflicts, cases(20));
  EXPECT_GE(tally.shortened, cases(20));
}

TEST(PropertyEcm, EqualsBruteForceOnTheLargestSizeAndOnASingleVoxel) {
  std::mt19937 random(77);
  for (const Vec3i& dims : {Vec3i(1, 1, 1), Vec3i(1, 1, 30), Vec3i(20, 20, 6)}) {
    Block block = full_block(dims, linear_table(1.5, 0.6, 0.7),
                             [&](int, int, int) { return double(random() % 256); });
    Body body = body_of(block);
    BruteForce brute(block);
    for (int n = 0; n < 3; ++n) {
      const RandomDrag drag = random_drag(random, block);
      const auto expected = brute.drag(drag.grabs, drag.anchors);
      const std::string error = input_error([&] { supple::drag(body, drag.handles, drag.fixed); });
      ASSERT_EQ(!error.empty(), expected.conflict) << error;
      expect_equal(body, block, brute);
    }
  }
}
