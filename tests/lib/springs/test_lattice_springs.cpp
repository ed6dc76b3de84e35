// Springs on voxel bodies.
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "lib/chainmail/ecm.h"
#include "lib/springs/lattice_springs.h"
#include "lib/springs/minimise.h"
#include "lib/springs/spring_matrix.h"
#include "tests/lib/test_bodies.h"

using namespace supple;
using namespace supple::test;

namespace {

LatticeSpringParams only(double structural, double shear, double bending) {
  LatticeSpringParams params;
  params.structural_n_m = structural;
  params.shear_n_m = shear;
  params.bending_n_m = bending;
  return params;
}

/// Fractions and velocities as a model of motion may leave them.
void set_in_motion(std::mt19937& random, Body& body) {
  std::uniform_int_distribution<int> part(-32768, 32767);
  std::normal_distribution<double> speed(0, 30);
  for (std::size_t c = 0; c < 3; ++c) {
    body.fraction[c].resize(body.elements.brick_count());
    body.velocity_mm_s[c].resize(body.elements.brick_count());
    for_each_element(body.elements, [&](Slot slot) {
      body.fraction[c].set(slot, std::int16_t(part(random)));
      body.velocity_mm_s[c].set(slot, speed(random));
    });
  }
}

/// Springs by brute force over all pairs of elements, from the block's description.
int expected_springs(const Block& block, int structural, int shear, int bending) {
  const auto element = [&](const Vec3i& v) {
    for (int c = 0; c < 3; ++c) {
      if (v[c] < 0 || v[c] >= block.dims[c]) return false;
    }
    return block.element[block.index(v.x, v.y, v.z)] != 0;
  };
  const auto linked = [&](const Vec3i& v, int axis) {
    Vec3i next = v;
    ++next[axis];
    if (!element(v) || !element(next)) return false;
    return block.cut.empty() || ((block.cut[block.index(v.x, v.y, v.z)] >> axis) & 1) == 0;
  };
  int count = 0;
  for (int n = 0; n < block.size(); ++n) {
    const Vec3i v = block.voxel(n) - block.origin;
    for (int a = 0; a < 3; ++a) {
      Vec3i next = v;
      ++next[a];
      if (!linked(v, a)) continue;
      count += structural;
      if (linked(next, a)) count += bending;
      for (int b = a + 1; b < 3; ++b) {
        Vec3i side = v;
        ++side[b];
        if (linked(v, b) && linked(next, b) && linked(side, a)) count += 2 * shear;
      }
    }
  }
  return count;
}

}  // namespace

TEST(UnitLatticeSprings, AFullBlockHasTheSpringsOfTheLattice) {
  Block block = soft_block({4, 3, 2});
  block.spacing_mm = {0.5, 2, 3};
  const Body body = body_of(block);
  const LatticeSprings structural = make_springs(body, only(100, 0, 0));
  EXPECT_EQ(structural.system.springs.size(), std::size_t(3 * 3 * 2 + 4 * 2 * 2 + 4 * 3 * 1));
  const LatticeSprings shear = make_springs(body, only(0, 50, 0));
  EXPECT_EQ(shear.system.springs.size(), std::size_t(2 * (3 * 2 * 2 + 3 * 1 * 3 + 2 * 1 * 4)));
  const LatticeSprings bending = make_springs(body, only(0, 0, 10));
  EXPECT_EQ(bending.system.springs.size(), std::size_t(2 * 3 * 2 + 4 * 1 * 2));
  // Every length is the distance at rest; a voxel of 3 mm^3 weighs 3 mg.
  for (const LatticeSprings* springs : {&structural, &shear, &bending}) {
    for (const Spring& s : springs->system.springs) {
      const Vec3d apart = springs->system.pos_mm[s.b] - springs->system.pos_mm[s.a];
      EXPECT_NEAR(apart.length(), s.rest_mm, 1e-12);
    }
  }
  EXPECT_NEAR(structural.system.mass_kg[5], 3e-6, 1e-15);
  EXPECT_NEAR(energy(shear.system).spring_j, 0, 1e-20);
}

