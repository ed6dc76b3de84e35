// Pieces of thin parts as a coarse space of the finite elements' cycle.
#include <algorithm>
#include <cstdlib>
#include <random>

#include <gtest/gtest.h>

#include "lib/fem/node_vectors.h"
#include "lib/fem/voxel/fem.h"
#include "lib/fem/voxel/multigrid.h"
#include "lib/fem/voxel/thin_pieces.h"
#include "tests/lib/fem_fixtures.h"
#include "tests/support/sanitized.h"

using namespace supple;
using namespace supple::test;

namespace {

/// A strip of a plate of one voxel that stands out from a wall into a room, as the septum of a
/// nose.
Body plate_in_a_room(int n) {
  return fem_body(n, [n](const Vec3i& v) {
    const int to_wall = std::min({v.x, v.y, n - 1 - v.x, n - 1 - v.y, v.z, n - 1 - v.z});
    return to_wall < 6 || (v.z == n / 2 && v.y < 3 * n / 4 && std::abs(v.x - n / 2) < 4) ? 1 : -1;
  });
}

/// Here and there, and an element of every island.
HeldBits hold_some(std::mt19937& random, const HexMesh& mesh) {
  HeldBits held(std::size_t(mesh.node_count()), 0);
  for (std::uint8_t& bits : held) bits = random() % 30 == 0 ? std::uint8_t(random() % 8) : 0;
  const Islands islands = find_islands(mesh);
  std::vector<bool> is_held(std::size_t(islands.count), false);
  for (std::int32_t e = 0; e < mesh.element_count(); ++e) {
    const auto island = std::size_t(islands.of_element[std::size_t(e)]);
    if (is_held[island]) continue;
    is_held[island] = true;
    for (const NodeIndex node : mesh.corners(e)) held[std::size_t(node)] = kAllHeld;
  }
  return held;
}

}  // namespace

TEST(PropertyFemPieces, TheCycleGivesBackWhatPiecesCanDo) {
  // B K z = z for motions z of the pieces, whatever the levels make of them.
  std::mt19937 random(12);
  int checked = 0;
  for (int round = 0; round < 8; ++round) {
    const Body body = round == 0 ? plate_in_a_room(24) : random_fem_body(random, Vec3i(26, 24, 22));
    const FemModel model(body, random_elastic(random));
    const HexMesh& mesh = model.mesh();
    const HeldBits held = hold_some(random, mesh);
    ThinPieces pieces(model.stiffness(), model.material(), held, nullptr);
    if (pieces.count() == 0) continue;
    Multigrid multigrid(model.levels(), model.stiffness(), model.material(), held, {}, nullptr);
    if (multigrid.level_count() == 1) continue;
    ++checked;

    const std::size_t unknowns = 3 * std::size_t(mesh.node_count());
    std::vector<float> forces(unknowns), z(unknowns, 0), r(unknowns, 0), back(unknowns, 0);
    for (float& force : forces) force = float(pick(random, -1, 1));
    pieces.take_forces(forces.data());
    pieces.solve();
    pieces.add_motions(z.data());
    model.stiffness().add(z.data(), r.data());
    multigrid.cycle(r.data(), back.data());
    double most = 0, error = 0;
    for (std::size_t n = 0; n < unknowns; ++n) {
      if ((held[n / 3] >> n % 3 & 1) != 0) {
        EXPECT_EQ(z[n], 0);
        continue;
      }
      most = std::max(most, std::abs(double(z[n])));
      error = std::max(error, std::abs(double(back[n]) - z[n]));
    }
    EXPECT_GT(most, 0);
    EXPECT_LT(error, 2e-3 * most) << "round " << round;
  }
  EXPECT_GE(checked, 4);
}

TEST(PropertyFemPieces, ThickBodiesHaveNone) {
  const FemModel model(fem_cube(20), ElasticTable::uniform(6, 0.3));
  const HeldBits none(std::size_t(model.mesh().node_count()), 0);
  EXPECT_EQ(ThinPieces(model.stiffness(), model.material(), none, nullptr).count(), 0U);
}

