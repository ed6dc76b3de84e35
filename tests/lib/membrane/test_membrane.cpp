// Laws of membranes on their own, under forceps and under blunt tools.
#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include <gtest/gtest.h>

#include "lib/membrane/sheet.h"
#include "tests/lib/membrane/sheets.h"
#include "volumes/base/error.h"
#include "volumes/base/units.h"

namespace supple::test {

namespace {

const TriangleMesh& small_sheet() {
  static const TriangleMesh sheet = flat_sheet(12, 12, 0.2);
  return sheet;
}

/// A tool of one ball.
Instrument ball_tool(double radius_mm) {
  Instrument tool;
  tool.parts = {{RoundCone{Vec3d(0.0), Vec3d(0, 0, 1e-3), radius_mm, radius_mm}, 0}};
  return tool;
}

MembraneParams loose_params() {
  MembraneParams params;
  params.adhesion_j_m2 = 0;
  params.strength_n_m = 0;
  return params;
}

/// A sheet that forceps have pulled up by a corner, with what clings around it.
Membrane pulled_sheet(const MembraneParams& params, const Instrument& forceps,
                      InstrumentPose& pose) {
  Membrane membrane(small_sheet(), params, {plane_ground()}, "sheet");
  for (int n = 0; n < 20; ++n) {
    InstrumentPose next = pose;
    next.opening_degrees = 0;
    next.tip_mm += Vec3d(0.01, 0.005, 0.03);
    membrane.step(0.02, motion(forceps, pose, next), {forceps});
    pose = next;
  }
  return membrane;
}

}  // namespace

TEST(UnitMembrane, RegularTrianglesHaveTheStiffnessOfTheSheet) {
  // Strips of triangular lattice pulled along an edge direction: the energy of a strain is
  // E t e^2 / 2 per area where sides may shrink by a third of it.
  TriangleMesh sheet;
  for (int j = 0; j <= 20; ++j) {
    for (int i = 0; i <= 20; ++i) {
      const int node = int(sheet.vertices_lps_mm.size());
      sheet.vertices_lps_mm.push_back({i + 0.5 * j, std::sqrt(0.75) * j, 0});
      if (i == 20 || j == 20) continue;
      sheet.triangles.push_back({node, node + 1, node + 21});
      sheet.triangles.push_back({node + 1, node + 22, node + 21});
    }
  }
  const MembraneParams params = loose_params();
  const Sheet springs = make_sheet(sheet, params);
  const double strain = 1e-4, width = std::sqrt(0.75) * 20, area = 20 * width;
  double energy_uj = 0;
  for (const SheetSpring& spring : springs.springs) {
    const Vec3d edge = springs.body.rest_mm[spring.b] - springs.body.rest_mm[spring.a];
    const double stretch =
        strain * (edge.x * edge.x - edge.y * edge.y / 3) / spring.rest_mm;  // to first order
    energy_uj += 0.5 * spring.stiffness_n_m * stretch * stretch;
  }
  EXPECT_NEAR(energy_uj, 0.5 * params.stiffness_n_m * strain * strain * area, 0.01 * energy_uj);
}

TEST(UnitMembrane, MeshesThatAreNoManifoldAreRefused) {
  TriangleMesh bow_tie{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}},
                       {{0, 1, 2}, {0, 3, 4}}};
  EXPECT_THROW(Membrane(bow_tie, {}, {}, "m"), InputError);
  TriangleMesh both_ways{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {{0, 1, 2}, {1, 2, 3}}};
  EXPECT_THROW(Membrane(both_ways, {}, {}, "m"), InputError);
  TriangleMesh flat{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}};
  EXPECT_THROW(Membrane(flat, {}, {}, "m"), InputError);
  MembraneParams params;
  params.sweeps = 1;
  EXPECT_THROW(Membrane(small_sheet(), params, {}, "m"), InputError);
  params = {};
  params.stiffness_n_m = std::nan("");
  EXPECT_THROW(Membrane(small_sheet(), params, {}, "m"), InputError);
  EXPECT_THROW(Membrane(small_sheet(), {}, {}, "m").step(0.003, {}, {}), InputError);
}

