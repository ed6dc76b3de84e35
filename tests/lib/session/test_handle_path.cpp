// Handles that follow paths of poses, against the same poses as steps of their own.
#include <cmath>

#include <gtest/gtest.h>

#include "lib/material/material.h"
#include "lib/session/handles/handle_path.h"
#include "lib/session/session.h"
#include "tests/lib/test_bodies.h"
#include "tests/support/program.h"
#include "tests/support/sanitized.h"
#include "volumes/geometry/pose_path.h"

using namespace supple;
using namespace supple::test;

namespace {

PlacedPose shifted(double time, const Vec3d& by, Easing easing = Easing::linear) {
  PlacedPose pose;
  pose.time = time;
  pose.by = by;
  pose.easing = easing;
  return pose;
}

PlacedPose turned(double time, double angle_deg) {
  PlacedPose pose;
  pose.time = time;
  pose.rotate_deg = angle_deg;
  pose.easing = Easing::linear;
  return pose;
}

class PropertyHandlePath : public ::testing::Test {
 protected:
  PropertyHandlePath() {
    write_ball(m_folder, "ball", 24);
    write_soft_material(m_folder / "soft.toml");
    m_options.material = read_material(m_folder / "soft.toml");
  }

  Drag grabbing(const Vec3d& lo, const Vec3d& hi, std::vector<PlacedPose> path) const {
    Drag handle;
    handle.placed.emplace().corners = {lo, hi};
    handle.placed->axis = Vec3d(0, 0, 1);
    handle.placed->path = std::move(path);
    return handle;
  }
  std::unique_ptr<Session> opened() const {
    return std::make_unique<Session>(m_folder / "ball.nhdr", m_options);
  }
  std::unique_ptr<Session> after(const std::vector<Drag>& handles, Step request = {}) const {
    auto session = opened();
    request.drags = handles;
    session->step(request);
    return session;
  }
  /// Shifts of one handle, each a step; in mm from where it was before.
  std::unique_ptr<Session> stepped(const Region& grabbed, const std::vector<Vec3d>& ways) const {
    auto session = opened();
    for (const Vec3d& way : ways) session->drag(grabbed, way);
    return session;
  }
  Vec3d moved(const Session& session, const Vec3i& voxel) const {
    return Vec3d(session.body().offset(voxel, 0), session.body().offset(voxel, 1),
                 session.body().offset(voxel, 2)) /
           kFixedOne;
  }
  std::size_t poses(const Drag& handle) const {
    return drags_along_paths({handle}, opened()->geometry()).front().way.size() + 1;
  }

  TemporaryFolder m_folder;
  SessionOptions m_options;
};

const Vec3d kLow(10, 10, 10), kHigh(13, 13, 13);
const Region kPart(Vec3i(10, 10, 10), Vec3i(13, 13, 13));

}  // namespace

TEST_F(PropertyHandlePath, AStraightPathIsOneDrag) {
  for (const Easing easing : {Easing::smooth, Easing::linear, Easing::hold, Easing::spline}) {
    const Drag path =
        grabbing(kLow, kHigh, {shifted(0, {0, 0, 0}, easing), shifted(1, {2, -3, 1}, easing)});
    EXPECT_EQ(poses(path), 1u);
    const auto found = after({path}), expected = stepped(kPart, {{2, -3, 1}});
    EXPECT_EQ(found->body().q, expected->body().q);
    EXPECT_EQ(found->journal(), expected->journal());
  }
}

TEST_F(PropertyHandlePath, APathRoundACornerIsItsKeysAsSteps) {
  const Drag path = grabbing(
      kLow, kHigh,
      {shifted(0, {0, 0, 0}), shifted(1, {5, 0, 0}), shifted(3, {5, 4, 0}), shifted(4, {0, 4, 0})});
  const auto found = after({path});
  EXPECT_EQ(found->body().q, stepped(kPart, {{5, 0, 0}, {0, 4, 0}, {-5, 0, 0}})->body().q);
  EXPECT_NE(found->body().q, stepped(kPart, {{0, 4, 0}})->body().q);
  EXPECT_EQ(found->records().size(), 1u);
}

