// The thesis' algorithms beside the engine: figures 4.5 and 4.9, section 4.1.2, section 4.2.2.
#include <gtest/gtest.h>

#include "lib/chainmail/ecm.h"
#include "lib/chainmail/reference/original_chainmail.h"
#include "lib/chainmail/reference/thesis_ecm.h"
#include "tests/lib/test_bodies.h"

using namespace supple;
using namespace supple::test;
using namespace supple::reference;

namespace {

constexpr std::int32_t kVoxel = 65536;

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

std::array<std::int32_t, 3> random_move(std::mt19937& random, double reach) {
  std::uniform_real_distribution<double> voxels(-reach, reach);
  return {std::int32_t(voxels(random) * kVoxel), std::int32_t(voxels(random) * kVoxel),
          std::int32_t(voxels(random) * kVoxel)};
}

void expect_same_offsets(const Body& body, const ReferenceLattice& lattice,
                         const Offsets& offsets) {
  const Offsets mine = offsets_of(body, lattice);
  for (int c = 0; c < 3; ++c) ASSERT_EQ(mine[c], offsets[c]) << "axis " << c;
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
  for (int n = 0; n < 100; ++n) {
    const Vec3i dims(1 + int(random() % 15), 1 + int(random() % 15),
                     n % 2 ? 1 : 1 + int(random() % 8));
    const Block block =
        full_block(dims,
                   linear_table(1 + 0.001 * int(random() % 800), 1 - 0.001 * int(random() % 800),
                                0.001 * int(random() % 900)),
                   [](int, int, int) { return 255.0; });
    Body body = body_of(block);
    const Vec3i voxel = block.voxel(random_element(random, block));
    const auto by = random_move(random, 12);
    const Body original = reference::original_chainmail(body, voxel, by);
    drag(body, {{voxel, by}}, {});
    const ReferenceLattice lattice = lattice_of(body);
    expect_same_offsets(body, lattice, offsets_of(original, lattice));
  }
}

TEST(PropertyThesisEcm, TheOrderedCandidateListGivesTheBitsOfTheEngine) {
  std::mt19937 random(43);
  for (int n = 0; n < 250; ++n) {
    Block block = random_block(random, n % 8 == 0 ? Vec3i(20, 20, 6) : Vec3i(9, 8, 5));
    if (n % 3 == 0) cut_randomly(random, block);
    Body body = body_of(block);
    const ReferenceLattice lattice = lattice_of(body);
    ThesisEcm<std::int64_t> thesis(lattice, lattice.at_rest());
    for (int drags = 0; drags < 4; ++drags) {
      const Vec3i voxel = block.voxel(random_element(random, block));
      const auto by = random_move(random, drags % 2 ? 3 : 20);
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