TEST(PropertyFemPieces, ManyIslandsHaveNone) {
  // Single voxels, 4,913 of them: motions of their own that no factorisation should carry.
  const Body body = fem_body(
      34, [](const Vec3i& v) { return v.x % 2 == 0 && v.y % 2 == 0 && v.z % 2 == 0 ? 1 : -1; });
  const FemModel model(body, ElasticTable::uniform(6, 0.3));
  const HeldBits none(std::size_t(model.mesh().node_count()), 0);
  EXPECT_EQ(ThinPieces(model.stiffness(), model.material(), none, nullptr).count(), 0U);
}

TEST(PropertyFemPieces, OfALargePlateLargerCubesJoin) {
  const int n = 240;
  const Body body = fem_body(n, [](const Vec3i& v) { return v.z == 1 ? 1 : -1; });
  const FemModel model(body, ElasticTable::uniform(6, 0.3));
  const HeldBits none(std::size_t(model.mesh().node_count()), 0);
  EXPECT_EQ(ThinPieces(model.stiffness(), model.material(), none, nullptr).count(),
            std::size_t(n / 16) * (n / 16));
}

TEST(PropertyFemPieces, TheCycleIsSymmetricToMotionsOfPieces) {
  // (K z).(B x) = z.x for motions z of the pieces and any forces x, as B K z = z.
  std::mt19937 random(13);
  const FemModel model(plate_in_a_room(24), ElasticTable::uniform(6, 0.3));
  const HeldBits held = hold_some(random, model.mesh());
  ThinPieces pieces(model.stiffness(), model.material(), held, nullptr);
  Multigrid multigrid(model.levels(), model.stiffness(), model.material(), held, {}, nullptr);
  const std::size_t unknowns = 3 * std::size_t(model.mesh().node_count());
  std::vector<float> x(unknowns, 0), z(unknowns, 0), kz(unknowns, 0), bx(unknowns);
  for (std::size_t n = 0; n < unknowns; ++n) {
    if ((held[n / 3] >> n % 3 & 1) == 0) x[n] = float(pick(random, -1, 1));
  }
  pieces.take_forces(x.data());
  pieces.solve();
  pieces.add_motions(z.data());
  model.stiffness().add(z.data(), kz.data());
  std::vector<float> used = x;
  multigrid.cycle(used.data(), bx.data());
  double kz_bx = 0, z_x = 0;
  for (std::size_t n = 0; n < unknowns; ++n) {
    const bool is_held = (held[n / 3] >> n % 3 & 1) != 0;
    kz_bx += is_held ? 0 : double(kz[n]) * bx[n];
    z_x += double(z[n]) * x[n];
  }
  EXPECT_GT(z_x, 0);
  EXPECT_NEAR(kz_bx, z_x, 1e-3 * z_x);
}

TEST(PropertyFemPieces, TheCycleIsSymmetricForForcesOnAPlate) {
  // x.(B y) = y.(B x): as many steps of thin parts after the levels as before them.
  const int wall = 20;
  const Body body = fem_body(30, [](const Vec3i& v) {
    return v.x < wall || (v.z == 10 && std::abs(v.y - 15) < 5) ? 1 : -1;
  });
  std::mt19937 random(14);
  const FemModel model(body, ElasticTable::uniform(6, 0.3));
  const std::vector<Vec3d> positions = node_positions(model.mesh());
  HeldBits held(positions.size(), 0);
  for (std::size_t node = 0; node < held.size(); ++node) {
    if (positions[node].x < 1) held[node] = kAllHeld;
  }
  const ThinPieces pieces(model.stiffness(), model.material(), held, nullptr);
  ASSERT_GT(pieces.count(), 0U);
  ASSERT_LT(pieces.groups().share, 0.1) << "or there are no further steps";
  Multigrid multigrid(model.levels(), model.stiffness(), model.material(), held, {}, nullptr);
  ASSERT_LE(multigrid.level_count(), 3) << "steps of conjugate gradients are not linear";
  const std::size_t unknowns = 3 * positions.size();
  std::vector<float> x[2], bx[2];
  for (int side = 0; side < 2; ++side) {
    x[side].resize(unknowns, 0);
    bx[side].resize(unknowns);
    for (std::size_t n = 0; n < unknowns; ++n) {
      if (positions[n / 3].x > wall) x[side][n] = float(pick(random, -1, 1));
    }
    std::vector<float> used = x[side];
    multigrid.cycle(used.data(), bx[side].data());
  }
  const double scale = dot(x[0].data(), bx[0].data(), unknowns);
  EXPECT_GT(scale, 0);
  EXPECT_NEAR(dot(x[0].data(), bx[1].data(), unknowns), dot(x[1].data(), bx[0].data(), unknowns),
              1e-4 * scale);
}

