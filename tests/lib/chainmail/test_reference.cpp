// The thesis' algorithms beside the engine: figures 4.5 and 4.9, section 4.1.2, section 4.2.2.
#include <algorithm>

#include <gtest/gtest.h>

#include "lib/chainmail/ecm.h"
#include "lib/chainmail/reference/original_chainmail.h"
#include "lib/chainmail/reference/thesis_ecm.h"
#include "tests/lib/test_bodies.h"
#include "tests/support/sanitized.h"

using namespace supple;
using namespace supple::test;
using namespace supple::reference;

namespace {

/// Links between two rigid elements (density 0) whose ends have different offsets.
int torn_rigid_links(const Body& body, const Block& block) {
  int torn = 0;
  for (int n = 0; n < block.size(); ++n) {
    for (int axis = 0; axis < 3; ++axis) {
      Vec3i next = block.voxel(n) - block.origin;
      if (++next[axis] >= block.dims[axis]) continue;
      const int other = block.index(next.x, next.y, next.z);
      if (block.density[n] != 0 || block.density[other] != 0) continue;
      for (int c = 0; c < 3; ++c) {
        torn += body.offset(block.voxel(n), c) != body.offset(block.voxel(other), c);
      }
    }
  }
  return torn;
}

std::array<std::int32_t, 3> random_way(std::mt19937& random, double reach) {
  std::uniform_real_distribution<double> voxels(-reach, reach);
  return {std::int32_t(voxels(random) * kVoxel), std::int32_t(voxels(random) * kVoxel),
          std::int32_t(voxels(random) * kVoxel)};
}

void expect_same_offsets(const Body& body, const ReferenceLattice& lattice,
                         const Offsets& offsets) {
  const Offsets mine = offsets_of(body, lattice);
  for (int c = 0; c < 3; ++c) ASSERT_EQ(mine[c], offsets[c]) << "axis " << c;
}

/// One kind of tissue in the voxels of a block for which `inside` holds.
Block homogeneous_shape(std::mt19937& random, const Vec3i& dims,
                        const std::function<bool(const Vec3d&)>& inside) {
  Block block =
      full_block(dims,
                 linear_table(1 + 0.001 * int(random() % 800), 1 - 0.001 * int(random() % 800),
                              0.001 * int(random() % 900)),
                 [](int, int, int) { return 255.0; });
  const Vec3d middle = (Vec3d(dims) - Vec3d(1)) / 2.0;
  for (int n = 0; n < block.size(); ++n) {
    block.element[n] = inside(Vec3d(block.voxel(n)) - middle);
  }
  return block;
}

/// An ellipsoid that fills the block.
std::function<bool(const Vec3d&)> ellipsoid(const Vec3i& dims) {
  const Vec3d radius = Vec3d(dims) / 2.0;
  return [radius](const Vec3d& place) { return (place / radius).length2() <= 1; };
}

/// An intersection of half-spaces that hold the middle.
std::function<bool(const Vec3d&)> polytope(std::mt19937& random, const Vec3i& dims) {
  std::uniform_real_distribution<double> number(-1, 1);
  std::vector<std::pair<Vec3d, double>> planes;
  for (int n = 0; n < 4; ++n) {
    const Vec3d normal(number(random), number(random), number(random));
    planes.push_back({normal, (0.2 + 0.8 * std::abs(number(random))) * normal.length() *
                                  std::max({dims.x, dims.y, dims.z}) / 2.0});
  }
  return [planes](const Vec3d& place) {
    return std::all_of(planes.begin(), planes.end(),
                       [&](const auto& plane) { return plane.first.dot(place) <= plane.second; });
  };
}

/// True if the way from `from` to `to` along i, then j, then k stays in the body.
bool staircase_inside(const Body& body, const Vec3i& from, const Vec3i& to) {
  Vec3i voxel = from;
  for (int axis = 0; axis < 3; ++axis) {
    const int step = to[axis] > voxel[axis] ? 1 : -1;
    while (voxel[axis] != to[axis]) {
      voxel[axis] += step;
      if (!body.elements.is_active(voxel)) return false;
    }
  }
  return true;
}

/// Expects that the original ChainMail moves what it reaches as ECM does; the rest stays. Returns
/// the number of elements that ECM moves and the original leaves behind.
int expect_staircase_law(const Body& before, const Body& original, const Body& ecm,
                         const Vec3i& grabbed) {
  int left_behind = 0;
  for_each_element(before.elements, [&](Slot slot) {
    const bool reached = staircase_inside(before, grabbed, voxel_of(before.elements, slot));
    for (int c = 0; c < 3; ++c) {
      EXPECT_EQ(original.q[c].at(slot), (reached ? ecm : before).q[c].at(slot));
    }
    bool moved = false;
    for (int c = 0; c < 3; ++c) moved |= ecm.q[c].at(slot) != before.q[c].at(slot);
    left_behind += moved && !reached;
  });
  return left_behind;
}

/// Two arms of 4 voxels with a gap of 4, 12 high, on a bar of 4.
Block u_shape() {
  std::mt19937 random(1);
  Block block = homogeneous_shape(
      random, {12, 12, 1}, [](const Vec3d& place) { return std::abs(place.x) > 2 || place.y > 2; });
  block.table = linear_table(1.5, 0.6, 0.7);
  return block;
}

}  // namespace

