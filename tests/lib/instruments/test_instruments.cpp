// Shapes, frames and surfaces of instruments.
#include <map>

#include <gtest/gtest.h>

#include "tests/lib/instruments/tool_cases.h"
#include "tests/support/errors.h"
#include "volumes/base/units.h"

using namespace supple;
using namespace supple::test;

namespace {

/// Volume that a surface holds; positive where it faces outwards.
double volume_of(const TriangleMesh& mesh) {
  double sum = 0;
  const auto& v = mesh.vertices_lps_mm;
  for (const auto& t : mesh.triangles) sum += v[t[0]].dot(v[t[1]].cross(v[t[2]])) / 6;
  return sum;
}

}  // namespace

TEST(UnitInstruments, TipsAreAtTheOriginAndShaftsHaveTheirDiameter) {
  for (const InstrumentKind kind : kInstrumentKinds) {
    const Instrument tool = instrument_of(kind);
    double lowest = 1, widest = 0;
    for (const InstrumentPart& part : tool.parts) {
      lowest = std::min(lowest, part.shape.a_mm.z - part.shape.a_radius_mm);
      widest = std::max(widest, part.shape.b_radius_mm);
    }
    EXPECT_NEAR(lowest, 0, 1e-12) << int(kind);
    EXPECT_NEAR(widest, 0.25, 1e-12) << int(kind);
    EXPECT_EQ(tool.grip.has_value(), kind == InstrumentKind::forceps);
    EXPECT_EQ(tool.port.has_value(), kind == InstrumentKind::vitrector);
    EXPECT_EQ(tool.lamp.has_value(), kind == InstrumentKind::lamp);
  }
}

TEST(UnitInstruments, JawsOpenByHalfOfTheOpeningEachAndStayAtTheirHinge) {
  const Instrument forceps = instrument_of(InstrumentKind::forceps);
  InstrumentPose pose;
  pose.opening_degrees = 60;
  const std::vector<RoundCone> open = parts_at(forceps, pose);
  for (std::size_t n = 0; n < open.size(); ++n) {
    const InstrumentPart& part = forceps.parts[n];
    const Vec3d before = part.shape.a_mm - forceps.hinge_mm;
    const Vec3d after = open[n].a_mm - forceps.hinge_mm;
    EXPECT_NEAR(before.length(), after.length(), 1e-12);
    const double turned = std::atan2(before.cross(after).x, before.dot(after));
    EXPECT_NEAR(turned, part.jaw * 30 * kRadiansPerDegree, 1e-12);
    if (part.jaw != 0) {
      EXPECT_GT(part.jaw * after.y, 0);
    }
  }
  // Closed jaws touch each other at their ends.
  double gap = 1;
  for (const InstrumentPart& part : forceps.parts) {
    if (part.jaw == 1) gap = std::min(gap, part.shape.a_mm.y - part.shape.a_radius_mm);
  }
  EXPECT_NEAR(gap, 0, 1e-12);
}

TEST(PropertyInstruments, FramesAreRightHandedAndGoSteadilyWithTheAxis) {
  std::mt19937 random(3);
  for (int n = 0; n < 1000; ++n) {
    InstrumentPose pose;
    pose.axis = random_direction(random);
    pose.roll_degrees = random_number(random, -400, 400);
    const ToolFrame frame = frame_of(pose);
    EXPECT_LT((frame.x.cross(frame.y) - frame.z).length(), 1e-12);
    EXPECT_LT((frame.z - pose.axis).length(), 1e-12);
    const Vec3d local = random_point(random, 3);
    EXPECT_LT((frame.local(frame.place(local)) - local).length(), 1e-12);
    if (pose.axis.z < -0.9) continue;
    InstrumentPose near = pose;
    near.axis = (pose.axis + random_direction(random) * 1e-6).normalized();
    EXPECT_LT((frame_of(near).x - frame.x).length(), 1e-5);
  }
}

TEST(PropertyInstruments, SurfacesAreClosedFaceOutwardsAndFollowTheParts) {
  for (const InstrumentKind kind : kInstrumentKinds) {
    const Instrument tool = instrument_of(kind);
    for (const InstrumentMesh& skin : meshes_of(tool)) {
      std::map<std::pair<int, int>, int> uses;
      for (const auto& t : skin.mesh.triangles) {
        for (int c = 0; c < 3; ++c) ++uses[{t[c], t[(c + 1) % 3]}];
      }
      for (const auto& [edge, count] : uses) {
        EXPECT_EQ(count, 1);
        EXPECT_EQ(uses.count({edge.second, edge.first}), 1u);
      }
      EXPECT_GT(volume_of(skin.mesh), 0);
      EXPECT_GT(skin.mesh.triangles.size(), 600u);
      EXPECT_LT(skin.mesh.triangles.size(), 2500u);
      // Pictures show no more than what touches, within a tenth of the shaft's width.
      for (const Vec3d& v : skin.mesh.vertices_lps_mm) {
        double nearest = 10;
        for (const InstrumentPart& part : tool.parts) {
          nearest = std::min(nearest, approach(v, part.shape).distance_mm);
        }
        EXPECT_LT(nearest, 0.1) << int(kind);
      }
    }
  }
}

TEST(UnitInstruments, PortOfAVitrectorIsANotchInItsSurface) {
  const Instrument tool = instrument_of(InstrumentKind::vitrector);
  const MeshSurface surface(meshes_of(tool)[0].mesh);
  const Vec3d inside = tool.port->centre_mm - tool.port->outward * 0.1;
  EXPECT_GT(surface.distance_to(inside).distance_mm, 0.02);
  EXPECT_LT(surface.distance_to(inside - Vec3d(0, 0.3, 0)).distance_mm, 0);
}

TEST(FaultInstruments, MeasuresThatAreNotPositiveAreRefused) {
  InstrumentSetup setup;
  setup.diameter_mm = 0;
  EXPECT_NE(input_error([&] { make_instrument(setup); }).find("diameter"), std::string::npos);
  setup.diameter_mm = 0.5;
  setup.length_mm = 2;
  EXPECT_NE(input_error([&] { make_instrument(setup); }).find("length"), std::string::npos);
  setup.length_mm = std::nan("");
  EXPECT_NE(input_error([&] { make_instrument(setup); }), "");
  setup.length_mm = 30;
  setup.jaw_mm = -1;
  EXPECT_EQ(input_error([&] { make_instrument(setup); }), "");
  setup.kind = InstrumentKind::forceps;
  EXPECT_NE(input_error([&] { make_instrument(setup); }).find("jaw"), std::string::npos);
}
