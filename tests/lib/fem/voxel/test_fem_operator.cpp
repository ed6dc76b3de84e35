// The operator of voxel finite elements against an assembled matrix, and its laws.
#include <cmath>
#include <random>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "lib/fem/voxel/cell_matrices.h"
#include "lib/fem/voxel/fem.h"
#include "lib/fem/voxel/hex_operator.h"
#include "lib/fem/voxel/loose_islands.h"
#include "lib/fem/voxel/multigrid.h"
#include "tests/lib/fem_fixtures.h"
#include "tests/support/sanitized.h"
#include "volumes/base/parallel.h"

using namespace supple;
using namespace supple::test;

namespace {

double largest(const std::vector<double>& values) {
  double most = 0;
  for (const double value : values) most = std::max(most, std::abs(value));
  return most;
}

std::vector<double> product(const FemModel& model, const std::vector<double>& u) {
  std::vector<double> force;
  model.apply(u, force);
  return force;
}

/// Values of a field at all nodes.
std::vector<double> at_nodes(const HexMesh& mesh, const std::function<Vec3d(const Vec3d&)>& field) {
  std::vector<double> u;
  for (const Vec3d& position : node_positions(mesh)) {
    const Vec3d value = field(position);
    for (int a = 0; a < 3; ++a) u.push_back(value[a]);
  }
  return u;
}

/// Weights of the corners of a cell at a place among its 27.
std::array<double, 8> weights_at(int place) {
  const Vec3d halves(Vec3i(place / 9, place / 3 % 3, place % 3));
  return corner_weights(halves / 2.0);
}

/// Each node's weights on the coarser mesh, as a matrix; rows of held components are 0.
Eigen::SparseMatrix<double> prolongation(const HexMesh& fine, const HexMesh& coarse,
                                         const Coarsening& coarsening, const HeldBits& held) {
  std::vector<Eigen::Triplet<double>> entries;
  for (NodeIndex n = 0; n < fine.node_count(); ++n) {
    const int place = coarsening.node_place[n];
    const auto weights = weights_at(place);
    const Corners corners = corners_around(fine, coarse, coarsening, n);
    for (int c = 0; c < 8; ++c) {
      for (int a = 0; a < 3; ++a) {
        if (weights[c] == 0 || (held[n] >> a & 1) != 0) continue;
        entries.emplace_back(3 * n + a, 3 * corners[c] + a, weights[c]);
      }
    }
  }
  Eigen::SparseMatrix<double> p(3 * fine.node_count(), 3 * coarse.node_count());
  p.setFromTriplets(entries.begin(), entries.end());
  return p;
}

Eigen::SparseMatrix<double> as_matrix(const BlockMatrix<double>& from) {
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t row = 0; row < from.rows(); ++row) {
    for (std::int64_t n = from.row_begin[row]; n < from.row_begin[row + 1]; ++n) {
      for (int ab = 0; ab < 9; ++ab) {
        entries.emplace_back(int(3 * row) + ab / 3, 3 * from.column[n] + ab % 3,
                             from.blocks[n].value[3 * (ab % 3) + ab / 3]);
      }
    }
  }
  Eigen::SparseMatrix<double> out(int(3 * from.rows()), int(3 * from.rows()));
  out.setFromTriplets(entries.begin(), entries.end());
  return out;
}

/// K x by BlockMatrix::subtract().
template <class T>
Eigen::VectorXd product(const BlockMatrix<T>& k, const Eigen::VectorXd& x) {
  const std::vector<T> from(x.begin(), x.end());
  std::vector<T> sum(from.size(), 0);
  k.subtract(from.data(), sum.data());
  return -Eigen::Map<const Eigen::Matrix<T, Eigen::Dynamic, 1>>(sum.data(), x.size())
              .template cast<double>();
}

}  // namespace