TEST(UnitOriginalChainMail, TearsTheRigidTWhileEcmBreaksNoLink) {
  const Block block = t_shape(50);
  const Body rest = body_of(block);
  const Vec3i voxel(49, 12, 0);  // the right rim, beside the bar's upper half
  const std::array<std::int32_t, 3> by{30 * kVoxel, 0, 0};

  const Body original = reference::original_chainmail(rest, voxel, by);
  EXPECT_GT(torn_rigid_links(original, block), 0);
  EXPECT_GT(check_links(original).violated, 0);

  Body ecm = rest;
  drag(ecm, {{voxel, by}}, {});
  EXPECT_EQ(torn_rigid_links(ecm, block), 0);
  EXPECT_EQ(check_links(ecm).violated, 0);
}

TEST(UnitOriginalChainMail, EcmKeepsTheTRigidThroughTheDragsOfFigure49) {
  const Block block = t_shape(50);
  Body body = body_of(block);
  const Vec3i voxel(49, 25, 0);
  for (const auto& [i, j] : {std::pair(12, 0), {12, 0}, {0, 20}, {-40, 0}, {-30, -35}, {60, 5}}) {
    drag(body, {{voxel, {i * kVoxel, j * kVoxel, 0}}}, {});
    EXPECT_EQ(torn_rigid_links(body, block), 0);
    EXPECT_EQ(check_links(body).violated, 0);
  }
}

TEST(PropertyOriginalChainMail, EqualsEcmOnHomogeneousConvexBodies) {
  std::mt19937 random(41);
  for (int n = 0; n < cases(100); ++n) {
    const Vec3i dims(1 + int(random() % 15), 1 + int(random() % 15),
                     n % 2 ? 1 : 1 + int(random() % 8));
    const Block block =
        full_block(dims,
                   linear_table(1 + 0.001 * int(random() % 800), 1 - 0.001 * int(random() % 800),
                                0.001 * int(random() % 900)),
                   [](int, int, int) { return 255.0; });
    Body body = body_of(block);
    const Vec3i voxel = block.voxel(random_element(random, block));
    const auto by = random_way(random, 12);
    const Body original = reference::original_chainmail(body, voxel, by);
    drag(body, {{voxel, by}}, {});
    const ReferenceLattice lattice = lattice_of(body);
    expect_same_offsets(body, lattice, offsets_of(original, lattice));
  }
}

