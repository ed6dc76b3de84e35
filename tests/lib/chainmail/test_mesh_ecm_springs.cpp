// ECM and springs on one mesh body: ECM first, then relaxation to the energy minimum (thesis
// section 4.2.3), which knows nothing of limits, and the projection that repairs what it broke.
#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

#include "lib/chainmail/mesh_ecm.h"
#include "lib/springs/mesh_springs.h"
#include "lib/springs/minimise.h"
#include "tests/lib/mesh_fixtures.h"
#include "tests/lib/spring_fixtures.h"

using namespace supple;
using namespace supple::test;

namespace {

constexpr int kSide = 15;
constexpr int kMiddle = kSide / 2 * (kSide + 1);

struct StopAfterSteps final : Progress {
  explicit StopAfterSteps(int steps) : most(steps) {}
  void stage(std::string_view) override {}
  void update(double) override { ++updates; }
  bool cancelled() const override { return updates >= most; }
  int most, updates = 0;
};

std::vector<int> rim() {
  std::vector<int> nodes;
  for (int n = 0; n < kSide * kSide; ++n) {
    if (n % kSide % (kSide - 1) == 0 || n / kSide % (kSide - 1) == 0) nodes.push_back(n);
  }
  return nodes;
}

/// Springs from the body's present positions; what ECM held stays held.
MinimiseReport relax(MeshBody& body, Progress* progress) {
  SpringSystem system = make_springs(body, MeshSpringParams());
  take_state(body, system);
  std::vector<int> held = rim();
  held.push_back(kMiddle);
  for (const int node : held) hold(system, node);
  const MinimiseReport report = minimise(system, {}, progress);
  give_state(system, body);
  return report;
}

}  // namespace

TEST(PropertyMeshEcmAndSprings, AnInterruptedRelaxationMayBreakLimitsWhichTheNextDragRepairs) {
  MeshBody body = make_mesh_body(sheet(kSide, kSide, 2));
  MeshEcm ecm(body, {1.1, 0.9, 0.3});
  ecm.drag({{{kMiddle}, {1.5, 0, 3}}}, {rim()});
  ASSERT_EQ(ecm.check_links().violated, 0);

  StopAfterSteps two_steps(2);
  const MinimiseReport relaxed = relax(body, &two_steps);
  EXPECT_FALSE(relaxed.converged);
  EXPECT_LT(relaxed.after.spring_j, relaxed.before.spring_j);
  const MeshLinkCheck broken = ecm.check_links();
  EXPECT_GT(broken.violated, 0);
  EXPECT_GT(broken.worst_excess_mm, 0);

  const MeshEcmReport report = ecm.drag({{{kMiddle}, {0, 0.5, 0}}}, {rim()});
  EXPECT_EQ(report.projection.violated_links, broken.violated);
  EXPECT_GT(report.projection.max_move_mm, 0);
  // The rim is where it was: it is held through the projection, too.
  for (const int node : rim()) EXPECT_EQ(body.pos_mm[node], body.rest_mm[node]);
  EXPECT_EQ(ecm.check_links().violated, 0);
  EXPECT_EQ(ecm.drag({{{kMiddle}, {0, 0, 0.5}}}, {rim()}).projection.violated_links, 0);
}

TEST(PropertyMeshEcmAndSprings, ARelaxationToTheMinimumStaysWithinWideLimits) {
  MeshBody body = make_mesh_body(sheet(kSide, kSide, 2));
  MeshEcm ecm(body, {1.8, 0.3, 1.2});
  ecm.drag({{{kMiddle}, {1.5, 0, 3}}}, {rim()});
  const std::vector<Vec3d> before = body.pos_mm;
  const MinimiseReport relaxed = relax(body, nullptr);
  EXPECT_TRUE(relaxed.converged);
  EXPECT_LT(relaxed.after.spring_j, relaxed.before.spring_j / 2);
  EXPECT_NE(body.pos_mm, before);
  EXPECT_EQ(ecm.check_links().violated, 0);
  // Taking over moves a node by half a unit at most.
  const std::vector<Vec3d> at_rest = body.pos_mm;
  EXPECT_EQ(ecm.drag({{{kMiddle}, {0, 0, 0}}}, {rim()}).projection.violated_links, 0);
  for (std::size_t n = 0; n < at_rest.size(); ++n) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(body.pos_mm[n][c], at_rest[n][c], 0.5001 / 65536);
  }
}