TEST_F(PropertyHandlePath, ARelaxedPathIsItsKeysAsRelaxedSteps) {
  Step relaxed;
  relaxed.relax = RelaxParams();
  const auto found =
      after({grabbing(kLow, kHigh, {shifted(1, {4, 0, 0}), shifted(3, {4, 4, 0})})}, relaxed);
  auto expected = opened();
  for (const Vec3d& way : {Vec3d(4, 0, 0), Vec3d(0, 4, 0)}) {
    relaxed.drags = {Drag{kPart, way}};
    expected->step(relaxed);
  }
  EXPECT_EQ(found->body().q, expected->body().q);
}

TEST_F(PropertyHandlePath, APathUnderSpringsIsItsKeysAsStepsOfSprings) {
  LEFT_OUT_WHEN_SANITIZED();
  for (const bool minimises : {false, true}) {
    Step sprung;
    sprung.springs = SpringStep();
    sprung.springs->motion.minimise = minimises;
    sprung.springs->time_s = 0.004;
    sprung.springs->motion.step_s = 0.002;
    sprung.springs->most_steps = 3;
    const auto found =
        after({grabbing(kLow, kHigh, {shifted(1, {1, 0, 0}), shifted(3, {1, 1, 0})})}, sprung);
    auto expected = opened();
    for (const Vec3d& way : {Vec3d(1, 0, 0), Vec3d(0, 1, 0)}) {
      sprung.drags = {Drag{kPart, way}};
      expected->step(sprung);
    }
    EXPECT_EQ(found->body().q, expected->body().q) << minimises;
    EXPECT_NEAR((moved(*found, {11, 11, 11}) - Vec3d(1, 1, 0)).length(), 0, 1e-4) << minimises;
    EXPECT_NE(moved(*found, {9, 11, 11}), Vec3d(0, 0, 0)) << minimises;
  }
}

TEST_F(PropertyHandlePath, AHandleThatTurnsAndComesBackLeavesTissueWhereItWasTaken) {
  const Drag path =
      grabbing(kLow, kHigh, {turned(0, 0), turned(1, 15), turned(2, -15), turned(3, 0)});
  const auto found = after({path});
  double most = 0;
  const Body& body = found->body();
  const IndexBox grabbed{Vec3i(kLow), Vec3i(kHigh)};
  for_each_element(body.elements, [&](Slot slot) {
    const Vec3i voxel = voxel_of(body.elements, slot);
    const double went = moved(*found, voxel).length();
    if (grabbed.contains(voxel)) {
      EXPECT_EQ(went, 0) << voxel;
    }
    most = std::max(most, went);
  });
  EXPECT_GT(most, 0.02);
}

TEST_F(PropertyHandlePath, PosesAreMeantFromWhereTheStepStarts) {
  const auto found = after({grabbing(kLow, kHigh, {turned(0, 0), turned(1, 15), turned(2, -15)})});
  auto expected = opened();
  Step once;
  once.drags.push_back({kPart, {0, 0, 0}});
  once.drags.front().motion.axis_lps = {0, 0, 1};
  once.drags.front().motion.angle_deg = -15;
  expected->step(once);
  const IndexBox grabbed{Vec3i(kLow), Vec3i(kHigh)};
  for_each_element(found->body().elements, [&](Slot slot) {
    const Vec3i voxel = voxel_of(found->body().elements, slot);
    if (grabbed.contains(voxel)) {
      EXPECT_EQ(moved(*found, voxel), moved(*expected, voxel)) << voxel;
    }
  });
  EXPECT_GT(moved(*found, {13, 13, 11}).length(), 0.3);
}