TEST(PropertyFemPieces, AThinPlateCostsFewIterations) {
  const Body body = plate_in_a_room(56);
  const FemModel model(body, ElasticTable::uniform(6, 0.3));
  FemLoads loads;
  loads.held.push_back(hold_where(body, [](const Vec3d& at) { return at.y < 1; }));
  const int middle = 56 / 2, tip = 3 * 56 / 4 - 1;
  ForceOnElements& push = loads.forces.emplace_back();
  push.elements = elements_in(body, {{middle - 4, tip, middle}, {middle + 3, tip, middle}});
  push.force_n = {0, 0, 1e-6};
  // 31 without pieces, 20 without further steps.
  EXPECT_LE(model.solve(loads, {}).report.iterations, 16);
}

TEST(PropertyFemPieces, FurtherStepsConvergeWhateverThinPartsAreMadeOf) {
  LEFT_OUT_WHEN_SANITIZED();
  // A plate whose elements have larger eigenvalues of D^-1 K than the wall, of which an estimate
  // by vectors of the whole body knows little.
  for (const double poisson : {0.0, 0.45, 0.49}) {
    const Body body = fem_body(40, [](const Vec3i& v) {
      return v.x < 30 ? 0 : v.z == 10 && std::abs(v.y - 20) < 6 ? 1 : -1;
    });
    ElasticTable elastic = ElasticTable::uniform(6, 0.3);
    elastic.poisson[1] = poisson;
    const FemModel model(body, elastic);
    FemLoads loads;
    loads.held.push_back(hold_where(body, [](const Vec3d& at) { return at.x < 1; }));
    ForceOnElements& push = loads.forces.emplace_back();
    push.elements = elements_in(body, {{39, 15, 10}, {39, 25, 10}});
    push.force_n = {0, 0, 1e-6};
    EXPECT_LE(model.solve(loads, {}).report.iterations, 25) << "nu of the plate " << poisson;
  }
}

TEST(PropertyFemPieces, WhatIsHeldAsAWholeIsLeftOut) {
  // A linear displacement of two thirds of a body, and of its surface, is that of all of it.
  const int n = 24, free_from = 16;
  const Body body = fem_body(n, [](const Vec3i&) { return 1; });
  const auto linear = [](const Vec3d& at) { return Vec3d(0.01 * at.y, 0.02 * at.x, 0.01 * at.z); };
  const FemModel model(body, ElasticTable::uniform(6, 0.3));
  FemLoads loads;
  const auto is_inside = [](double x) { return x > 1 && x < n - 2; };
  loads.held.push_back(hold_where(
      body,
      [&](const Vec3d& at) {
        return at.x < free_from || !is_inside(at.x) || !is_inside(at.y) || !is_inside(at.z);
      },
      linear));
  const FemSolution solution = model.solve(loads, {});
  EXPECT_LE(solution.report.iterations, 10);
  const std::vector<Vec3d> positions = node_positions(model.mesh());
  for (std::size_t node = 0; node < positions.size(); ++node) {
    const Vec3d expected = linear(positions[node]);
    for (int a = 0; a < 3; ++a) {
      EXPECT_NEAR(solution.u_mm[3 * node + std::size_t(a)], expected[a], 1e-5);
    }
  }
}
