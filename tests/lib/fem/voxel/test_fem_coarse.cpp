// Elements of several voxels: the best displacement that their mesh can have.
#include <cmath>

#include <Eigen/QR>
#include <gtest/gtest.h>

#include "lib/fem/voxel/loose_islands.h"
#include "lib/fem/voxel/multigrid.h"
#include "tests/lib/fem_fixtures.h"
#include "tests/support/sanitized.h"
#include "volumes/base/parallel.h"

using namespace supple;
using namespace supple::test;

namespace {

/// Trilinear from the corners of the voxels that the nodes lie at, whatever is held.
Eigen::MatrixXd interpolation(const MeshLevels& levels, int doublings) {
  const HexMesh& coarse = levels.meshes[std::size_t(doublings)];
  Eigen::MatrixXd all = Eigen::MatrixXd::Identity(coarse.node_count(), coarse.node_count());
  for (int level = doublings - 1; level >= 0; --level) {
    const HexMesh& fine = levels.meshes[std::size_t(level)];
    const HexMesh& above = levels.meshes[std::size_t(level) + 1];
    const Coarsening& lies = levels.coarsenings[std::size_t(level)];
    Eigen::MatrixXd one = Eigen::MatrixXd::Zero(fine.node_count(), above.node_count());
    for (NodeIndex n = 0; n < fine.node_count(); ++n) {
      const int place = lies.node_place[std::size_t(n)];
      const int halves[3] = {place / 9, place / 3 % 3, place % 3};
      const Corners corners = corners_around(fine, above, lies, n);
      for (int c = 0; c < 8; ++c) {
        double weight = 1;
        for (int a = 0; a < 3; ++a) {
          weight *= ((c >> (2 - a) & 1) != 0 ? halves[a] : 2 - halves[a]) / 2.0;
        }
        one(n, corners[std::size_t(c)]) += weight;
      }
    }
    all = one.sparseView() * all;
  }
  return all;
}

/// u = g + P z that minimises u K u / 2 - f u, by dense matrices.
Eigen::VectorXd best_by_force(const FemModel& model, const Eigen::SparseMatrix<double>& stiffness,
                              const NodalLoads& loads, int doublings) {
  const Eigen::MatrixXd nodes = interpolation(model.levels(), doublings);
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(3 * nodes.rows(), 3 * nodes.cols());
  for (Eigen::Index n = 0; n < nodes.rows(); ++n) {
    for (int a = 0; a < 3; ++a) {
      if ((loads.held[std::size_t(n)] >> a & 1) != 0) continue;
      for (Eigen::Index c = 0; c < nodes.cols(); ++c) dense(3 * n + a, 3 * c + a) = nodes(n, c);
    }
  }
  const Eigen::SparseMatrix<double> p = dense.sparseView();
  const Eigen::Map<const Eigen::VectorXd> g(loads.u_mm.data(), Eigen::Index(loads.u_mm.size()));
  Eigen::VectorXd f = -(stiffness * g);
  for (std::size_t n = 0; n < loads.force_mn.size(); ++n) f[Eigen::Index(n)] += loads.force_mn[n];
  const Eigen::MatrixXd coarse = (p.transpose() * stiffness * p).toDense();
  return g + p * coarse.completeOrthogonalDecomposition().solve(p.transpose() * f);
}

Eigen::VectorXd mapped(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), Eigen::Index(values.size()));
}

FemParams elements_of_voxels(int doublings, double tolerance = 1e-6) {
  FemParams params;
  params.doublings = doublings;
  params.tolerance = tolerance;
  return params;
}

/// Held below, and moved in a box within.
FemLoads pulled(const Body& body, const IndexBox& box) {
  FemLoads loads;
  const double lowest = body.geometry.world_from_index({0, 0, 1.2}).z;
  loads.held.push_back(hold_where(body, [=](const Vec3d& x) { return x.z < lowest; }));
  HeldElements& handle = loads.held.emplace_back();
  handle.elements = elements_in(body, box);
  handle.displacement_mm = [](const Vec3d& x) { return Vec3d(0.3, 0.01 * x.x, -0.2); };
  return loads;
}

void expect_best(const Body& body, const ElasticTable& elastic, const FemLoads& loads,
                 int doublings) {
  const FemModel model(body, elastic);
  ASSERT_GT(int(model.levels().meshes.size()), doublings);
  NodalLoads nodal = nodal_loads(model.mesh(), model.material(), loads);
  hold_loose_islands(model.mesh(), true, nodal.held);
  const Eigen::VectorXd expected = best_by_force(
      model, assembled_stiffness(body, model.mesh(), elastic, Dilatation::mean), nodal, doublings);
  const FemSolution found = model.solve(loads, elements_of_voxels(doublings));
  EXPECT_LT((mapped(found.u_mm) - expected).cwiseAbs().maxCoeff(),
            1e-4 * expected.cwiseAbs().maxCoeff())
      << doublings;
  EXPECT_LT(found.report.force_balance, 1e-6);
  EXPECT_LT(found.report.energy_identity, 1e-6);
}

}  // namespace

