// Conventions of bone laboratories: full integration, and common nodes of voxels that touch by an
// edge or a corner alone; and what hangs there without being held.
#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>
#include <gtest/gtest.h>

#include "lib/fem/dynamics/modes.h"
#include "lib/fem/voxel/fem_results.h"
#include "lib/fem/voxel/hinges.h"
#include "lib/model/fem_model.h"
#include "lib/model/fem_motion.h"
#include "tests/lib/fem_fixtures.h"

using namespace supple;
using namespace supple::test;

namespace {

const ElementChoice kJoined(Dilatation::pointwise, Touching::joined);

/// A body of these voxels.
Body body_at(const std::vector<Vec3i>& voxels) {
  int n = 1;
  for (const Vec3i& voxel : voxels) n = std::max({n, voxel.x + 1, voxel.y + 1, voxel.z + 1});
  return fem_body(n, [&](const Vec3i& voxel) {
    return std::find(voxels.begin(), voxels.end(), voxel) == voxels.end() ? -1 : 0;
  });
}

NodeIndex nodes_of(const std::vector<Vec3i>& voxels, Touching touching) {
  return hex_mesh(body_at(voxels), {touching}).node_count();
}

/// A sponge: of n^3 voxels those where random waves are positive, in two classes.
Body sponge(std::mt19937& random, int n, double fraction = 0) {
  std::array<Vec3d, 5> waves;
  std::array<double, 5> phases;
  for (Vec3d& wave : waves) {
    for (int a = 0; a < 3; ++a) wave[a] = pick(random, -2, 2);
  }
  for (double& phase : phases) phase = pick(random, 0, 2 * kPi);
  const std::uint32_t classes = std::uint32_t(random());
  return fem_body(n, [=](const Vec3i& voxel) {
    double sum = 0;
    for (std::size_t w = 0; w < waves.size(); ++w) {
      sum += std::sin(waves[w].dot(Vec3d(voxel)) + phases[w]);
    }
    if (sum < fraction) return -1;
    return int((classes >> ((voxel.x * 3 + voxel.y * 5 + voxel.z * 7) % 31)) & 1);
  });
}

/// One link in twelve, so that pieces at corners are parted in all ways.
void cut_some_links(std::mt19937& random, Body& body) {
  for (std::size_t b = 0; b < body.elements.brick_count(); ++b) {
    for_each_link(body.elements, LinkCuts{}, b, [&](int axis, Slot low, Slot) {
      if (random() % 12 == 0) body.cuts.cut(b, int(low % kBrickVoxels), axis);
    });
  }
}

ElasticTable two_tissues(std::mt19937& random) {
  ElasticTable elastic = ElasticTable::uniform(1, 0.3);
  for (std::size_t n = 0; n < 2; ++n) {
    elastic.young_kpa[n] = std::pow(10, pick(random, 0, 2));
    elastic.poisson[n] = pick(random, 0, 0.4);
  }
  return elastic;
}

/// Both ends of a body along z held, the upper one moved.
FemLoads pressed(const Body& body, int n) {
  FemLoads loads;
  loads.held.push_back(hold_where(body, [](const Vec3d& x) { return x.z < 0.1 - 0.5; }));
  loads.held.push_back(hold_where(
      body, [n](const Vec3d& x) { return x.z > n - 0.5 - 0.1; },
      [](const Vec3d&) { return Vec3d(0, 0, -0.01); }));
  return loads;
}

double largest_in(const std::vector<double>& values) {
  double most = 0;
  for (const double value : values) most = std::max(most, std::abs(value));
  return most;
}

}  // namespace