TEST(UnitMembrane, SheetsOnSpheresHaveNearlyEqualTrianglesAndARoundRim) {
  const TriangleMesh sheet = membrane_on_sphere({1, 2, 3}, 12, {0.3, -0.2, -1}, 5, 1500);
  const Membrane membrane(sheet, {}, {}, "sheet");
  EXPECT_EQ(fault_of(membrane.body()), "");
  EXPECT_GE(sheet.vertices_lps_mm.size(), 1500u);
  EXPECT_LT(sheet.vertices_lps_mm.size(), 1600u);
  const auto length_of = [&](const LinkNodes& edge) {
    return (sheet.vertices_lps_mm[edge[1]] - sheet.vertices_lps_mm[edge[0]]).length();
  };
  double mean = 0;
  for (const LinkNodes& link : membrane.body().links) mean += length_of(link);
  mean /= double(membrane.body().links.size());
  for (const LinkNodes& link : membrane.body().links) {
    EXPECT_GT(length_of(link), 0.88 * mean);
    EXPECT_LT(length_of(link), 1.28 * mean);
  }
  const double cap_mm2 = 2 * kPi * 144 * (1 - std::cos(5.0 / 12));
  const double mean_mm2 = cap_mm2 / double(sheet.triangles.size());
  for (const TriangleNodes& t : sheet.triangles) {
    const Vec3d &a = sheet.vertices_lps_mm[t[0]], &b = sheet.vertices_lps_mm[t[1]];
    EXPECT_NEAR((a - Vec3d(1, 2, 3)).length(), 12, 1e-9);
    const Vec3d& c = sheet.vertices_lps_mm[t[2]];
    const Vec3d normal = (b - a).cross(c - a);
    EXPECT_GT(normal.dot(Vec3d(1, 2, 3) - a), 0);
    EXPECT_NEAR(0.5 * normal.length(), mean_mm2, 0.19 * mean_mm2);
    const double sides[] = {(b - a).length(), (c - b).length(), (a - c).length()};
    for (int n = 0; n < 3; ++n) {
      // The sine of a corner, none of which is blunt here.
      EXPECT_GT(normal.length() / (sides[n] * sides[(n + 1) % 3]), 0.5);
    }
  }
  // Edges of one triangle are the rim.
  const Vec3d middle = Vec3d(0.3, -0.2, -1).normalized();
  std::map<LinkNodes, int> beside;
  for (const TriangleNodes& t : sheet.triangles) {
    for (int n = 0; n < 3; ++n) {
      const int a = t[n], b = t[(n + 1) % 3];
      ++beside[{std::min(a, b), std::max(a, b)}];
    }
  }
  for (const auto& [edge, count] : beside) {
    if (count != 1) continue;
    EXPECT_NEAR(length_of(edge), 2 * 12 * std::sin(5.0 / 12) * std::sin(kPi / (6 * 22)), 1e-9);
    for (const int node : edge) {
      const Vec3d from = sheet.vertices_lps_mm[node] - Vec3d(1, 2, 3);
      EXPECT_NEAR(std::atan2(from.cross(middle).length(), from.dot(middle)), 5.0 / 12, 1e-9);
    }
  }
}

TEST(PropertyMembrane, ASheetAtRestKeepsItsShape) {
  for (const auto model : {MembraneModel::springs, MembraneModel::ecm}) {
    MembraneParams params;
    params.model = model;
    params.bending_n_m = 0.1;
    Membrane membrane(small_sheet(), params, {plane_ground()}, "sheet");
    const MeshBody before = membrane.body();
    for (int n = 0; n < 50; ++n) membrane.step(0.02, {}, {});
    for (std::size_t n = 0; n < before.node_count(); ++n) {
      EXPECT_LT((membrane.body().pos_mm[n] - before.pos_mm[n]).length(), 1e-9);
      EXPECT_EQ(membrane.body().rest_mm[n], before.rest_mm[n]);
    }
    EXPECT_NEAR(membrane.clinging_mm2(), 2.4 * 2.4, 1e-9);
  }
}

