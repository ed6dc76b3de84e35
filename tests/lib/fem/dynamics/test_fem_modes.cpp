// Lowest modes of vibration against a dense solver, formulas and laws.
#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "lib/fem/dynamics/modes.h"
#include "lib/fem/voxel/loose_islands.h"
#include "tests/lib/fem_fixtures.h"
#include "tests/support/sanitized.h"
#include "volumes/base/parallel.h"

using namespace supple;
using namespace supple::test;

namespace {

struct JudgedModes {
  VibrationModes found;
  Eigen::VectorXd eigenvalues;  // of the dense solver, with those of rigid motions
};

JudgedModes judge_modes(const Body& body, const ElasticTable& elastic, const MassDensities& density,
                        const std::vector<HeldElements>& held, int count) {
  const FemModel model(body, elastic);
  ModeParams params;
  params.count = count;
  HeldBits bits = held_bits(model.mesh(), held);
  JudgedModes judged{lowest_modes(model, density, bits, params), {}};
  hold_loose_islands(model.mesh(), !held.empty(), bits);
  const Eigen::MatrixXd stiffness =
      free_part(assembled_stiffness(body, model.mesh(), elastic, Dilatation::mean), bits);
  const Eigen::MatrixXd mass = free_part(assembled_mass(model, density), bits);
  judged.eigenvalues = Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(
                           stiffness, mass, Eigen::EigenvaluesOnly)
                           .eigenvalues();
  // The same products of the shapes by the assembled matrices: phi^T M phi = 1, phi^T K phi =
  // diag(omega^2).
  Eigen::MatrixXd shapes(3 * model.mesh().node_count(), count);
  for (int n = 0; n < count; ++n) {
    const std::vector<double>& shape = judged.found.modes[std::size_t(n)].shape;
    shapes.col(n) = Eigen::Map<const Eigen::VectorXd>(shape.data(), shapes.rows());
  }
  const Eigen::MatrixXd overlap = shapes.transpose() * assembled_mass(model, density) * shapes -
                                  Eigen::MatrixXd::Identity(count, count);
  EXPECT_LT(overlap.cwiseAbs().maxCoeff(), 1e-7);
  EXPECT_NEAR(judged.found.report.orthogonality, overlap.cwiseAbs().maxCoeff(), 1e-12);
  const Eigen::MatrixXd products =
      shapes.transpose() * assembled_stiffness(body, model.mesh(), elastic, Dilatation::mean) *
      shapes;
  for (int a = 0; a < count; ++a) {
    for (int b = 0; b < count; ++b) {
      const double expected = a == b ? judged.found.modes[std::size_t(a)].eigenvalue_per_s2 : 0;
      EXPECT_NEAR(products(a, b), expected, 1e-6 * products(count - 1, count - 1));
    }
  }
  return judged;
}

void expect_eigenvalues(const JudgedModes& judged) {
  const std::int64_t rigid = judged.found.report.rigid_modes;
  const double first = judged.eigenvalues[rigid];
  for (std::int64_t n = 0; n < rigid; ++n) EXPECT_LT(std::abs(judged.eigenvalues[n]), 1e-9 * first);
  for (std::size_t n = 0; n < judged.found.modes.size(); ++n) {
    const double expected = judged.eigenvalues[rigid + std::int64_t(n)];
    EXPECT_NEAR(judged.found.modes[n].eigenvalue_per_s2, expected, 1e-7 * expected) << n;
    EXPECT_NEAR(judged.found.modes[n].frequency_hz, std::sqrt(expected) / (2 * kPi),
                1e-7 * std::sqrt(expected));
  }
}

Body bar_of(const Vec3i& dims, double spacing_mm) {
  Block block = homogeneous(dims, 1.5, 0.5, 0.5);
  block.spacing_mm = Vec3d(spacing_mm);
  return body_of(block);
}

}  // namespace