TEST(UnitFemTouching, VoxelsThatTouchByAnEdgeOrACornerShareItsNodesWhereTheyAreJoined) {
  const std::vector<Vec3i> edge = {{0, 0, 0}, {1, 1, 0}}, corner = {{0, 0, 0}, {1, 1, 1}};
  EXPECT_EQ(nodes_of(edge, Touching::apart), 16);
  EXPECT_EQ(nodes_of(edge, Touching::joined), 14);
  EXPECT_EQ(nodes_of(corner, Touching::apart), 16);
  EXPECT_EQ(nodes_of(corner, Touching::joined), 15);
  // Across blocks, too.
  EXPECT_EQ(nodes_of({{7, 7, 7}, {8, 8, 8}}, Touching::joined), 15);
  EXPECT_EQ(nodes_of({{7, 7, 3}, {8, 8, 3}}, Touching::joined), 14);
}

TEST(UnitFemTouching, ACutPartsElementsAlsoWhereTheyWouldBeJoined) {
  Block square = homogeneous(Vec3i(2, 2, 1), 1.5, 0.5, 0.5);
  Body body = body_of(square);
  const auto nodes = [&](Touching touching) { return hex_mesh(body, {touching}).node_count(); };
  EXPECT_EQ(nodes(Touching::joined), 18);
  // One of two links is cut: around its end all is one piece.
  body.cuts.cut(0, brick_offset({0, 0, 0}), 0);
  EXPECT_EQ(nodes(Touching::joined), nodes(Touching::apart));
  body.cuts.cut(0, brick_offset({0, 1, 0}), 0);
  EXPECT_EQ(nodes(Touching::joined), 24);
  EXPECT_EQ(nodes(Touching::apart), 24);
}

/// h (lambda + 4 mu) / 9, h (lambda + mu) / 12 and -h (lambda + mu) / 9 by integrals of products of
/// slopes; with the mean dilatation kappa counts a sixteenth of h where it counts a ninth.
TEST(UnitFemTouching, OneElementHasTheStiffnessOfIntegralsByHand) {
  constexpr double kEdge = 0.5, kYoung = 7, kPoisson = 0.3;
  const ElasticModuli moduli = elastic_moduli(kYoung, kPoisson);
  const double mu = moduli.shear_kpa, lambda = moduli.bulk_kpa - 2 * mu / 3;
  const auto entries = [&](Dilatation dilatation) {
    const FemModel model(fem_cube(1, kEdge), ElasticTable::uniform(kYoung, kPoisson), dilatation);
    std::vector<double> u(24), force;
    u[0] = 1;
    model.apply(u, force);
    const std::vector<Vec3d> positions = node_positions(model.mesh());
    std::array<double, 3> found{force[0], force[1], 0};
    for (std::size_t n = 1; n < 8; ++n) {
      const Vec3d arm = positions[n] - positions[0];
      if (arm.x != 0 && arm.y == 0 && arm.z == 0) found[2] = force[3 * n];
    }
    return found;
  };
  const std::array<double, 3> full = entries(Dilatation::pointwise);
  EXPECT_NEAR(full[0], kEdge * (lambda + 4 * mu) / 9, 1e-12);
  EXPECT_NEAR(std::abs(full[1]), kEdge * (lambda + mu) / 12, 1e-12);
  EXPECT_NEAR(full[2], -kEdge * (lambda + mu) / 9, 1e-12);
  const std::array<double, 3> mean = entries(Dilatation::mean);
  EXPECT_NEAR(full[0] - mean[0], moduli.bulk_kpa * kEdge * (1.0 / 9 - 1.0 / 16), 1e-12);
}