TEST(PropertyFem, TheOperatorIsTheAssembledMatrixOnRandomBodies) {
  LEFT_OUT_WHEN_SANITIZED();
  std::mt19937 random(1);
  for (int round = 0; round < 20; ++round) {
    const Body body = random_fem_body(random, Vec3i(11, 10, 18));
    const ElasticTable elastic = random_elastic(random);
    const Dilatation dilatation = round % 2 == 0 ? Dilatation::mean : Dilatation::pointwise;
    const FemModel model(body, elastic, dilatation);
    const Eigen::SparseMatrix<double> k =
        assembled_stiffness(body, model.mesh(), elastic, dilatation);
    const std::vector<double> u = random_values(random, std::size_t(k.rows()));
    const Eigen::VectorXd expected = k * Eigen::Map<const Eigen::VectorXd>(u.data(), k.rows());
    const std::vector<double> force = product(model, u);
    const double scale = expected.cwiseAbs().maxCoeff();
    for (int n = 0; n < k.rows(); ++n) EXPECT_NEAR(force[n], expected[n], 1e-12 * scale);
  }
}

TEST(PropertyFem, RigidMotionsHaveNoForces) {
  std::mt19937 random(2);
  for (int round = 0; round < 10; ++round) {
    const Body body = random_fem_body(random, Vec3i(20, 20, 20));
    const FemModel model(body, random_elastic(random));
    const std::vector<double> u = random_values(random, 3 * std::size_t(model.mesh().node_count()));
    const double scale = largest(product(model, u));
    for (int motion = 0; motion < 6; ++motion) {
      Vec3d axis(0);
      axis[motion % 3] = 1;
      const std::vector<double> rigid =
          at_nodes(model.mesh(), [&](const Vec3d& x) { return motion < 3 ? axis : axis.cross(x); });
      EXPECT_LT(largest(product(model, rigid)), 1e-12 * scale * largest(rigid));
    }
  }
}

TEST(PropertyFem, AConstantStrainIsInBalanceInsideABody) {
  // The patch test: in one material, nodes that elements surround feel no force.
  std::mt19937 random(3);
  for (const Dilatation dilatation : {Dilatation::mean, Dilatation::pointwise}) {
    Body body = fem_cube(10);
    body.geometry = random_fem_body(random, Vec3i(4)).geometry.with_dims(Vec3i(10));
    const FemModel model(body, ElasticTable::uniform(3, 0.49), dilatation);
    const Vec3d a(0.3, -0.2, 0.5), b(1, 0.7, -0.4), c(-0.6, 0.1, 0.2);
    const std::vector<double> force = product(
        model, at_nodes(model.mesh(), [&](const Vec3d& x) { return a * x.x + b * x.y + c * x.z; }));
    double inside = 0;
    const std::vector<Vec3d> positions = node_positions(model.mesh());
    int count = 0;
    for (std::size_t n = 0; n < positions.size(); ++n) {
      const Vec3d corner = body.geometry.index_from_world(positions[n]) + Vec3d(0.5);
      bool is_inside = true;
      for (int axis = 0; axis < 3; ++axis) {
        is_inside = is_inside && corner[axis] > 0.5 && corner[axis] < 9.5;
      }
      if (!is_inside) continue;
      ++count;
      for (int axis = 0; axis < 3; ++axis) inside = std::max(inside, std::abs(force[3 * n + axis]));
    }
    EXPECT_EQ(count, 9 * 9 * 9);
    EXPECT_LT(inside, 1e-12 * largest(force));
  }
}

TEST(PropertyFem, OnlyTheRigidMotionsOfEachIslandHaveNoEnergy) {
  std::mt19937 random(4);
  for (int round = 0; round < 6; ++round) {
    const Body body = random_fem_body(random, Vec3i(5, 4, 4));
    ElasticTable elastic = random_elastic(random);
    elastic.young_kpa.fill(1);
    const FemModel model(body, elastic);
    const Eigen::MatrixXd k = assembled_stiffness(body, model.mesh(), elastic, Dilatation::mean);
    const Eigen::VectorXd values =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(k, Eigen::EigenvaluesOnly).eigenvalues();
    const double most = values[values.size() - 1];
    EXPECT_GT(values[0], -1e-12 * most);
    EXPECT_EQ((values.array() < 1e-9 * most).count(), 6 * find_islands(model.mesh()).count);
  }
}