TEST(PropertyFemModes, ModesAreThoseOfADenseSolverOnRandomBodies) {
  std::mt19937 random(31);
  for (int n = 0; n < 3; ++n) {
    const Body body = random_fem_body(random, Vec3i(6, 5, 6));
    MassDensities density;
    for (double& of : density) of = pick(random, 300, 2000);
    const Vec3d wave(pick(random, 1, 3), pick(random, 1, 3), pick(random, 1, 3));
    const std::vector<HeldElements> held{
        hold_where(body, [wave](const Vec3d& x) { return std::sin(wave.dot(x)) > 0.7; })};
    const JudgedModes judged = judge_modes(body, random_elastic(random), density, held, 6);
    expect_eigenvalues(judged);
  }
}

TEST(PropertyFemModes, SixRigidMotionsOfEachFreePieceAreLeftOutAndAlikeModesAllFound) {
  LEFT_OUT_WHEN_SANITIZED();
  // Two plates with a gap.
  const Body plates = fem_body(5, [](const Vec3i& v) { return v.x == 2 || v.y > 3 ? -1 : 0; });
  const JudgedModes judged =
      judge_modes(plates, ElasticTable::uniform(8, 0.3), even_density(1100), {}, 8);
  EXPECT_EQ(judged.found.report.rigid_modes, 12);
  expect_eigenvalues(judged);
  // The other plate stays at rest when one is held at its edge.
  const JudgedModes one =
      judge_modes(plates, ElasticTable::uniform(8, 0.3), even_density(1100),
                  {hold_where(plates, [](const Vec3d& x) { return x.x < -0.49; })}, 8);
  EXPECT_EQ(one.found.report.rigid_modes, 0);
  EXPECT_EQ(one.found.report.loose_islands, 1);
  expect_eigenvalues(one);
  const JudgedModes cube =
      judge_modes(fem_cube(3), ElasticTable::uniform(8, 0.3), even_density(1100), {}, 9);
  EXPECT_EQ(cube.found.report.rigid_modes, 6);
  expect_eigenvalues(cube);
  // Modes of a cube come in pairs and threes.
  EXPECT_NEAR(cube.found.modes[0].frequency_hz, cube.found.modes[1].frequency_hz, 1e-6);
  EXPECT_NEAR(cube.found.report.mass_kg, 27 * 1100e-9, 1e-15);
}

TEST(PropertyFemModes, ModesHaveTheSameBitsOnAnyNumberOfThreads) {
  LEFT_OUT_WHEN_SANITIZED();
  std::mt19937 random(32);
  const Body body = random_fem_body(random, Vec3i(14, 14, 14));
  const FemModel model(body, random_elastic(random));
  ModeParams params;
  params.count = 3;
  for (const bool is_free : {false, true}) {
    std::vector<HeldElements> held;
    if (!is_free) {
      held.push_back(hold_where(body, [](const Vec3d& x) { return std::sin(x.y) > 0.9; }));
    }
    const auto find = [&] {
      std::vector<std::vector<double>> shapes;
      for (const VibrationMode& mode :
           lowest_modes(model, even_density(1000), held_bits(model.mesh(), held), params).modes) {
        shapes.push_back(mode.shape);
      }
      return shapes;
    };
    const auto one = on_threads(1, find);
    EXPECT_EQ(on_threads(3, find), one);
  }
}

TEST(ConvergenceFemModes, ABarSwingsAlongItselfAsTheFormulaSays) {
  LEFT_OUT_WHEN_SANITIZED();
  constexpr double kLength = 24, kYoung = 12, kDensity = 1000;
  const double speed_mm_s = std::sqrt(kYoung * 1e3 / kDensity) * 1e3;
  const double exact = speed_mm_s / (4 * kLength);
  std::vector<double> errors;
  for (const int n : {4, 8, 16}) {
    const Body body = bar_of({1, 1, n}, kLength / n);
    HeldElements end = hold_where(body, [n](const Vec3d& x) { return x.z < -0.49 * kLength / n; });
    HeldElements straight = hold_where(body, [](const Vec3d&) { return true; });
    straight.axes = {true, true, false};
    end.axes = {false, false, true};
    ModeParams params;
    params.count = 1;
    const FemModel model(body, ElasticTable::uniform(kYoung, 0));
    const VibrationModes found = lowest_modes(model, even_density(kDensity),
                                              held_bits(model.mesh(), {straight, end}), params);
    const VibrationMode& along = found.modes[0];
    errors.push_back(along.frequency_hz / exact - 1);
    // A quarter of a wave: 8 / pi^2 of the mass.
    EXPECT_NEAR(along.effective_mass_kg().z / found.report.mass_kg, 32 / ((2 * kPi) * (2 * kPi)),
                0.02);
  }
  EXPECT_LT(errors.back(), 5e-4);
  EXPECT_GT(errors.back(), 0);  // a consistent mass comes from above
  for (const double order : orders_of(errors)) EXPECT_NEAR(order, 2, 0.05);
}