TEST(PropertyMembrane, EnergyNeverGrowsWhereNothingDoesWork) {
  for (const bool holds : {true, false}) {
    for (const int sweeps : {2, 20}) {
      MembraneParams params;
      params.strength_n_m = 0;
      params.adhesion_mm = 0.2;
      params.sweeps = sweeps;
      params.damping_per_s = 0;
      const Instrument forceps = ball_forceps(0.3);
      InstrumentPose pose = pose_at({0, 0, 0.02}, 10);
      Membrane membrane = pulled_sheet(params, forceps, pose);
      InstrumentPose open = pose;
      open.opening_degrees = 10;
      if (!holds) membrane.step(0.002, motion(forceps, pose, open), {forceps});
      pose = holds ? pose : open;
      const double first = membrane.energy().total_j();
      double before = first;
      EXPECT_GT(before, 1e-10);
      for (int n = 0; n < 200; ++n) {
        membrane.step(0.002, motion(forceps, pose, pose), {forceps});
        const double after = membrane.energy().total_j();
        // Sweeps that end before they have solved a substep leave a residue.
        EXPECT_LE(after, before * (1 + 1e-5) + 1e-15) << holds << " " << sweeps << " " << n;
        before = after;
      }
      EXPECT_LT(before, first);
    }
  }
}

TEST(PropertyMembrane, ReleasedSheetsGoBackToTheirShapeAtRest) {
  const MembraneParams params = loose_params();
  const Instrument forceps = ball_forceps(0.3);
  Membrane membrane(small_sheet(), params, {}, "sheet");
  InstrumentPose pose = pose_at({0, 0, 0}, 10);
  for (int n = 0; n < 20; ++n) {
    InstrumentPose next = pose;
    next.opening_degrees = n < 15 ? 0 : 10;
    next.tip_mm += Vec3d(-0.05, -0.03, 0.02);
    membrane.step(0.02, motion(forceps, pose, next), {forceps});
    pose = next;
  }
  for (int n = 0; n < 300; ++n) membrane.step(0.02, {}, {});
  EXPECT_LT(membrane.energy().springs_j, 1e-12);
  EXPECT_TRUE(membrane.gripped(0).empty());
}

TEST(PropertyMembrane, GrippedNodesGoWithTheForcepsUntilTheseOpen) {
  const Instrument forceps = ball_forceps(0.3);
  for (const auto model : {MembraneModel::springs, MembraneModel::ecm}) {
    MembraneParams params;
    params.model = model;
    Membrane membrane(small_sheet(), params, {plane_ground()}, "sheet");
    InstrumentPose open = pose_at({0, 0, 0.02}, 10), closed = open, lifted = open;
    closed.opening_degrees = lifted.opening_degrees = 0;
    lifted.tip_mm += Vec3d(0.1, 0, 0.2);
    InstrumentPose ajar = lifted, away = lifted;
    away.opening_degrees = 10;
    MembraneReport report = membrane.step(0.02, motion(forceps, open, closed), {forceps});
    EXPECT_EQ(count_of(report, MembraneEvent::Kind::gripped), 4);
    const std::vector<int> held = membrane.gripped(0);
    ASSERT_EQ(held.size(), 4u);
    report = membrane.step(0.02, motion(forceps, closed, lifted), {forceps});
    for (const int node : held) {
      const Vec3d wanted = membrane.body().rest_mm[node] + Vec3d(0.1, 0, 0.2);
      EXPECT_LT((membrane.body().pos_mm[node] - wanted).length(), 1e-4);
    }
    EXPECT_LE(report.tool_forces_n[0].z, 0);
    ajar.opening_degrees = 7;  // neither closes nor opens
    EXPECT_TRUE(membrane.step(0.02, motion(forceps, lifted, ajar), {forceps}).events.empty() ||
                membrane.gripped(0).size() == 4);
    const Vec3d lifted_mm = membrane.body().pos_mm[held[0]];
    report = membrane.step(0.02, motion(forceps, ajar, away), {forceps});
    EXPECT_EQ(count_of(report, MembraneEvent::Kind::released), 4);
    EXPECT_TRUE(membrane.gripped(0).empty());
    for (int n = 0; n < 20; ++n) membrane.step(0.02, motion(forceps, away, away), {forceps});
    const double gone_mm = (membrane.body().pos_mm[held[0]] - lifted_mm).length();
    if (model == MembraneModel::springs) {
      EXPECT_GT(gone_mm, 0.01);
    } else {
      EXPECT_EQ(gone_mm, 0);
    }
  }
}