TEST_F(PropertyHandlePath, PosesLieSoNearThatShiftsAndTurnsStayOnTheirPath) {
  EXPECT_EQ(poses(grabbing(kLow, kHigh, {turned(0, 0), turned(1, 10)})), 1u);
  EXPECT_EQ(poses(grabbing(kLow, kHigh, {turned(0, 0), turned(1, 45)})), 8u);
  EXPECT_EQ(poses(grabbing(kLow, kHigh, {turned(0, 0), turned(1, 720)})), 128u);
  const Drag curve =
      grabbing(kLow, kHigh,
               {shifted(0, {0, 0, 0}, Easing::spline), shifted(1, {20, 0, 0}, Easing::spline),
                shifted(2, {20, 20, 0}, Easing::spline)});
  const Geometry geometry = opened()->geometry();
  const PosePath path = path_of(*curve.placed, geometry);
  std::vector<Vec3d> corners = {{0, 0, 0}};
  const Drag drag = drags_along_paths({curve}, geometry).front();
  for (const DragPose& pose : drag.way) corners.push_back(pose.by_mm);
  corners.push_back(drag.by_mm);
  EXPECT_GT(corners.size(), 4u);
  for (double time = 0; time <= 2; time += 0.01) {
    double nearest = 1e9;
    for (std::size_t n = 0; n + 1 < corners.size(); ++n) {
      const Vec3d way = corners[n + 1] - corners[n], at = path.at(time).shift_mm - corners[n];
      const double part = std::clamp(at.dot(way) / way.dot(way), 0.0, 1.0);
      nearest = std::min(nearest, (at - way * part).length());
    }
    EXPECT_LT(nearest, 0.4) << time;
  }
}

TEST_F(PropertyHandlePath, WhatAnchorsStopComesBackToItsPath) {
  Step fixed;
  fixed.fix.push_back({{0, 0, 0}, {5, 23, 23}});
  const auto found =
      after({grabbing(kLow, kHigh, {shifted(1, {30, 0, 0}), shifted(2, {1, 1, 0})})}, fixed);
  EXPECT_EQ(moved(*found, {11, 11, 11}), Vec3d(1, 1, 0));
  EXPECT_LT(found->records().back().report.fraction(), 1);
  ASSERT_EQ(found->messages().size(), 1u);
  EXPECT_EQ(found->messages().front().find("pose 1: anchors stopped"), 0u);
}

TEST_F(PropertyHandlePath, EdgesAndToolsFollowToo) {
  Drag soft;
  soft.placed.emplace().ball = Vec3d(12, 12, 12);
  soft.placed->radius_mm = 2.5;
  soft.soft_mm = 5;
  soft.placed->path = {shifted(1, {0, 1, 0}), shifted(2, {0, 2, 0}), shifted(3, {0, 3, 0})};
  Drag once = soft;
  once.placed->path = {shifted(3, {0, 3, 0})};
  EXPECT_EQ(after({soft})->body().q, after({once})->body().q);

  Drag tool = grabbing(kLow, kHigh, {shifted(1, {4, 0, 0}), shifted(2, {-1, 0, 0})});
  tool.pushes = true;
  const auto pushed = after({tool});
  EXPECT_EQ(moved(*pushed, {11, 11, 11}), Vec3d(4, 0, 0));

  // Tissue that another handle pulls ahead of the tool does not take the tool along.
  Drag ahead;
  ahead.placed.emplace().corners = {Vec3d(20, 11, 11), Vec3d(20, 11, 11)};
  ahead.placed->by = Vec3d(3, 0, 0);
  tool.placed->path = {shifted(1, {0.1, 0.5, 0}), shifted(2, {0.5, 0.5, 0}),
                       shifted(3, {0.5, 0, 0}), shifted(4, {2, 0, 0})};
  const auto met = after({tool, ahead});
  EXPECT_EQ(moved(*met, {13, 11, 11}).x, 2);
}

TEST_F(PropertyHandlePath, AnEdgeTurnsBackWithItsHandle) {
  m_options.material = parse_material(
      "domain = [0, 255]\nactive = [1, 255]\nmax_length = [[0, 2.5]]\nmin_length = [[0, 0.1]]\n"
      "shear = [[0, 1.5]]\n",
      "test");
  Drag soft;
  soft.placed.emplace().ball = Vec3d(12, 12, 12);
  soft.placed->radius_mm = 2.5;
  soft.soft_mm = 5;
  soft.placed->path = {shifted(1, {0, 3, 0}), shifted(2, {0, -3, 0})};
  const auto found = after({soft});
  EXPECT_EQ(moved(*found, {12, 12, 12}).y, -3);
  const double t = 0.5;  // of the edge's width, at 5 mm from the middle
  EXPECT_LT(moved(*found, {17, 12, 12}).y, -3 * (1 - t * t * (3 - 2 * t)) + 2 / kFixedOne);
}