TEST(PropertyOriginalChainMail, EqualsEcmInRepeatedDragsOfHomogeneousBoxes) {
  std::mt19937 random(44);
  for (int n = 0; n < cases(40); ++n) {
    const Vec3i dims(1 + int(random() % 12), 1 + int(random() % 12), 1 + int(random() % 6));
    const Block block = homogeneous_shape(random, dims, [](const Vec3d&) { return true; });
    Body ecm = body_of(block), original = ecm;
    for (int drags = 0; drags < 6; ++drags) {
      const Vec3i voxel = block.voxel(random_element(random, block));
      const auto by = random_way(random, 9);
      original = reference::original_chainmail(original, voxel, by);
      drag(ecm, {{voxel, by}}, {});
      const ReferenceLattice lattice = lattice_of(ecm);
      expect_same_offsets(ecm, lattice, offsets_of(original, lattice));
    }
  }
}

TEST(PropertyOriginalChainMail, EqualsEcmOnConvexBodiesGrabbedWhereAllStaircasesStayInside) {
  std::mt19937 random(45);
  for (int n = 0; n < cases(60); ++n) {
    const Vec3i dims(5 + 2 * int(random() % 5), 5 + 2 * int(random() % 5),
                     5 + 2 * int(random() % 3));
    Body body = body_of(homogeneous_shape(random, dims, ellipsoid(dims)));
    const Vec3i voxel = (dims - Vec3i(1)) / 2;
    for (int drags = 0; drags < 3; ++drags) {
      const auto by = random_way(random, 9);
      const Body before = body;
      drag(body, {{voxel, by}}, {});
      const Body original = reference::original_chainmail(before, voxel, by);
      EXPECT_EQ(expect_staircase_law(before, original, body, voxel), 0) << n;
      EXPECT_EQ(check_links(original).violated, 0) << n;
    }
  }
}

TEST(PropertyOriginalChainMail, OnAnyHomogeneousBodyItMovesWhatItsStaircasesReachAsEcmDoes) {
  std::mt19937 random(46);
  std::int64_t left_behind = 0;
  for (int n = 0; n < cases(150); ++n) {
    const Vec3i dims(1 + int(random() % 12), 1 + int(random() % 12), 1 + int(random() % 6));
    const auto noise = [&random](const Vec3d&) { return random() % 5 != 0; };
    Block block = n % 3 == 0   ? homogeneous_shape(random, dims, ellipsoid(dims))
                  : n % 3 == 1 ? homogeneous_shape(random, dims, polytope(random, dims))
                               : homogeneous_shape(random, dims, noise);
    if (std::count(block.element.begin(), block.element.end(), 1) == 0) continue;
    Body body = body_of(block);
    for (int drags = 0; drags < 4; ++drags) {
      const Vec3i voxel = block.voxel(random_element(random, block));
      const auto by = random_way(random, 9);
      const Body before = body;
      drag(body, {{voxel, by}}, {});
      left_behind += expect_staircase_law(before, reference::original_chainmail(before, voxel, by),
                                          body, voxel);
      ASSERT_FALSE(HasFailure()) << "case " << n << " drag " << drags;
    }
  }
  EXPECT_GT(left_behind, cases(1000));
}

TEST(UnitOriginalChainMail, OrdinaryConvexityIsNotEnough) {
  std::mt19937 random(47);
  Block ball = homogeneous_shape(random, {15, 15, 1},
                                 [](const Vec3d& place) { return place.length2() <= 49; });
  ball.table = linear_table(1.5, 0.6, 0.7);
  const Body rest = body_of(ball);
  const Vec3i top(7, 0, 0);
  const std::array<std::int32_t, 3> by{0, -12 * kVoxel, 0};
  const Body original = reference::original_chainmail(rest, top, by);
  Body ecm = rest;
  drag(ecm, {{top, by}}, {});
  EXPECT_GT(expect_staircase_law(rest, original, ecm, top), 0);
  EXPECT_GT(check_links(original).violated, 0);
  EXPECT_EQ(check_links(ecm).violated, 0);
}