/// The patch test, and no energy of rigid motions.
TEST(PropertyFemTouching, AffineMotionsOfABlockAndRigidOnesOfAnyBodyLeaveNoForces) {
  std::mt19937 random(3);
  const auto forces = [](const FemModel& model, const std::array<Vec3d, 3>& rows) {
    std::vector<double> u, force;
    for (const Vec3d& x : node_positions(model.mesh())) {
      u.insert(u.end(), {rows[0].dot(x), rows[1].dot(x), rows[2].dot(x)});
    }
    model.apply(u, force);
    return force;
  };
  constexpr int kN = 9;
  const FemModel block(fem_cube(kN), ElasticTable::uniform(5, 0.3), kJoined);
  const std::vector<double> force =
      forces(block, {Vec3d(0.1, 0.3, -0.2), Vec3d(0.05, -0.2, 0.1), Vec3d(-0.3, 0.2, 0.15)});
  const std::vector<Vec3d> positions = node_positions(block.mesh());
  for (std::size_t n = 0; n < positions.size(); ++n) {
    const Vec3d& x = positions[n];
    const auto is_inner = [](double at) { return at > -0.4 && at < kN - 0.6; };
    if (!is_inner(x.x) || !is_inner(x.y) || !is_inner(x.z)) continue;
    for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(force[3 * n + a], 0, 1e-12);
  }
  for (int round = 0; round < 4; ++round) {
    const FemModel model(sponge(random, 12), two_tissues(random), kJoined);
    const double strained =
        largest_in(forces(model, {Vec3d(1, 0, 0), Vec3d(0, 0, 0), Vec3d(0, 0, 0)}));
    const double turned =
        largest_in(forces(model, {Vec3d(0, 0.3, -0.2), Vec3d(-0.3, 0, 0.1), Vec3d(0.2, -0.1, 0)}));
    EXPECT_LT(turned, 1e-12 * strained);
  }
}

TEST(PropertyFemTouching, ProductsAreThoseOfAnAssembledMatrixWithOrWithoutCuts) {
  std::mt19937 random(8);
  int joined = 0;
  for (int round = 0; round < 16; ++round) {
    Body body = sponge(random, 14, pick(random, 0, 1));
    if (round % 2 == 0) cut_some_links(random, body);
    const ElasticTable elastic = random_elastic(random);
    const ElementChoice choice(round % 4 < 2 ? Dilatation::pointwise : Dilatation::mean,
                               Touching::joined);
    const FemModel model(body, elastic, choice);
    joined += model.mesh().node_count() < hex_mesh(body).node_count();
    const Eigen::SparseMatrix<double> k = assembled_stiffness(body, model.mesh(), elastic, choice);
    const std::vector<double> u = random_values(random, std::size_t(k.rows()));
    std::vector<double> force;
    model.apply(u, force);
    const Eigen::VectorXd want =
        k * Eigen::Map<const Eigen::VectorXd>(u.data(), Eigen::Index(u.size()));
    const Eigen::Map<const Eigen::VectorXd> found(force.data(), Eigen::Index(force.size()));
    EXPECT_LT((found - want).lpNorm<Eigen::Infinity>(), 1e-11 * want.lpNorm<Eigen::Infinity>());
  }
  EXPECT_EQ(joined, 16);
}

/// Small bodies: what hangs is all that the free part of the matrix has no energy for.
TEST(PropertyFemTouching, HingesAreToldExactlyWhereTheMatrixIsSingular) {
  std::mt19937 random(11);
  int singular = 0, regular = 0;
  for (int round = 0; round < 60; ++round) {
    std::vector<Vec3i> voxels;
    for (int n = 0; n < 27; ++n) {
      if (random() % 100 < 35) voxels.emplace_back(n / 9, n / 3 % 3, n % 3);
    }
    if (voxels.size() < 2) continue;
    const Body body = body_at(voxels);
    const ElasticTable elastic = ElasticTable::uniform(1, 0.3);
    FemModel model(body, elastic, kJoined);
    HeldBits held(std::size_t(model.mesh().node_count()));
    for (std::uint8_t& bits : held) bits = random() % 5 == 0 ? std::uint8_t(random() % 8) : 0;
    held[0] = 7;
    model.hold_loose(true, held);
    const std::vector<bool> hinged = hinged_elements(model.mesh(), held);
    const auto lowest = [&](const FemModel& of, const HeldBits& bits, const ElementChoice& choice) {
      Eigen::MatrixXd k = free_part(assembled_stiffness(body, of.mesh(), elastic, choice), bits);
      if (k.rows() == 0) return 1.0;
      return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(k, Eigen::EigenvaluesOnly)
          .eigenvalues()[0];
    };
    const double least = lowest(model, held, kJoined);
    EXPECT_EQ(hinged.empty(), least > 1e-9) << round << " " << least;
    (hinged.empty() ? regular : singular) += 1;
  }
  EXPECT_GT(singular, 10);
  EXPECT_GT(regular, 10);
}