TEST(ConvergenceFemModes, ABeamBendsAsTimoshenkoSays) {
  LEFT_OUT_WHEN_SANITIZED();
  constexpr double kLength = 32, kHeight = 4, kYoung = 12, kDensity = 1000;
  // Simply supported: w = sin(k z), which Timoshenko's equations have exactly.
  const double e = kYoung * 1e3, shear = 5.0 / 6 * e / 2, height = kHeight * 1e-3;
  const double k = (2 * kPi) / (kLength * 2e-3), inertia = height * height / 12;
  const double a = kDensity * kDensity * inertia / shear;
  const double b = kDensity * (1 + inertia * k * k * (1 + e / shear));
  const double c = e * inertia * k * k * k * k;
  const double exact = std::sqrt((b - std::sqrt(b * b - 4 * a * c)) / (2 * a)) / (2 * kPi);
  std::vector<double> errors;
  for (const int n : {2, 4, 8}) {
    const double h = kHeight / n;
    const Body body = bar_of({n, 1, int(kLength / kHeight) * n}, h);
    HeldElements flat = hold_where(body, [](const Vec3d&) { return true; });
    flat.axes = {false, true, false};
    const auto is_end = [h](const Vec3d& x) { return x.z < -0.49 * h || x.z > kLength - 0.51 * h; };
    HeldElements ends = hold_where(body, is_end),
                 middle = hold_where(body, [h](const Vec3d&x) {
                   return std::abs(x.z + h / 2 - kLength / 2) < h / 4;
                 });
    ends.axes = {true, false, false};
    middle.axes = {false, false, true};
    ModeParams params;
    params.count = 1;
    const FemModel model(body, ElasticTable::uniform(kYoung, 0));
    const VibrationModes found = lowest_modes(
        model, even_density(kDensity), held_bits(model.mesh(), {flat, ends, middle}), params);
    errors.push_back(found.modes[0].frequency_hz / exact - 1);
  }
  EXPECT_LT(std::abs(errors.back()), 0.02);
  for (const double order : orders_of(errors)) EXPECT_GT(order, 1.9);
}

TEST(UnitFemModes, WhatHasNoModesIsAnError) {
  const Body body = bar_of({1, 1, 2}, 1);
  const FemModel model(body, ElasticTable::uniform(5, 0.3));
  const std::vector<HeldElements> end{hold_where(body, [](const Vec3d& x) { return x.z < -0.49; })};
  ModeParams params;
  params.count = 13;  // 24 components are free
  EXPECT_THROW(lowest_modes(model, even_density(1000), held_bits(model.mesh(), end), params),
               InputError);
  params.count = 12;
  EXPECT_EQ(
      lowest_modes(model, even_density(1000), held_bits(model.mesh(), end), params).modes.size(),
      12u);
  params.count = 1;
  EXPECT_THROW(lowest_modes(model, even_density(0), held_bits(model.mesh(), end), params),
               InputError);
  EXPECT_THROW(
      lowest_modes(model, even_density(1000),
                   held_bits(model.mesh(), {hold_where(body, [](const Vec3d&) { return true; })}),
                   params),
      InputError);
  params.max_iterations = 0;
  EXPECT_THROW(lowest_modes(model, even_density(1000), held_bits(model.mesh(), end), params),
               InputError);
}