TEST(PropertyMembrane, ClosingForcepsTakeAFoldWhereverTheyCloseOnTheSheet) {
  InstrumentSetup setup;
  setup.kind = InstrumentKind::forceps;
  const Instrument forceps = make_instrument(setup);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> part(0, 1);
  for (int n = 0; n < 20; ++n) {
    Membrane membrane(flat_sheet(12, 12, 0.12), {}, {plane_ground()}, "sheet");
    InstrumentPose pose = pose_at({0.7 + 0.12 * part(random), 0.7 + 0.12 * part(random), 0.06}, 20);
    pose.axis = Vec3d(0.3 * part(random), 0.3 * part(random), 1).normalized();
    pose.roll_degrees = 360 * part(random);
    std::int64_t gripped = 0;
    while (pose.opening_degrees > 2) {
      InstrumentPose next = pose;
      next.opening_degrees -= 1;
      gripped += count_of(membrane.step(0.02, motion(forceps, pose, next), {forceps}),
                          MembraneEvent::Kind::gripped);
      pose = next;
    }
    EXPECT_GE(gripped, 3) << n;
    EXPECT_LE(gripped, 9) << n;
    EXPECT_EQ(membrane.torn_mm(), 0);
  }
}

TEST(PropertyMembrane, FastToolsDoNotPassThroughTheSheet) {
  // A ball comes from above at up to 25 times its diameter per substep.
  for (const double step_mm : {0.1, 1.0, 10.0, 100.0}) {
    MembraneParams params = loose_params();
    Membrane membrane(small_sheet(), params, {}, "sheet");
    const Instrument tool = ball_tool(0.2);
    InstrumentPose from = pose_at({1.2, 1.2, 0.35}, 0), to = from;
    to.tip_mm.z -= step_mm;
    const MembraneReport report = membrane.step(0.002, motion(tool, from, to), {tool});
    EXPECT_EQ(report.contacts > 0, step_mm > 0.2);
    for (const Vec3d& pos : membrane.body().pos_mm) {
      // What the ball ran into is before it.
      const bool is_before = std::hypot(pos.x - 1.2, pos.y - 1.2) < 0.15;
      EXPECT_TRUE(!is_before || pos.z < to.tip_mm.z) << step_mm;
    }
    EXPECT_EQ(report.tool_forces_n[0].z > 0, step_mm > 0.2);
  }
}

TEST(UnitMembrane, ABallThatPressesTheSheetOntoTheGroundPinchesWhatIsUnderIt) {
  const MembraneParams params;
  const Instrument tool = ball_tool(0.3);
  const InstrumentPose from = pose_at({1.2, 1.2, 0.5}, 0);
  const auto pinched_at = [&](double lowest_mm, const std::vector<Obstacle>& under) {
    Membrane membrane(small_sheet(), params, under, "sheet");
    InstrumentPose to = from;
    to.tip_mm.z = 0.3 + lowest_mm;
    const MembraneReport report = membrane.step(0.02, motion(tool, from, to), {tool});
    EXPECT_EQ(report.contacts > 0, lowest_mm < 2 * params.thickness_mm);
    return report.pinched;
  };
  // The ball bends away from four neighbours by 0.076 mm, from four more by 0.2 mm.
  const double above_mm = 2 * params.thickness_mm;
  EXPECT_EQ(pinched_at(above_mm + 0.005, {plane_ground()}), 0);
  EXPECT_EQ(pinched_at(above_mm - 0.005, {plane_ground()}), 1);
  EXPECT_EQ(pinched_at(above_mm - 0.1, {plane_ground()}), 5);
  EXPECT_EQ(pinched_at(-0.1, {}), 0);
}