TEST(PropertyLatticeSprings, NoSpringCrossesACutOrTheVoid) {
  std::mt19937 random(19);
  int cuts = 0;
  for (int run = 0; run < 60; ++run) {
    Block block = random_block(random, {11, 9, 5});
    cut_randomly(random, block);
    const Body body = body_of(block);
    cuts += body.cuts.count() > 0;
    for (const Vec3i& kind : {Vec3i(1, 0, 0), Vec3i(0, 1, 0), Vec3i(0, 0, 1)}) {
      const LatticeSprings springs = make_springs(body, only(kind.x, kind.y, kind.z));
      EXPECT_EQ(int(springs.system.springs.size()),
                expected_springs(block, kind.x, kind.y, kind.z));
    }
  }
  EXPECT_GE(cuts, 30);
}

TEST(UnitLatticeSprings, SpringsRestWherePlasticFlowLeftEveryLinkTheyPass) {
  Body row = soft_row(3);
  for (const std::size_t c : {0, 1}) row.rest[0][c].resize(row.elements.brick_count());
  const auto flow = [](Body& body, const Vec3i& voxel, int axis, int c, int by) {
    Slot slot = 0;
    ASSERT_TRUE(slot_of(body.elements, voxel, slot));
    body.rest[std::size_t(axis)][std::size_t(c)].set(slot, by);
  };
  flow(row, {0, 0, 0}, 0, 0, kVoxel / 4);
  flow(row, {1, 0, 0}, 0, 0, kVoxel / 2);
  flow(row, {1, 0, 0}, 0, 1, kVoxel / 8);
  const auto rests = [](const Body& body, const LatticeSpringParams& params) {
    std::vector<double> found;
    for (const Spring& s : make_springs(body, params).system.springs) found.push_back(s.rest_mm);
    return found;
  };
  const std::vector<double> bending = rests(row, only(0, 0, 10));
  ASSERT_EQ(bending.size(), 1u);
  EXPECT_NEAR(bending[0], std::hypot(2.75, 0.125), 1e-12);
  const std::vector<double> structural = rests(row, only(100, 0, 0));
  ASSERT_EQ(structural.size(), 2u);
  EXPECT_NEAR(structural[0], 1.25, 1e-12);
  EXPECT_NEAR(structural[1], std::hypot(1.5, 0.125), 1e-12);
  // A diagonal has the mean of both ways round.
  Body square = body_of(soft_block({2, 2, 1}));
  for (const std::size_t axis : {0, 1}) {
    square.rest[axis][axis].resize(square.elements.brick_count());
  }
  flow(square, {0, 0, 0}, 0, 0, kVoxel / 4);
  flow(square, {0, 1, 0}, 0, 0, kVoxel / 2);
  flow(square, {0, 0, 0}, 1, 1, kVoxel);
  flow(square, {1, 0, 0}, 1, 1, kVoxel / 8);
  const std::vector<double> shear = rests(square, only(0, 50, 0));
  ASSERT_EQ(shear.size(), 2u);
  for (const double rest : shear) EXPECT_NEAR(rest, std::hypot(1.375, 1.5625), 1e-12);
}

TEST(UnitLatticeSprings, FactorsOfBothEndsClassesAreAveraged) {
  Block block = soft_block({2, 1, 1});
  block.density = {0, 255};
  const Body body = body_of(block);
  LatticeSpringParams params = only(100, 0, 0);
  params.class_stiffness.assign(256, 1);
  params.class_stiffness[0] = 7;
  params.class_density.assign(256, 1);
  params.class_density[255] = 2;
  const LatticeSprings springs = make_springs(body, params);
  ASSERT_EQ(springs.system.springs.size(), 1u);
  EXPECT_EQ(springs.system.springs[0].stiffness_n_m, 400);
  EXPECT_NEAR(springs.system.mass_kg[1] / springs.system.mass_kg[0], 2, 1e-12);
  params.class_density[0] = 0;
  EXPECT_NE(input_error([&] { make_springs(body, params); }).find("class 0"), std::string::npos);
  params.class_density.pop_back();
  EXPECT_NE(input_error([&] { make_springs(body, params); }).find("255 factors"),
            std::string::npos);
}