TEST(PropertyFem, CoarseOperatorsAreTheGalerkinProductsOfTheFineOne) {
  LEFT_OUT_WHEN_SANITIZED();
  std::mt19937 random(5);
  bool has_held_cells = false;
  for (int round = 0; round < 12; ++round) {
    // Uniform materials reach cells of eight children of one class.
    Body body = random_fem_body(random, Vec3i(22, 20, 24));
    if (round % 3 == 0) std::fill(body.classes.begin(), body.classes.end(), std::uint8_t(7));
    const ElasticTable elastic = random_elastic(random);
    const Dilatation dilatation = round % 2 == 0 ? Dilatation::mean : Dilatation::pointwise;
    const FemModel model(body, elastic, dilatation);
    const HexMesh& voxels = model.mesh();
    HeldBits held(voxels.node_count(), 0);
    for (std::uint8_t& bits : held) bits = random() % 40 == 0 ? std::uint8_t(random() % 8) : 0;
    const bool holds_parts = round % 2 == 1;
    for (std::int32_t e = 0; holds_parts && e < voxels.element_count() / 2; ++e) {
      for (const NodeIndex node : voxels.corners(e)) held[std::size_t(node)] = kAllHeld;
    }
    Coarsening to_cells, to_large;
    const HexMesh cells_mesh = coarsen(voxels, to_cells);
    const HexMesh large_mesh = coarsen(cells_mesh, to_large);
    const CellClasses cells =
        cell_classes(voxels, to_cells, model.material(), held, cells_mesh.element_count());
    const HexOperator cells_operator(cells_mesh, cells, model.material());
    for (std::size_t n = 0; n < cells.present.size(); ++n) {
      has_held_cells = has_held_cells || cells.kind(n) == GroupKind::held;
    }

    const Eigen::SparseMatrix<double> k = assembled_stiffness(body, voxels, elastic, dilatation);
    const Eigen::SparseMatrix<double> p = prolongation(voxels, cells_mesh, to_cells, held);
    const Eigen::SparseMatrix<double> k1 = p.transpose() * k * p;
    const std::vector<double> u = random_values(random, std::size_t(k1.rows()));
    std::vector<double> force(u.size(), 0);
    cells_operator.add(u.data(), force.data());
    const Eigen::VectorXd expected = k1 * Eigen::Map<const Eigen::VectorXd>(u.data(), k1.rows());
    const double scale = expected.cwiseAbs().maxCoeff();
    for (int n = 0; n < k1.rows(); ++n) EXPECT_NEAR(force[n], expected[n], 1e-11 * scale);
    const std::vector<float> diagonal = cells_operator.diagonal();
    const double most = Eigen::VectorXd(k1.diagonal()).maxCoeff();
    for (int n = 0; n < k1.rows(); ++n) {
      EXPECT_NEAR(diagonal[n], k1.coeff(n, n), 1e-5 * k1.coeff(n, n) + 1e-9 * most);
    }

    const HeldBits none(cells_mesh.node_count(), 0);
    const Eigen::SparseMatrix<double> p2 = prolongation(cells_mesh, large_mesh, to_large, none);
    const Eigen::SparseMatrix<double> k2 = p2.transpose() * k1 * p2;
    const CellMatrices matrices = CellMatrices::of_large_cells(
        cells_mesh, to_large, cells, model.material(), large_mesh.element_count());
    const Eigen::SparseMatrix<double> made = as_matrix(assemble<double>(large_mesh, matrices));
    EXPECT_LT((made - k2).norm(), 1e-12 * k2.norm());
    const Eigen::VectorXd x =
        Eigen::VectorXd::NullaryExpr(k2.rows(), [&] { return pick(random, -1, 1); });
    EXPECT_LT((product(assemble<double>(large_mesh, matrices), x) - k2 * x).norm(),
              1e-12 * (k2 * x).norm());
    EXPECT_LT((product(assemble<float>(large_mesh, matrices), x) - k2 * x).norm(),
              1e-5 * (k2 * x).norm());
    const CellMatrices again = CellMatrices::of_cells(cells, model.material())
                                   .coarser(cells_mesh, to_large, large_mesh.element_count());
    EXPECT_LT((as_matrix(assemble<double>(large_mesh, again)) - k2).norm(), 1e-12 * k2.norm());
  }
  EXPECT_TRUE(has_held_cells);
}