/// A voxel that hangs at an edge is left where it was, and the rest goes as without it.
TEST(PropertyFemTouching, WhatHangsByAnEdgeIsLooseAndBothersNothing) {
  std::vector<Vec3i> bar;
  for (int n = 0; n < 72; ++n) bar.emplace_back(1 + n % 3, 1 + n / 3 % 3, n / 9);
  std::vector<Vec3i> with_speck = bar;
  with_speck.emplace_back(4, 4, 4);
  with_speck.emplace_back(5, 4, 4);
  const ElasticTable elastic = ElasticTable::uniform(5, 0.3);
  const auto energy_of = [&](const std::vector<Vec3i>& voxels, const FemParams& params,
                             FemReport& report) {
    Body body = body_at(voxels);
    const std::vector<Region> anchors{Region(IndexBox{{1, 1, 0}, {3, 3, 0}})};
    Holds holds;
    VoxelFemModel model({body, anchors, holds}, elastic, {}, params);
    model.move({{IndexBox{{1, 1, 7}, {3, 3, 7}}, {kVoxel / 8, 0, kVoxel / 5}}}, 1, nullptr);
    report = model.report();
    return report.energy_mj;
  };
  for (const StrainTheory strain : {StrainTheory::linear, StrainTheory::finite}) {
    FemParams params;
    params.strain = strain;
    params.elements = kJoined;
    params.tolerance = 1e-9;
    FemReport without, with;
    const double expected = energy_of(bar, params, without);
    EXPECT_NEAR(energy_of(with_speck, params, with), expected, 1e-8 * expected);
    EXPECT_EQ(without.loose_islands, 0);
    EXPECT_EQ(with.loose_islands, 1);
    EXPECT_EQ(with.loose_elements, 2);
    params.loose = LooseIslands::refuse;
    EXPECT_THROW(energy_of(with_speck, params, with), InputError);
  }
  // A program that does not part hinges is told of them.
  const Body body = body_at(with_speck);
  FemLoads loads;
  loads.held.push_back(hold_where(body, [](const Vec3d& x) { return x.z < 0; }));
  EXPECT_THROW(FemModel(body, elastic, kJoined).solve(loads), InputError);
  EXPECT_NO_THROW(FemModel(body, elastic, Dilatation::pointwise).solve(loads));
}

/// Displacements that keep more nodes together store no less energy, and no energy of a mean square
/// is below that of the squared mean.
TEST(PropertyFemTouching, BothConventionsMakeASpongeStiffer) {
  std::mt19937 random(17);
  constexpr int kN = 20;
  for (int round = 0; round < 2; ++round) {
    const Body body = sponge(random, kN, 0.4);
    const ElasticTable elastic = ElasticTable::uniform(10, 0.3);
    const auto solve = [&](const ElementChoice& choice) {
      FemModel model(body, elastic, choice);
      const FemLoads loads = pressed(body, kN);
      while (model.part_hinges(body, held_bits(model.mesh(), loads.held))) {
      }
      return model.solve(loads).report;
    };
    const FemReport today = solve({}), full = solve(Dilatation::pointwise),
                    joined = solve({Dilatation::mean, Touching::joined}), both = solve(kJoined);
    EXPECT_GT(full.energy_mj, 1.001 * today.energy_mj);
    EXPECT_GT(joined.energy_mj, 1.0001 * today.energy_mj);
    EXPECT_GT(both.energy_mj, full.energy_mj);
    EXPECT_GT(both.energy_mj, joined.energy_mj);
    EXPECT_LT(both.iterations, 2 * today.iterations);
  }
}