TEST(PropertyLatticeSprings, OffsetsFractionsAndVelocitiesGoToSpringsAndBackBitForBit) {
  std::mt19937 random(23);
  for (int run = 0; run < 20; ++run) {
    const Block block = random_block(random, {9, 9, 9});
    Body body = body_of(block);
    const Vec3i voxel = block.voxel(random_element(random, block));
    drag(body, {{voxel, {3 * kVoxel + 17, -kVoxel / 3, 5}}}, {});
    if (run % 2 == 1) set_in_motion(random, body);
    const Body before = body;
    LatticeSprings springs = make_springs(body, {});
    EXPECT_EQ(springs.node_of(springs.slots.back()), int(springs.slots.size()) - 1);
    EXPECT_LT(give_state(springs, body), 1e-12);
    EXPECT_EQ(body.q, before.q);
    EXPECT_TRUE(body.fraction == before.fraction);
    EXPECT_TRUE(body.velocity_mm_s == before.velocity_mm_s);
    EXPECT_EQ(body.velocity_mm_s[0].empty(), run % 2 == 0);
    EXPECT_EQ(body.links_known_valid, before.links_known_valid);
    springs.system.pos_mm[0].x += 1e-3;
    give_state(springs, body);
    EXPECT_FALSE(body.links_known_valid);
    body = before;
    take_state(body, springs);
    EXPECT_EQ(make_springs(before, {}).system.pos_mm, springs.system.pos_mm);
  }
}

TEST(PropertyLatticeSprings, SpringsOfTheMaterialAreAnIsotropicSolid) {
  // Energy per cell of an affine strain, away from the surface: lambda / 2 tr^2 + mu eps : eps.
  std::mt19937 random(29);
  std::uniform_real_distribution<double> small(-1e-5, 1e-5);
  MaterialTable table = linear_table(1.5, 0.6, 0.7);
  table.stiffness = Curve{{{0, 3}}};
  table.mass_density = Curve{{{0, 1200}}};
  table.rayleigh_beta_ms = Curve{{{0, 4}}};
  Block block = full_block({3, 3, 3}, table, [](int, int, int) { return 255.0; });
  block.spacing_mm = {2, 2, 2};
  const Body body = body_of(block);
  const LatticeSprings springs = make_springs(body, material_springs(body));
  Slot middle = 0;
  ASSERT_TRUE(slot_of(body.elements, {1, 1, 1}, middle));
  const double lambda = 3 * 2 / 5.0, mu = lambda;  // E = 5/2 mu, kPa
  for (int run = 0; run < 10; ++run) {
    double strain[3][3];
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b <= a; ++b) strain[a][b] = strain[b][a] = small(random);
    }
    double energy = 0;  // kPa mm^3, half of what the springs of the node hold
    for (const Spring& spring : springs.system.springs) {
      if (spring.a != springs.node_of(middle) && spring.b != springs.node_of(middle)) continue;
      const Vec3d x = springs.system.pos_mm[spring.b] - springs.system.pos_mm[spring.a];
      double stretch = 0;
      for (int a = 0; a < 3; ++a) {
        for (int b = 0; b < 3; ++b) stretch += x[a] * strain[a][b] * x[b] / x.length();
      }
      energy += 0.25 * spring.stiffness_n_m * stretch * stretch;
      EXPECT_NEAR(spring.damping_n_s_m, 4e-3 * spring.stiffness_n_m, 1e-12);
    }
    double trace = 0, squares = 0;
    for (int a = 0; a < 3; ++a) {
      trace += strain[a][a];
      for (int b = 0; b < 3; ++b) squares += strain[a][b] * strain[a][b];
    }
    const double expected = 8 * (lambda / 2 * trace * trace + mu * squares);
    EXPECT_NEAR(energy, expected, 1e-9 * expected);
  }
  EXPECT_NEAR(springs.system.mass_kg[0], 1200 * 8e-9, 1e-15);
}