TEST(PropertyFemCoarse, IsTheBestDisplacementOfItsMesh) {
  LEFT_OUT_WHEN_SANITIZED();
  std::mt19937 random(31);
  int compared = 0;
  for (int n = 0; n < 400 && compared < cases(12); ++n) {
    const Body body = random_fem_body(random, {16, 15, 14});
    const ElasticTable elastic = random_elastic(random);
    FemLoads loads = pulled(body, {{3, 3, 4}, {6, 6, 8}});
    loads.forces.push_back({elements_in(body, {{7, 2, 3}, {9, 5, 9}}), Vec3d(0.02, -0.01, 0.03)});
    if (loads.held[1].elements.empty() || loads.forces[0].elements.empty()) continue;
    if (MeshLevels(hex_mesh(body)).coarsenings.empty()) continue;
    expect_best(body, elastic, loads, 1);
    ++compared;
  }
  EXPECT_EQ(compared, cases(12));
}

TEST(PropertyFemCoarse, GoesOverSeveralLevels) {
  LEFT_OUT_WHEN_SANITIZED();
  std::mt19937 random(32);
  const Body body = fem_body(
      16, [&](const Vec3i& at) { return at.x > 12 && at.y > 12 ? -1 : int(random() % 250); });
  expect_best(body, random_elastic(random), pulled(body, {{3, 3, 6}, {6, 6, 9}}), 2);
}

TEST(UnitFemCoarse, ALinearDisplacementIsExact) {
  const Body body = fem_cube(16, 0.7);
  const FemModel model(body, ElasticTable::uniform(10, 0.4));
  const auto displacement = [](const Vec3d& x) {
    return Vec3d(0.02 * x.x + 0.01 * x.y, -0.01 * x.z, 0.03 * x.y);
  };
  const double end = body.geometry.world_from_index({15.4, 15.4, 15.4}).x;
  FemLoads loads;
  loads.held.push_back(hold_where(
      body,
      [=](const Vec3d& x) {
        return std::min({x.x, x.y, x.z}) < 0 || std::max({x.x, x.y, x.z}) > end;
      },
      displacement));
  for (const int doublings : {1, 2}) {
    const FemSolution found = model.solve(loads, elements_of_voxels(doublings));
    const std::vector<Vec3d> at = node_positions(model.mesh());
    for (std::size_t n = 0; n < at.size(); ++n) {
      for (int a = 0; a < 3; ++a) {
        ASSERT_NEAR(found.u_mm[3 * n + std::size_t(a)], displacement(at[n])[a], 1e-6);
      }
    }
  }
}

TEST(UnitFemCoarse, LargerElementsAreStifferAndHaveFewerUnknowns) {
  const Body body = fem_body(24, [](const Vec3i& at) { return at.x % 7 == 3 ? 200 : 20; });
  const FemModel model(body, ElasticTable::uniform(10, 0.3));
  const FemLoads loads = pulled(body, {{8, 8, 20}, {14, 14, 23}});
  FemSolution last = model.solve(loads);
  for (const int doublings : {1, 2}) {
    const FemSolution next = model.solve(loads, elements_of_voxels(doublings));
    EXPECT_GT(next.report.energy_mj, 1.001 * last.report.energy_mj) << doublings;
    EXPECT_LT(next.report.energy_mj, 1.5 * last.report.energy_mj) << doublings;
    EXPECT_LT(6 * next.report.unknowns, last.report.unknowns) << doublings;
    last = next;
  }
}

TEST(UnitFemCoarse, DoesNotDependOnThreads) {
  const Body body = fem_cube(20);
  const FemModel model(body, ElasticTable::uniform(10, 0.3));
  const FemLoads loads = pulled(body, {{8, 8, 16}, {14, 14, 19}});
  const auto solve = [&] { return model.solve(loads, elements_of_voxels(1)).u_mm; };
  EXPECT_EQ(on_threads(3, solve), on_threads(1, solve));
}

TEST(UnitFemCoarse, RefusesWhatItCannotBe) {
  const Body body = fem_cube(4);
  const FemModel model(body, ElasticTable::uniform(10, 0.3));
  EXPECT_THROW(model.solve({}, elements_of_voxels(1)), InputError);  // a body of one level
  FemParams params = elements_of_voxels(4);
  EXPECT_THROW(params.validate(), InputError);
  params = elements_of_voxels(1);
  params.strain = StrainTheory::finite;
  EXPECT_THROW(params.validate(), InputError);
}
