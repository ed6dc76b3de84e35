// ECM on mesh bodies against brute force, the voxel solver and its laws.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

#include <gtest/gtest.h>

#include "lib/chainmail/mesh_ecm.h"
#include "tests/lib/mesh_fixtures.h"
#include "tests/lib/spring_fixtures.h"
#include "tests/lib/test_bodies.h"
#include "tests/support/sanitized.h"

using namespace supple;
using namespace supple::test;

namespace {

struct MeshDrag {
  std::vector<MeshHandle> handles;
  std::vector<NodeSet> anchors;
  std::vector<MeshBruteForce::Grab> grabs;
  std::vector<int> fixed;
};

/// Up to three handles of up to three nodes, mostly alike so that they can agree, and anchors.
MeshDrag random_mesh_drag(std::mt19937& random, int nodes) {
  std::vector<int> order(nodes);
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), random);
  std::size_t next = 0;
  const auto take = [&](std::size_t most) {
    NodeSet set;
    for (std::size_t n = 1 + random() % most; n > 0 && next < order.size(); --n) {
      set.push_back(order[next++]);
    }
    return set;
  };
  MeshDrag drag;
  const double reach = std::pow(10.0, std::uniform_real_distribution<double>(-1, 1.5)(random));
  std::array<Wide, 3> common{};
  const int handles = random() % 2 ? 1 : 1 + int(random() % 3);
  for (int h = 0; h < handles; ++h) {
    const NodeSet set = take(3);
    if (set.empty()) break;
    std::array<Wide, 3> by{};
    for (int c = 0; c < 3; ++c) {
      const double mm = std::uniform_real_distribution<double>(-reach, reach)(random);
      const bool is_near = h > 0 && random() % 4 != 0;
      by[c] = is_near ? common[c] + Wide(mm * 6000) : Wide(mm * 65536);
      if (random() % 5 == 0) by[c] = 0;
    }
    if (h == 0) common = by;
    const bool push = random() % 4 == 0;
    drag.handles.push_back({set,
                            {double(by[0]) / 65536, double(by[1]) / 65536, double(by[2]) / 65536},
                            push ? HandleKind::push : HandleKind::two_sided});
    drag.grabs.push_back({set, by, push});
  }
  if (random() % 2) {
    for (int n = 0; n < 2; ++n) {
      const NodeSet set = take(3);
      if (set.empty()) break;
      drag.anchors.push_back(set);
      drag.fixed.insert(drag.fixed.end(), set.begin(), set.end());
    }
  }
  return drag;
}

/// The message names two nodes whose missing distance is the largest there is.
void expect_names_nodes(const std::string& message, const MeshDrag& drag,
                        const MeshBruteForce& brute, const MeshBruteForce::Outcome& outcome) {
  int handles[2], nodes[2];
  double missing_mm = 0;
  char axis = ' ';
  ASSERT_EQ(std::sscanf(message.c_str(),
                        "handles %d and %d: found targets %lf mm further apart along %c than the "
                        "links between nodes %d and %d allow",
                        &handles[0], &handles[1], &missing_mm, &axis, &nodes[0], &nodes[1]),
            6)
      << message;
  const int c = outcome.conflict_axis;
  EXPECT_EQ(axis, "xyz"[c]);
  EXPECT_NEAR(missing_mm, double(outcome.missing) / 65536, 1e-5 * missing_mm);
  Wide targets[2];
  for (int n = 0; n < 2; ++n) {
    const auto& grab = drag.grabs[std::size_t(handles[n])];
    ASSERT_EQ(std::count(grab.nodes.begin(), grab.nodes.end(), nodes[n]), 1) << message;
    targets[n] = brute.q[c][nodes[n]] + grab.by[c];
  }
  EXPECT_EQ(brute.missing(c, nodes[0], targets[0], nodes[1], targets[1]), outcome.missing);
}

std::vector<MeshLimits> for_all_links(const MeshBody& body, const MeshLimits& limits) {
  return std::vector<MeshLimits>(body.links.size(), limits);
}

}  // namespace