TEST_F(PropertyHandlePath, HandlesWithoutPathAreWhereTheyGoFromTheFirstPoseOn) {
  Drag plain;
  plain.placed.emplace().corners = {Vec3d(11, 11, 4), Vec3d(11, 11, 4)};
  plain.placed->by = Vec3d(0, 0, -1);
  const auto found =
      after({plain, grabbing(kLow, kHigh, {shifted(1, {1, 0, 0}), shifted(2, {1, 1, 0})})});
  auto expected = opened();
  Step both;
  both.drags = {Drag{Vec3i(11, 11, 4), {0, 0, -1}}, Drag{kPart, {1, 0, 0}}};
  expected->step(both);
  both.drags = {Drag{Vec3i(11, 11, 4), {0, 0, 0}}, Drag{kPart, {0, 1, 0}}};
  expected->step(both);
  EXPECT_EQ(found->body().q, expected->body().q);
}

TEST_F(PropertyHandlePath, ARigidPieceOnAPathKeepsItsShapeAndMeetsItsEnd) {
  m_options.material = parse_material(
      "domain = [0, 255]\nactive = [1, 255]\nmax_length = [[0, 1.6]]\nmin_length = [[0, 0.6]]\n"
      "shear = [[0, 0.29]]\nlinks = 26\n",
      "test");
  const Geometry geometry = opened()->geometry();
  std::vector<PlacedPose> path = {turned(0, 0), turned(1, 12)};
  path[0].by = Vec3d(0, 0, 0);
  path[1].by = Vec3d(1, 0.5, 0);
  Step rigid;
  rigid.rigid.parts.emplace_back().placed.emplace().corners = {kLow, kHigh};
  Drag handle = grabbing(kLow, kHigh, path);
  handle.placed->about = Vec3d(11, 11, 11);
  const auto found = after({handle}, rigid);
  EXPECT_EQ(found->records().back().report.fraction(), 1);
  const Turn turn = turn_about(lps_of({0, 0, 1}, PlaceFrame::voxel, geometry), 12);
  const Vec3d about = geometry.world_from_index({11, 11, 11});
  for (const Vec3i& voxel : {Vec3i(10, 10, 10), Vec3i(13, 10, 13), Vec3i(11, 13, 12)}) {
    const Vec3d expected = geometry.index_from_world(
        about + turn(geometry.world_from_index(Vec3d(voxel)) - about) +
        geometry.world_vector_from_index(Vec3d(1, 0.5, 0) / geometry.spacing_mm()));
    EXPECT_LT((Vec3d(voxel) + moved(*found, voxel) - expected).length(), 4 / kFixedOne) << voxel;
  }
}

TEST_F(PropertyHandlePath, APathThatCannotBeFollowedNamesThePose) {
  Drag left = grabbing({10, 11, 11}, {10, 11, 11},
                       {shifted(1, {0, 0, 0}), shifted(2, {0, 0.5, 0}), shifted(3, {-9, 0.5, 0})});
  Drag right = grabbing({13, 11, 11}, {13, 11, 11}, {shifted(1, {0, 0, 0})});
  auto session = opened();
  Step request;
  request.drags = drags_along_paths({left, right}, session->geometry());
  try {
    session->step(request);
    FAIL() << "handles that tear apart were accepted";
  } catch (const InputError& error) {
    EXPECT_NE(error.problem().field.find("pose 2 of 2"), std::string::npos)
        << error.problem().field;
  }
  const Vec3d before = moved(*session, {10, 11, 11});
  EXPECT_EQ(before, Vec3d(0, 0.5, 0));
  Step further;
  further.release = true;
  further.drags.push_back({kPart, {1, 0, 0}});
  EXPECT_EQ(session->step(further).report.fraction(), 1);
  EXPECT_EQ(moved(*session, {10, 11, 11}) - before, Vec3d(1, 0, 0));
}