TEST(UnitOriginalChainMail, LeavesTheOtherArmOfAUBehind) {
  const Body rest = body_of(u_shape());
  const Vec3i tip(0, 0, 0);
  const std::array<std::int32_t, 3> by{-20 * kVoxel, 0, 0};
  const Body original = reference::original_chainmail(rest, tip, by);
  Body ecm = rest;
  drag(ecm, {{tip, by}}, {});

  const int left_behind = expect_staircase_law(rest, original, ecm, tip);
  const LinkCheck check = check_links(original);
  std::int64_t furthest = 0;
  for_each_element(rest.elements, [&](Slot slot) {
    furthest =
        std::max(furthest, std::abs(std::int64_t(ecm.q[0].at(slot)) - original.q[0].at(slot)));
  });
  // The tip's row and columns hold 48 of 112 elements: its arm, and the bar under it.
  EXPECT_EQ(left_behind, 64);
  // The bar tears along its 4 links; ECM brings 20 - 8 * 0.7 - 4 * 0.5 voxels across.
  EXPECT_EQ(check.violated, 4);
  EXPECT_NEAR(check.worst_excess_voxels, 12.4, 0.001);
  EXPECT_NEAR(double(furthest), 12.4 * kVoxel, 16);
  EXPECT_EQ(check_links(ecm).violated, 0);
}

TEST(UnitOriginalChainMail, EqualsEcmOnAUGrabbedInItsBar) {
  const Body rest = body_of(u_shape());
  const Vec3i bar(5, 10, 0);
  const std::array<std::int32_t, 3> by{-20 * kVoxel, 15 * kVoxel, 0};
  const Body original = reference::original_chainmail(rest, bar, by);
  Body ecm = rest;
  drag(ecm, {{bar, by}}, {});
  EXPECT_EQ(expect_staircase_law(rest, original, ecm, bar), 0);
}

TEST(PropertyThesisEcm, TheOrderedCandidateListGivesTheBitsOfTheEngine) {
  LEFT_OUT_WHEN_SANITIZED();
  std::mt19937 random(43);
  for (int n = 0; n < cases(250); ++n) {
    Block block = random_block(random, n % 8 == 0 ? Vec3i(20, 20, 6) : Vec3i(9, 8, 5));
    if (n % 3 == 0) cut_randomly(random, block);
    Body body = body_of(block);
    const ReferenceLattice lattice = lattice_of(body);
    ThesisEcm<std::int64_t> thesis(lattice, lattice.at_rest());
    for (int drags = 0; drags < 4; ++drags) {
      const Vec3i voxel = block.voxel(random_element(random, block));
      const auto by = random_way(random, drags % 2 ? 3 : 20);
      drag(body, {{voxel, by}}, {});
      thesis.move(voxel - lattice.origin, by, 2000000);
      expect_same_offsets(body, lattice, thesis.offsets());
      if (HasFailure()) FAIL() << "case " << n << " drag " << drags;
    }
  }
}

TEST(UnitThesisEcm, InFloatArithmeticItEndsNearTheExactResult) {
  const Body rest = body_of(t_shape(24));
  const ReferenceLattice lattice = lattice_of(rest);
  ThesisEcm<std::int64_t> exact(lattice, lattice.at_rest());
  ThesisEcm<float> rounded(lattice, lattice.at_rest());
  const std::array<std::int32_t, 3> by{20 * kVoxel + 1, -5 * kVoxel - 1, 7};
  exact.move({23, 3, 0}, by);
  rounded.move({23, 3, 0}, by, 100000);
  EXPECT_GT(exact.moves(), 500);
  EXPECT_GT(exact.max_candidates(), 20u);
  const Offsets expected = exact.offsets(), found = rounded.offsets();
  for (int c = 0; c < 3; ++c) {
    for (std::size_t n = 0; n < lattice.size(); ++n) {
      ASSERT_NEAR(expected[c][n], found[c][n], 65.536);
    }
  }
}