TEST(UnitMeshLinks, ALinkAlongAnAxisHasTheLatticesSlack) {
  const MaterialTable table = linear_table(1.37, 0.61, 0.43);
  const SlackTable lattice(table, {1, 1, 1});
  for (int axis = 0; axis < 3; ++axis) {
    for (const int end : {0, 1, 100, 255}) {
      const LinkLimits limits = limits_of(table, axis, end, 255);
      Vec3d r(0.0);
      r[axis] = 1;
      const MeshLimits mesh{limits.max_length, limits.min_length, limits.shear1};
      const LinkSlack expected = lattice.slack(axis, std::uint8_t(end), 255);
      EXPECT_EQ(slack_of(r, mesh).upper, expected.upper);
      EXPECT_EQ(slack_of(r, mesh).lower, expected.lower);
      EXPECT_EQ(slack_of(-r, mesh).upper, expected.lower);
      EXPECT_EQ(slack_of(-r, mesh).lower, expected.upper);
    }
  }
}

TEST(UnitMeshLinks, AnObliqueLinkSharesItsLimitsByItsDirection) {
  // L = 5: x sees 3 mm lengthwise and 4 sideways, y 4 and 3 the other way round, z 5 sideways.
  const LinkSlack slack = slack_of({3, -4, 0}, {1.5, 0.8, 0.25});
  EXPECT_EQ(slack.upper, (std::array<std::int32_t, 3>{163840, 101580, 81920}));  // 2.5 1.55 1.25
  EXPECT_EQ(slack.lower, (std::array<std::int32_t, 3>{104857, 180224, 81920}));  // 1.6 2.75 1.25
  const LinkSlack none = slack_of({0, 0, 0}, {1.5, 0.8, 0.25});
  EXPECT_EQ(none.upper, (std::array<std::int32_t, 3>{0, 0, 0}));
  EXPECT_EQ(none.lower, none.upper);
}

TEST(PropertyMeshLinks, TheBoxIsTheSmallestThatHoldsElongationAndSidewaysMoves) {
  std::mt19937 random(3);
  const auto pick = [&](double lo, double hi) {
    return std::uniform_real_distribution<double>(lo, hi)(random);
  };
  for (int run = 0; run < 200; ++run) {
    const Vec3d r(pick(-5, 5), pick(-5, 5), pick(-5, 5));
    const double length = r.length();
    const Vec3d e = r / length;
    const MeshLimits limits{pick(1, 2), pick(0.1, 1), pick(0, 1)};
    const LinkSlack slack = slack_of(r, limits);
    for (int c = 0; c < 3; ++c) {
      Vec3d axis(0.0);
      axis[c] = 1;
      // The sideways direction that moves coordinate c most, and any other one.
      const Vec3d steepest = (axis - e * e[c]).normalized();
      const Vec3d other = e.cross(Vec3d(pick(-1, 1), pick(-1, 1), pick(-1, 1))).normalized();
      const double grow = e[c] > 0 ? limits.max_length - 1 : limits.min_length - 1;
      const double shrink = e[c] > 0 ? limits.min_length - 1 : limits.max_length - 1;
      const Vec3d most = r * grow + steepest * (limits.shear * length);
      const Vec3d least = r * shrink - steepest * (limits.shear * length);
      EXPECT_NEAR(most[c] * 65536, slack.upper[c], 1.001);
      EXPECT_NEAR(-least[c] * 65536, slack.lower[c], 1.001);
      const Vec3d any = r * pick(limits.min_length - 1, limits.max_length - 1) +
                        other * (limits.shear * length * pick(-1, 1));
      EXPECT_LE(any[c] * 65536, slack.upper[c] + 1);
      EXPECT_LE(-any[c] * 65536, slack.lower[c] + 1);
    }
  }
}