TEST(UnitMembrane, TrianglesThatTurnOverAreTold) {
  // A node is led through its neighbours, which cling, within the plane of the sheet.
  const Instrument forceps = ball_forceps(0.1);
  MembraneParams params = loose_params();
  params.adhesion_j_m2 = 5000;
  params.adhesion_mm = 1;
  Membrane membrane(small_sheet(), params, {plane_ground()}, "sheet");
  InstrumentPose pose = pose_at({1.2, 1.2, params.thickness_mm}, 10);
  int most = 0;
  for (int n = 0; n < 40; ++n) {
    InstrumentPose next = pose;
    next.opening_degrees = 0;
    next.tip_mm.x += 0.02;
    const int told = membrane.step(0.02, motion(forceps, pose, next), {forceps}).inverted;
    pose = next;
    const MeshBody& body = membrane.body();
    const auto turned =
        std::count_if(body.triangles.begin(), body.triangles.end(), [&](const TriangleNodes& t) {
          const Vec3d& first = body.pos_mm[t[0]];
          return (body.pos_mm[t[1]] - first).cross(body.pos_mm[t[2]] - first).z <= 0;
        });
    EXPECT_EQ(told, int(turned)) << n;
    most = std::max(most, told);
  }
  EXPECT_GT(most, 1);
}

TEST(PropertyMembrane, NothingEntersTheGroundAndPinchedNodesAreCounted) {
  const MembraneParams params;
  Membrane membrane(small_sheet(), params, {plane_ground()}, "sheet");
  const Instrument tool = ball_tool(0.3);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> part(0, 1);
  InstrumentPose pose = pose_at({1.2, 1.2, 1}, 0);
  int pinched = 0;
  for (int n = 0; n < 100; ++n) {
    InstrumentPose next = pose_at({2.4 * part(random), 2.4 * part(random), 0.6 * part(random)}, 0);
    const MembraneReport report = membrane.step(0.02, motion(tool, pose, next), {tool});
    pose = next;
    pinched += report.pinched;
    EXPECT_LE(report.pinched, report.contacts);
    for (const Vec3d& pos : membrane.body().pos_mm) {
      EXPECT_GE(pos.z, params.thickness_mm - 1e-9);
      EXPECT_TRUE(is_finite(pos));
    }
  }
  EXPECT_GT(pinched, 0);
}

TEST(PropertyMembrane, ModelsAreExchangedWhileForcepsPull) {
  const Instrument forceps = ball_forceps(0.3);
  InstrumentPose pose = pose_at({0, 0, 0.02}, 10);
  Membrane membrane = pulled_sheet({}, forceps, pose);
  double clings = membrane.clinging_mm2();
  for (int n = 0; n < 40; ++n) {
    membrane.take_model(n / 5 % 2 == 0 ? MembraneModel::ecm : MembraneModel::springs);
    InstrumentPose next = pose;
    next.tip_mm += Vec3d(0.01, 0.005, 0.02);
    membrane.step(0.02, motion(forceps, pose, next), {forceps});
    pose = next;
    EXPECT_EQ(membrane.gripped(0).size(), 4u);
    EXPECT_LE(membrane.clinging_mm2(), clings);
    clings = membrane.clinging_mm2();
    EXPECT_EQ(fault_of(membrane.body()), "");
  }
  EXPECT_LT(clings, 2.4 * 2.4 - 0.5);
}

}  // namespace supple::test
