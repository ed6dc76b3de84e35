// Sheets that tear: where they may, and what is left.
#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "tests/lib/membrane/sheets.h"

namespace supple::test {

namespace {

MembraneParams brittle_params() {
  MembraneParams params;
  params.strength_n_m = 2;
  params.adhesion_j_m2 = 0.2;
  return params;
}

/// A random grip, pull or release; returns the report.
MembraneReport act(Membrane& membrane, const Instrument& forceps, InstrumentPose& pose,
                   std::mt19937& random) {
  std::uniform_real_distribution<double> part(0, 1);
  InstrumentPose next = pose;
  if (random() % 4 == 0) {
    next.opening_degrees = 10;
    const std::vector<Vec3d>& nodes = membrane.body().pos_mm;
    next.tip_mm = nodes[random() % nodes.size()];
  } else {
    next.opening_degrees = 0;
    next.tip_mm += Vec3d(part(random) - 0.5, part(random) - 0.5, part(random) - 0.4);
    next.axis = Vec3d(part(random) - 0.5, part(random) - 0.5, 1).normalized();
  }
  const MembraneReport report = membrane.step(0.02, motion(forceps, pose, next), {forceps});
  pose = next;
  return report;
}

}  // namespace

TEST(PropertyTearing, AThousandGripsTearsAndReleasesLeaveAManifoldWithBoundary) {
  // Its triangles keep their shapes at rest, and all that face backwards are told.
  const Instrument forceps = ball_forceps(0.3);
  std::int64_t torn = 0, lost = 0, gripped = 0, released = 0, inverted = 0;
  for (unsigned seed = 0; seed < 10; ++seed) {
    std::mt19937 random(seed);
    Membrane membrane(flat_sheet(12, 12, 0.2), brittle_params(), {plane_ground()}, "sheet");
    InstrumentPose pose = pose_at({1, 1, 0.02}, 10);
    double clings = membrane.clinging_mm2();
    std::vector<std::array<double, 9>> triangles = rest_triangles(membrane.body());
    for (int n = 0; n < 100; ++n) {
      const std::int64_t version = membrane.topology_version();
      const MembraneReport report = act(membrane, forceps, pose, random);
      torn += count_of(report, MembraneEvent::Kind::edge_torn);
      const std::int64_t gone = count_of(report, MembraneEvent::Kind::piece_lost);
      lost += gone;
      gripped += count_of(report, MembraneEvent::Kind::gripped);
      released += count_of(report, MembraneEvent::Kind::released);
      ASSERT_EQ(fault_of(membrane.body()), "") << seed << " " << n;
      const bool changed = count_of(report, MembraneEvent::Kind::edge_torn) > 0;
      EXPECT_EQ(membrane.topology_version() != version, changed);
      EXPECT_LE(membrane.clinging_mm2(), clings + 1e-9);
      clings = membrane.clinging_mm2();
      EXPECT_GE(report.longest_stretch, 1);
      const auto left = rest_triangles(membrane.body());
      EXPECT_TRUE(std::includes(triangles.begin(), triangles.end(), left.begin(), left.end()));
      EXPECT_EQ(std::int64_t(triangles.size()), std::int64_t(left.size()) + gone);
      triangles = left;
      EXPECT_EQ(report.inverted, facing_back(membrane.body())) << seed << " " << n;
      inverted += report.inverted;
    }
  }
  EXPECT_GT(inverted, 100);
  EXPECT_GT(torn, 100);
  EXPECT_GT(lost, 10);
  EXPECT_GT(gripped, 100);
  EXPECT_GT(released, 100);
}

TEST(PropertyTearing, SheetsTearOnlyWhereTheirStrengthWasPassed) {
  // Two sheets take the same pull; the one that holds shows where loads were above a limit.
  const Instrument forceps = ball_forceps(0.3);
  MembraneParams params;
  params.strength_n_m = 3;
  params.adhesion_j_m2 = 0.5;
  params.sweeps = 60;
  Membrane brittle(flat_sheet(12, 12, 0.2), params, {plane_ground()}, "brittle");
  InstrumentPose pose = pose_at({0, 1.2, 0.02}, 10);
  const MeshBody whole = brittle.body();
  bool is_torn = false;
  for (int n = 0; n < 150 && !is_torn; ++n) {
    InstrumentPose next = pose;
    next.opening_degrees = 0;
    next.tip_mm += Vec3d(-0.0005, 0, 0.0005);
    const MeshBody before = brittle.body();
    const MembraneReport report = brittle.step(0.002, motion(forceps, pose, next), {forceps});
    pose = next;
    is_torn = count_of(report, MembraneEvent::Kind::edge_torn) > 0;
    // Stretch tells the tension of a sheet of springs that sweeps have solved.
    double loaded = 0;
    std::vector<Vec3d> places;
    for (const LinkNodes& link : before.links) {
      const double rest = (before.rest_mm[link[1]] - before.rest_mm[link[0]]).length();
      const double now = (before.pos_mm[link[1]] - before.pos_mm[link[0]]).length();
      const double tension = params.stiffness_n_m * (now / rest - 1);
      loaded = std::max(loaded, tension);
      if (tension < 0.8 * params.strength_n_m) continue;
      for (const int end : link) places.push_back(before.rest_mm[end]);
    }
    if (!is_torn) {
      EXPECT_LT(loaded, 1.1 * params.strength_n_m);
      continue;
    }
    const std::vector<Vec3d> torn = torn_places(before, brittle.body());
    ASSERT_FALSE(torn.empty());
    for (std::size_t e = 0; e < torn.size(); e += 2) {
      double nearest = HUGE_VAL;
      for (const Vec3d& place : places) {
        nearest = std::min({nearest, (torn[e] - place).length(), (torn[e + 1] - place).length()});
      }
      EXPECT_LT(nearest, 1e-9);
    }
  }
  EXPECT_TRUE(is_torn);
  EXPECT_GT(brittle.torn_mm(), 0);
}

TEST(PropertyTearing, StretchStaysWithinWhatTheStrengthAllows) {
  // A strip torn in two by slow pulling at its end: no edge goes far beyond its limit.
  const Instrument forceps = ball_forceps(1);
  MembraneParams params;
  params.strength_n_m = 2;
  params.adhesion_j_m2 = 1;
  params.sweeps = 40;
  Membrane membrane(flat_sheet(10, 3, 0.2), params, {plane_ground()}, "strip");
  InstrumentPose pose = pose_at({-0.93, 0.3, 0.02}, 10);
  std::int64_t torn = 0;
  for (int n = 0; n < 100; ++n) {
    InstrumentPose next = pose;
    next.opening_degrees = 0;
    next.tip_mm += Vec3d(-0.005, 0, 0.005);
    const MembraneReport report = membrane.step(0.02, motion(forceps, pose, next), {forceps});
    pose = next;
    torn += count_of(report, MembraneEvent::Kind::edge_torn);
    const double allowed = params.strength_n_m / params.stiffness_n_m;
    EXPECT_LT(report.longest_stretch, 1 + 1.5 * allowed) << n;
  }
  EXPECT_GT(torn, 0);
}

TEST(PropertyTearing, SameInputGivesSameBits) {
  const Instrument forceps = ball_forceps(0.3);
  std::string first;
  for (int run = 0; run < 2; ++run) {
    std::mt19937 random(5);
    Membrane membrane(flat_sheet(12, 12, 0.2), brittle_params(), {plane_ground()}, "sheet");
    InstrumentPose pose = pose_at({1, 1, 0.02}, 10);
    for (int n = 0; n < 60; ++n) act(membrane, forceps, pose, random);
    EXPECT_GT(membrane.torn_mm(), 0);
    if (run == 0) first = membrane.state_bytes();
    EXPECT_EQ(membrane.state_bytes(), first);
  }
}

}  // namespace supple::test