TEST(PropertyMeshEcm, EqualsBruteForceBitForBitOnRandomNetworks) {
  int moved = 0, conflicts = 0, shortened = 0;
  for (unsigned seed = 0; seed < 1500 && !HasFailure(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    MeshBody body = random_network(random, 18);
    const std::vector<MeshLimits> limits = random_limits(random, body.links.size());
    MeshEcm ecm(body, limits);
    MeshBruteForce brute(body, limits);
    for (int n = 0; n < 3 && !HasFailure(); ++n) {
      const MeshDrag drag = random_mesh_drag(random, int(body.node_count()));
      const std::array<std::vector<Wide>, 3> before = brute.q;
      const MeshBruteForce::Outcome expected = brute.drag(drag.grabs, drag.fixed);
      MeshEcmReport report;
      const std::string error = input_error([&] { report = ecm.drag(drag.handles, drag.anchors); });
      ASSERT_EQ(!error.empty(), expected.conflict) << error;
      if (expected.conflict) {
        ++conflicts;
        expect_names_nodes(error, drag, brute, expected);
      } else {
        EXPECT_EQ(report.fraction_numerator, expected.numerator);
        EXPECT_EQ(report.fraction_denominator, expected.denominator);
        std::int64_t changed = 0;
        for (std::size_t j = 0; j < body.node_count(); ++j) {
          changed += before[0][j] != brute.q[0][j] || before[1][j] != brute.q[1][j] ||
                     before[2][j] != brute.q[2][j];
        }
        EXPECT_EQ(report.moved, changed);
        EXPECT_EQ(report.projection.violated_links, 0);
        moved += changed > 0;
        shortened += expected.numerator != 0 && expected.numerator != expected.denominator;
      }
      expect_equal(body, brute);
      ASSERT_EQ(brute.broken_links(), 0);
      ASSERT_EQ(ecm.check_links().violated, 0);
    }
  }
  std::printf("moved %d, conflicts %d, shortened %d\n", moved, conflicts, shortened);
  EXPECT_GE(moved, 1000);
  EXPECT_GE(conflicts, 100);
  EXPECT_GE(shortened, 100);
}

TEST(PropertyMeshEcm, WhatBreaksLimitsIsProjectedToTheMiddleOfItsEnvelopes) {
  int projected = 0;
  for (unsigned seed = 0; seed < 200 && !HasFailure(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    MeshBody body = random_network(random, 16);
    const std::vector<MeshLimits> limits = random_limits(random, body.links.size());
    MeshEcm ecm(body, limits);
    MeshBruteForce brute(body, limits);
    const double reach = seed % 2 ? 20 : 0.5;
    for (std::size_t n = 0; n < body.node_count(); ++n) {
      for (int c = 0; c < 3; ++c) {
        const double mm = std::uniform_real_distribution<double>(-reach, reach)(random);
        body.pos_mm[n][c] += mm;
        brute.q[c][n] = Wide(std::lround((body.pos_mm[n][c] - body.rest_mm[n][c]) * 65536));
      }
    }
    const int broken = brute.broken_links();
    EXPECT_EQ(ecm.check_links().violated, broken);
    const Wide largest = brute.project();
    EXPECT_EQ(brute.broken_links(), 0);
    // It projects by itself, and as the beginning of a drag.
    MeshBody other = body;
    const MeshProjection own = MeshEcm(other, limits).project();
    EXPECT_EQ(own.violated_links, broken);
    EXPECT_EQ(own.max_move_mm, double(largest) / 65536);
    expect_equal(other, brute);
    brute.drag({{{0}, {100000, 0, -3000}}}, {});
    const MeshEcmReport report = ecm.drag({{{0}, {100000 / 65536.0, 0, -3000 / 65536.0}}}, {});
    EXPECT_EQ(report.projection.violated_links, broken);
    EXPECT_EQ(report.projection.max_move_mm, double(largest) / 65536);
    expect_equal(body, brute);
    projected += broken > 0;
  }
  EXPECT_GE(projected, 100);
}

TEST(PropertyMeshEcm, ANetworkOfAVoxelBodysLinksMovesAsTheVoxelBody) {
  std::mt19937 random(8);
  for (int run = 0; run < 20; ++run) {
    Block block = random_block(random, {7, 6, 5});
    block.table = linear_table(1.4, 0.6, 0.5);
    block.spacing_mm = {1, 1, 1};
    for (double& density : block.density) density = double(random() % 256);
    Body voxels = body_of(block);
    // Voxels that are no elements stay nodes without links.
    std::vector<Vec3d> points;
    std::vector<LinkNodes> links;
    std::vector<MeshLimits> limits;
    for (int n = 0; n < block.size(); ++n) points.push_back(Vec3d(block.voxel(n)));
    for (int n = 0; n < block.size(); ++n) {
      const Vec3i at = block.voxel(n) - block.origin;
      // Links of one voxel ascend by their other end, as make_network sorts them.
      for (int axis = 0; axis < 3; ++axis) {
        if (at[axis] + 1 == block.dims[axis]) continue;
        const int next = n + (axis == 0   ? 1
                              : axis == 1 ? block.dims.x
                                          : block.dims.x * block.dims.y);
        if (!block.element[n] || !block.element[next]) continue;
        links.push_back({n, next});
        const LinkLimits limit =
            limits_of(block.table, axis, int(block.density[n]), int(block.density[next]));
        limits.push_back({limit.max_length, limit.min_length, limit.shear1});
      }
    }
    MeshBody body = make_network(points, links);
    ASSERT_EQ(body.links, links);
    MeshEcm ecm(body, limits);
    EcmSolver solver(voxels);
    for (int n = 0; n < 4; ++n) {
      const int grabbed = random_element(random, block), fixed = random_element(random, block);
      if (grabbed == fixed) continue;
      std::array<std::int32_t, 3> by;
      for (auto& each : by) each = std::int32_t(random() % 800000) - 400000;
      const EcmReport expected =
          solver.drag({{block.voxel(grabbed), by}}, {Region(block.voxel(fixed))});
      const MeshEcmReport report =
          ecm.drag({{{grabbed}, Vec3d(by[0], by[1], by[2]) / 65536.0}}, {{fixed}});
      EXPECT_EQ(report.fraction_numerator, expected.fraction_numerator);
      EXPECT_EQ(report.fraction_denominator, expected.fraction_denominator);
      EXPECT_EQ(report.moved, expected.moved);
      for (int j = 0; j < block.size(); ++j) {
        if (!block.element[j]) continue;
        for (int c = 0; c < 3; ++c) {
          ASSERT_EQ((body.pos_mm[j] - body.rest_mm[j])[c] * 65536,
                    voxels.offset(block.voxel(j), c));
        }
      }
    }
  }
}

TEST(PropertyMeshEcm, AMembraneHeldAtItsRimEqualsBruteForce) {
  const int side = kSanitized ? 19 : 39;
  TriangleMesh mesh = sheet(side, side, 2);
  std::mt19937 random(5);
  std::vector<int> rim;
  for (int n = 0; n < side * side; ++n) {
    const int i = n % side, j = n / side;
    if (i % (side - 1) == 0 || j % (side - 1) == 0) rim.push_back(n);
    Vec3d& p = mesh.vertices_lps_mm[n];
    p.x += double(random() % 100) / 100;
    p.y += double(random() % 100) / 100;
  }
  MeshBody body = make_mesh_body(mesh);
  const std::vector<MeshLimits> limits = for_all_links(body, {1.3, 0.7, 0.4});
  MeshEcm ecm(body, limits);
  MeshBruteForce brute(body, limits);
  const int middle = side / 2 * (side + 1);
  for (const Vec3d& by : {Vec3d(3, -1, 9) * side / 39, Vec3d(-9, 12, 40) * side / 39}) {
    const auto expected =
        brute.drag({{{middle}, {Wide(by.x * 65536), Wide(by.y * 65536), Wide(by.z * 65536)}}}, rim);
    const MeshEcmReport report = ecm.drag({{{middle}, by}}, {rim});
    EXPECT_EQ(report.fraction_numerator, expected.numerator);
    EXPECT_EQ(report.fraction_denominator, expected.denominator);
    EXPECT_GT(report.moved, side * side / 16);
    expect_equal(body, brute);
  }
  EXPECT_EQ(ecm.check_links().violated, 0);
  for (const int n : rim) EXPECT_EQ(body.pos_mm[n], body.rest_mm[n]);
}

TEST(PropertyMeshEcm, AClosedSurfaceDraggedAtAPointStaysValidAndInOnePiece) {
  TriangleMesh mesh = icosphere(4, 60);
  for (Vec3d& p : mesh.vertices_lps_mm) {  // folds, as of a cortex
    p *= 1 + 0.1 * std::sin(p.x / 4) * std::cos(p.y / 5) * std::sin(p.z / 3);
  }
  MeshBody body = make_mesh_body(mesh);
  ASSERT_EQ(body.node_count(), 2562u);
  const std::vector<MeshLimits> limits = for_all_links(body, {1.25, 0.8, 0.3});
  MeshEcm ecm(body, limits);
  MeshBruteForce brute(body, limits);
  std::mt19937 random(2);
  for (int n = 0; n < 4; ++n) {
    const int grabbed = int(random() % 2562);
    const std::array<Wide, 3> by{Wide(random() % 2000000) - 1000000,
                                 Wide(random() % 2000000) - 1000000, 300000};
    const Vec3d before = body.pos_mm[grabbed];
    const Vec3d by_mm = Vec3d(double(by[0]), double(by[1]), double(by[2])) / 65536.0;
    const MeshEcmReport report = ecm.drag({{{grabbed}, by_mm}}, {});
    EXPECT_EQ(report.fraction(), 1);
    EXPECT_LT((body.pos_mm[grabbed] - before - by_mm).length(), 1e-10);
    brute.drag({{{grabbed}, by}}, {});
    expect_equal(body, brute);
    EXPECT_EQ(brute.broken_links(), 0);
  }
  EXPECT_EQ(ecm.check_links().violated, 0);
  EXPECT_EQ(ecm.check_links().links, 7680);
  // Every coordinate gives way by 0.3 sideways and 0.25 lengthwise at most.
  for (const auto& [a, b] : body.links) {
    const double rest = (body.rest_mm[a] - body.rest_mm[b]).length();
    EXPECT_LT((body.pos_mm[a] - body.pos_mm[b]).length(), (1 + std::sqrt(3.0) * 0.4) * rest);
  }
}

TEST(PropertyMeshEcm, NeitherTheOrderOfNodesNorAFreshSolverChangesABit) {
  const TriangleMesh mesh = icosphere(3, 30);
  const int nodes = int(mesh.vertices_lps_mm.size());
  std::vector<int> order(nodes);  // old to new
  std::iota(order.begin(), order.end(), 0);
  std::mt19937 random(4);
  std::shuffle(order.begin(), order.end(), random);
  TriangleMesh shuffled = mesh;
  for (int n = 0; n < nodes; ++n) shuffled.vertices_lps_mm[order[n]] = mesh.vertices_lps_mm[n];
  for (auto& t : shuffled.triangles) t = {order[t[1]], order[t[2]], order[t[0]]};

  MeshBody first = make_mesh_body(mesh), second = make_mesh_body(shuffled), third = first;
  const MeshLimits limits{1.2, 0.7, 0.2};
  MeshEcm one(first, limits), other(second, limits);
  for (int n = 0; n < 5; ++n) {
    const int a = int(random() % unsigned(nodes)), b = (a + 1 + int(random() % 600)) % nodes;
    const Vec3d by(double(random() % 40) - 20, double(random() % 40) / 3 - 7, 5);
    one.drag({{{a}, by}}, {{b}});
    other.drag({{{order[a]}, by}}, {{order[b]}});
    EXPECT_EQ(MeshEcm(third, limits).drag({{{a}, by}}, {{b}}).projection.violated_links, 0);
    EXPECT_EQ(first.pos_mm, third.pos_mm);
    for (int j = 0; j < nodes; ++j) ASSERT_EQ(first.pos_mm[j], second.pos_mm[order[j]]);
  }
}