TEST(PropertyFemTouching, EquilibriaAreThoseOfADirectSolver) {
  std::mt19937 random(23);
  constexpr int kN = 13;
  for (int round = 0; round < 5; ++round) {
    const Body body = sponge(random, kN, 0.3);
    const ElasticTable elastic = two_tissues(random);
    FemModel model(body, elastic, kJoined);
    const FemLoads loads = pressed(body, kN);
    if (model.part_hinges(body, held_bits(model.mesh(), loads.held))) {
      model.join_hinges(body);
      continue;
    }
    NodalLoads nodal = nodal_loads(model.mesh(), model.material(), loads);
    model.hold_loose(true, nodal.held);
    FemParams params;
    params.tolerance = 1e-10;
    const FemSolution found = model.solve(loads, params);
    const Eigen::SparseMatrix<double> k = assembled_stiffness(body, model.mesh(), elastic, kJoined);
    std::vector<int> number(std::size_t(k.rows()), -1);
    int unknowns = 0;
    for (std::size_t n = 0; n < number.size(); ++n) {
      if ((nodal.held[n / 3] >> n % 3 & 1) == 0) number[n] = unknowns++;
    }
    Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns);
    std::vector<Eigen::Triplet<double>> entries;
    for (int column = 0; column < k.outerSize(); ++column) {
      for (Eigen::SparseMatrix<double>::InnerIterator at(k, column); at; ++at) {
        const int row = number[std::size_t(at.row())], free = number[std::size_t(column)];
        if (row < 0) continue;
        if (free >= 0) entries.emplace_back(row, free, at.value());
        if (free < 0) right[row] -= at.value() * nodal.u_mm[std::size_t(column)];
      }
    }
    Eigen::SparseMatrix<double> system(unknowns, unknowns);
    system.setFromTriplets(entries.begin(), entries.end());
    const Eigen::VectorXd u =
        Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(system).solve(right);
    for (std::size_t n = 0; n < number.size(); ++n) {
      if (number[n] < 0) continue;
      EXPECT_NEAR(found.u_mm[n], u[number[n]], 1e-7 * 0.01);
    }
  }
}

/// Pieces that hang swing about their edges; modes leave them out.
TEST(PropertyFemTouching, HingesMoveInTimeAndAreNoModes) {
  const std::vector<Vec3i> voxels = {{0, 0, 0}, {0, 0, 1}, {0, 0, 2}, {1, 1, 2}, {1, 1, 3}};
  const Body body = body_at(voxels);
  FemModel model(body, ElasticTable::uniform(20, 0.3), kJoined);
  const std::vector<HeldElements> grips = {
      hold_where(body, [](const Vec3d& x) { return x.z < 0; })};
  FemLoads loads;
  loads.held = grips;
  loads.mass_density.fill(1000);
  loads.gravity_m_s2 = Vec3d(9.81, 0, 0);
  Newmark motion(model, even_density(1000), {}, nodal_loads(model.mesh(), model.material(), loads),
                 {2e-4});
  const std::size_t count = 3 * std::size_t(model.mesh().node_count());
  motion.start(std::vector<double>(count), std::vector<double>(count));
  for (int n = 0; n < 20; ++n) motion.step({});
  const MotionEnergy energy = motion.energy();
  EXPECT_NEAR(energy.elastic_mj + energy.kinetic_mj, energy.work_mj, 1e-5 * energy.work_mj);
  ASSERT_TRUE(model.part_hinges(body, held_bits(model.mesh(), grips)));
  EXPECT_FALSE(model.part_hinges(body, held_bits(model.mesh(), grips)));
  const VibrationModes found =
      lowest_modes(model, even_density(1000), held_bits(model.mesh(), grips), {3});
  EXPECT_GT(found.modes[0].frequency_hz, 1);
  EXPECT_EQ(found.report.loose_elements, 2);
}