TEST(PropertyFem, GroupsAtNodesGiveTheForcesOfTheseNodes) {
  std::mt19937 random(15);
  for (int round = 0; round < 10; ++round) {
    const Body body = random_fem_body(random, Vec3i(20, 18, 22));
    const FemModel model(body, random_elastic(random));
    const std::size_t nodes = std::size_t(model.mesh().node_count());
    std::vector<bool> is_node(nodes);
    const std::size_t first = random() % nodes;
    for (std::size_t n = first; n < std::min(nodes, first + 40); ++n) is_node[n] = true;
    const GroupsAtNodes groups = model.stiffness().groups_at(is_node);
    EXPECT_GT(groups.share, 0);
    EXPECT_LE(groups.share, 1);

    std::vector<float> x(3 * nodes), all(3 * nodes, 0), part(3 * nodes, 0);
    for (float& value : x) value = float(pick(random, -1, 1));
    model.stiffness().subtract(x.data(), all.data());
    model.stiffness().subtract(x.data(), part.data(), groups);
    bool differs = false;
    for (std::size_t n = 0; n < 3 * nodes; ++n) {
      if (is_node[n / 3]) {
        EXPECT_EQ(part[n], all[n]);
      }
      differs = differs || part[n] != all[n];
    }
    EXPECT_EQ(differs, groups.share < 1);
  }
}

TEST(UnitFemMesh, ParentsAreThoseThatWereGivenHoweverManyABlockHas) {
  for (const std::int32_t most : {0xffff, 0x10000}) {
    // Two blocks of elements, in coarse blocks that begin at 0 and 70000.
    const std::vector<std::int32_t> given = {3, most, 70001, 70000};
    const Parents parents(given, {0, 2, 4}, {0, 70000});
    for (std::int32_t n = 0; n < 4; ++n) {
      EXPECT_EQ(parents(n < 2 ? 0 : 70000, n), given[std::size_t(n)]) << most;
    }
    EXPECT_EQ(parents.bytes(), most > 0xffff ? 16u : 8u);
  }
}

TEST(PropertyFem, PositionsOfSomeNodesAreThoseAmongAll) {
  std::mt19937 random(7);
  for (int round = 0; round < 20; ++round) {
    const HexMesh mesh = hex_mesh(random_fem_body(random, Vec3i(20, 18, 22)));
    const std::vector<Vec3d> all = node_positions(mesh);
    std::vector<NodeIndex> some;
    std::vector<Vec3d> expected;
    for (NodeIndex n = 0; n < mesh.node_count(); ++n) {
      if (random() % 5 != 0 && n + 1 != mesh.node_count()) continue;
      some.push_back(n);
      expected.push_back(all[std::size_t(n)]);
    }
    EXPECT_EQ(node_positions(mesh, some), expected);
    EXPECT_TRUE(node_positions(mesh, {}).empty());
  }
}

TEST(PropertyFem, InterpolationIsOneFieldWhereverANodeIsSeenFrom) {
  LEFT_OUT_WHEN_SANITIZED();
  // Every element around a node would interpolate it alike: nodes stay joined on coarser levels.
  std::mt19937 random(6);
  for (int round = 0; round < 20; ++round) {
    HexMesh mesh = hex_mesh(random_fem_body(random, Vec3i(20, 20, 20)));
    while (mesh.element_count() > 1) {
      Coarsening coarsening;
      const HexMesh coarse = coarsen(mesh, coarsening);
      std::vector<double> value(coarse.node_count());
      for (double& v : value) v = pick(random, 0, 1);
      for (std::size_t b = 0; b < mesh.block_count(); ++b) {
        for (std::int32_t e = mesh.element_begin[b]; e < mesh.element_begin[b + 1]; ++e) {
          const Vec3i local = brick_local(mesh.offset[e]);
          for (int c = 0; c < 8; ++c) {
            const Vec3d at = Vec3d((local.x & 1) + (c >> 2 & 1), (local.y & 1) + (c >> 1 & 1),
                                   (local.z & 1) + (c & 1)) /
                             2.0;
            const auto weights = corner_weights(at);
            const NodeIndex node = mesh.corners_in(b, e)[c];
            const int place = coarsening.node_place[node];
            const auto noted = weights_at(place);
            double here = 0, there = 0;
            for (int w = 0; w < 8; ++w) {
              here += weights[w] * value[coarse.corners(coarsening.parent_of(b, e))[w]];
              there += noted[w] * value[corners_around(mesh, coarse, coarsening, node)[w]];
            }
            ASSERT_NEAR(here, there, 1e-14);
          }
        }
      }
      if (coarse.element_count() == mesh.element_count()) break;
      mesh = coarse;
    }
  }
}