TEST(PropertyLatticeSprings, RelaxedSpringsAfterADragHaveLessEnergyAndTheHandlesStay) {
  Body body = body_of(soft_block({12, 4, 3}));
  drag(body, {{{11, 2, 1}, {2 * kVoxel, kVoxel, 0}}}, {{{0, 0, 0}, {0, 3, 2}}});
  LatticeSprings springs = make_springs(body, {});
  for (const Vec3i& voxel : {Vec3i(11, 2, 1), Vec3i(0, 0, 0), Vec3i(0, 3, 0), Vec3i(0, 0, 2)}) {
    Slot slot;
    ASSERT_TRUE(slot_of(body.elements, voxel, slot));
    hold(springs.system, springs.node_of(slot));
  }
  const MinimiseReport report = minimise(springs.system);
  EXPECT_TRUE(report.converged);
  EXPECT_LT(report.after.spring_j, 0.8 * report.before.spring_j);
  const double rounding = give_state(springs, body);
  EXPECT_GT(rounding, 0);
  EXPECT_LE(rounding, 0.5 / kVoxel / 65536);
  EXPECT_EQ(body.offset({11, 2, 1}, 0), 2 * kVoxel);
  EXPECT_EQ(body.offset({0, 3, 0}, 1), 0);
  // An interrupted or soft result may break ChainMail's limits; the projection mends it.
  project(body);
  EXPECT_EQ(check_links(body).violated, 0);
}

TEST(PropertyLatticeSprings, SolidsTooLargeForFactorsAreSolvedByGradientsToTheSameRest) {
  const auto relaxed = [](int size) {
    Body body = body_of(soft_block({size, size, size}));
    LatticeSprings springs = make_springs(body, {});
    for (int j = 0; j < size; ++j) {
      for (int k = 0; k < size; ++k) {
        Slot slot = 0;
        EXPECT_TRUE(slot_of(body.elements, {0, j, k}, slot));
        hold(springs.system, springs.node_of(slot));
      }
    }
    springs.system.gravity_m_s2 = {40, 0, 0};
    std::vector<char> is_held(springs.system.node_count(), 0);
    for (const HeldNode& held : springs.system.held) is_held[held.node] = 1;
    EXPECT_EQ(SpringMatrix(springs.system, is_held).is_direct(), size < 12);
    const MinimiseReport report = minimise(springs.system, {1e-4, 500});
    EXPECT_TRUE(report.converged) << size;
    // The held layer carries the weight of all others.
    std::vector<Vec3d> force;
    forces_mn(springs.system, force, Damping::without);
    Vec3d sum(0.0);
    for (const HeldNode& held : springs.system.held) sum += force[held.node];
    const double weight_mn = std::pow(size, 3) * 1e-6 * 40e3;
    EXPECT_NEAR(sum.x, weight_mn, 1e-2 * weight_mn);
  };
  relaxed(6);
  relaxed(12);
}

TEST(ExtremesLatticeSprings, OffsetsBeyondTheRangeAreRefusedAndTheBodyStays) {
  Body body = soft_row(3);
  LatticeSprings springs = make_springs(body, {});
  springs.system.pos_mm[0].x += 1;
  springs.system.pos_mm[2].x += 16384;
  EXPECT_NE(input_error([&] { give_state(springs, body); }).find("2,0,0"), std::string::npos);
  EXPECT_TRUE(body.q[0].empty());
}