TEST(PropertyFem, ForcesHaveTheSameBitsOnAnyNumberOfThreads) {
  std::mt19937 random(7);
  const Body body = random_fem_body(random, Vec3i(40, 40, 40));
  const FemModel model(body, random_elastic(random));
  const std::vector<double> u = random_values(random, 3 * std::size_t(model.mesh().node_count()));
  const std::vector<double> one = on_threads(1, [&] { return product(model, u); });
  for (const int threads : {2, 5}) {
    EXPECT_EQ(on_threads(threads, [&] { return product(model, u); }), one);
  }
}

TEST(UnitFem, ACutSeparatesNodesOnlyWhereItGoesThrough) {
  // Two voxels with a cut link between them: two bodies. Four in a square with one link cut: the
  // other three still join all of them along the middle edge.
  Block pair = homogeneous({2, 1, 1}, 1.5, 0.5, 0.5);
  EXPECT_EQ(hex_mesh(body_of(pair)).node_count(), 12);
  pair.cut.assign(2, 0);
  pair.cut[pair.index(0, 0, 0)] = 1;
  EXPECT_EQ(hex_mesh(body_of(pair)).node_count(), 16);
  EXPECT_EQ(find_islands(hex_mesh(body_of(pair))).count, 2);

  Block square = homogeneous({2, 2, 1}, 1.5, 0.5, 0.5);
  EXPECT_EQ(hex_mesh(body_of(square)).node_count(), 18);
  square.cut.assign(4, 0);
  square.cut[square.index(0, 0, 0)] = 1;
  const HexMesh opened = hex_mesh(body_of(square));
  EXPECT_EQ(opened.node_count(), 20);
  EXPECT_EQ(find_islands(opened).count, 1);

  Block edge = homogeneous({2, 2, 1}, 1.5, 0.5, 0.5);
  edge.element[edge.index(0, 1, 0)] = edge.element[edge.index(1, 0, 0)] = 0;
  EXPECT_EQ(hex_mesh(body_of(edge)).node_count(), 16);
}

TEST(UnitFem, AnIslandIsLooseUnlessAllSixRigidMotionsArePrevented) {
  const HexMesh mesh = hex_mesh(fem_cube(3));
  const auto count = [&](const std::function<int(const Vec3d&)>& bits) {
    HeldBits held;
    for (const Vec3d& position : node_positions(mesh)) {
      held.push_back(std::uint8_t(bits(position)));
    }
    return hold_loose_islands(mesh, false, held).loose_islands;
  };
  const auto corner = [](const Vec3d& x, double i, double j, double k) {
    return (x - Vec3d(i - 0.5, j - 0.5, k - 0.5)).length() < 1e-9;
  };
  EXPECT_EQ(count([](const Vec3d&) { return 0; }), 1);
  // Three, two and one components at three corners prevent all six; one fewer does not.
  const auto three_two_one = [&](const Vec3d& x, int last) {
    return corner(x, 0, 0, 0) ? 7 : corner(x, 3, 0, 0) ? 6 : corner(x, 0, 3, 0) ? last : 0;
  };
  EXPECT_EQ(count([&](const Vec3d& x) { return three_two_one(x, 4); }), 0);
  EXPECT_EQ(count([&](const Vec3d& x) { return three_two_one(x, 0); }), 1);
  EXPECT_EQ(count([&](const Vec3d& x) { return three_two_one(x, 1); }), 1);
  // Two corners leave the rotation about their line.
  EXPECT_EQ(count([&](const Vec3d& x) { return corner(x, 0, 0, 0) || corner(x, 3, 3, 3) ? 7 : 0; }),
            1);
}
