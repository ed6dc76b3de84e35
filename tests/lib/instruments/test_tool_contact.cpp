// Instruments that are led past rigid surfaces.
#include <gtest/gtest.h>

#include "lib/instruments/track.h"
#include "tests/lib/instruments/tool_cases.h"
#include "tests/support/sanitized.h"
#include "volumes/base/units.h"

using namespace supple;
using namespace supple::test;

namespace {

double least_room(const Instrument& tool, const InstrumentPose& pose,
                  const std::vector<Obstacle>& obstacles) {
  double least = HUGE_VAL;
  for (const Obstacle& obstacle : obstacles) {
    for (const RoundCone& part : parts_at(tool, pose)) {
      least = std::min(least, approach(part, obstacle.surface).distance_mm);
    }
  }
  return least;
}

/// Depth of dense balls along the parts in the globe's wall, near its gate left out, and in the
/// solids.
double brute_room(const Instrument& tool, const InstrumentPose& pose,
                  const std::vector<Obstacle>& obstacles) {
  const std::vector<RoundCone> parts = parts_at(tool, pose);
  double least = HUGE_VAL;
  for (const Obstacle& obstacle : obstacles) {
    least =
        std::min(least, brute_distance(parts, 12, [&](const Vec3d& centre) {
                   if (const auto* eye = std::get_if<HollowSphere>(&obstacle.surface)) {
                     const Vec3d from_gate = centre - eye_gate();
                     const bool is_passing = from_gate.dot(pose.axis) > -3;
                     return is_passing ? HUGE_VAL : eye->radius_mm - centre.length();
                   }
                   return approach(RoundCone{centre, centre, 0, 0}, obstacle.surface).distance_mm;
                 }));
  }
  return least;
}

/// Ways of a hand: most of them short, some much too fast.
InstrumentPose next_asked(std::mt19937& random, const InstrumentPose& now, double reach_mm) {
  const double way = random() % 200 == 0 ? 20 : random_number(random, 0, 0.6);
  InstrumentPose asked = now;
  asked.tip_mm += random_direction(random) * way;
  if (asked.tip_mm.length() > reach_mm) asked.tip_mm *= 0.7;
  asked.axis = (now.axis + random_direction(random) * 0.05).normalized();
  asked.roll_degrees += random_number(random, -10, 10);
  asked.opening_degrees = random_number(random, 0, 30);
  return asked;
}

InstrumentPose free_pose(std::mt19937& random, const Instrument& tool,
                         const std::vector<Obstacle>& obstacles) {
  for (;;) {
    const InstrumentPose pose = random_eye_pose(random, 9);
    if (least_room(tool, pose, obstacles) > 0) return pose;
  }
}

InstrumentPose pose_at(const Vec3d& tip, const Vec3d& axis = {0, 0, 1}) {
  InstrumentPose pose;
  pose.tip_mm = tip;
  pose.axis = axis;
  return pose;
}

}  // namespace

TEST(PropertyToolContact, DistanceFromALensIsThatOfItsDensePoints) {
  std::mt19937 random(2);
  const LensShape lens = eye_lens();
  std::vector<Vec3d> dense;
  for (int n = 0; n < 200000; ++n) {
    const SphereShape& cap = n % 2 == 0 ? lens.front : lens.back;
    const SphereShape& other = n % 2 == 0 ? lens.back : lens.front;
    const Vec3d p = cap.centre_mm + random_direction(random) * cap.radius_mm;
    if ((p - other.centre_mm).length() <= other.radius_mm) dense.push_back(p);
  }
  for (int n = 0; n < cases(200); ++n) {
    const Vec3d a = Vec3d(0, 0, 7) + random_point(random, 6);
    const RoundCone cone{a, a + random_point(random, 3), random_number(random, 0.01, 0.4),
                         random_number(random, 0.01, 0.4)};
    const Approach found = approach(cone, lens);
    double brute = HUGE_VAL;
    for (const Vec3d& p : dense) brute = std::min(brute, approach(p, cone).distance_mm);
    if (found.distance_mm > 0) {
      EXPECT_LE(found.distance_mm, brute + 1e-7);
      EXPECT_NEAR(found.distance_mm, brute, 0.1);
    } else {
      EXPECT_LT(brute, 0.1);
    }
  }
}

TEST(PropertyToolContact, DistanceFromAMeshIsThatOfDenseBalls) {
  std::mt19937 random(8);
  const MeshShape mesh = mesh_of(plate({0, 0, 0}, {1, 2, 0.05}));
  for (int n = 0; n < cases(400); ++n) {
    const Vec3d a = random_point(random, 2);
    const RoundCone cone{a, a + random_point(random, 2), random_number(random, 0.02, 0.3),
                         random_number(random, 0.02, 0.3)};
    const double found = approach(cone, mesh).distance_mm;
    const double brute = brute_distance({cone}, 300, [&](const Vec3d& centre) {
      return mesh.surface->distance_to(centre).distance_mm;
    });
    if (std::abs(brute) < 0.02) {
      EXPECT_NEAR(found, brute, 1.5e-3);
    }
    EXPECT_NEAR(found, brute, 0.02 * std::abs(brute) + 0.02);
  }
}

TEST(PropertyToolContact, NoInstrumentEntersGlobeOrLensInRandomMotions) {
  std::mt19937 random(11);
  const std::vector<Obstacle> eye = {globe(), {"lens", eye_lens()}};
  const Vec3d gate = eye_gate();
  double deepest = 0, deepest_ball = 0, off_pivot = 0;
  int touches = 0;
  for (const InstrumentKind kind : kInstrumentKinds) {
    const Instrument tool = instrument_of(kind);
    InstrumentPose pose = free_pose(random, tool, eye);
    for (int n = 0; n < cases(8500); ++n) {
      const InstrumentPose asked = next_asked(random, pose, 12);
      const StoppedTool stopped = lead(tool, pose, asked, eye, &gate);
      pose = stopped.pose;
      touches += stopped.touches.empty() ? 0 : 1;
      deepest = std::min(deepest, least_room(tool, pose, eye));
      if (n % 16 == 0) deepest_ball = std::min(deepest_ball, brute_room(tool, pose, eye));
      off_pivot = std::max(off_pivot, (gate - pose.tip_mm).cross(pose.axis).length());
    }
  }
  EXPECT_GE(deepest, -1e-6);
  EXPECT_GE(deepest_ball, -1e-6);
  EXPECT_LT(off_pivot, 1e-9);
  EXPECT_GT(touches, cases(2000));
}

/// Leads every kind of instrument along random motions and expects it outside of what is solid.
/// Returns the number of motions that ended at it.
int touches_of_motions(std::mt19937& random, const std::vector<Obstacle>& solids, int motions,
                       double spread_mm) {
  double deepest = 0;
  int touches = 0;
  for (const InstrumentKind kind : kInstrumentKinds) {
    const Instrument tool = instrument_of(kind);
    InstrumentPose pose = free_pose(random, tool, solids);
    for (int n = 0; n < motions; ++n) {
      const StoppedTool stopped = lead(tool, pose, next_asked(random, pose, spread_mm), solids);
      pose = stopped.pose;
      touches += stopped.touches.empty() ? 0 : 1;
      deepest = std::min(deepest, least_room(tool, pose, solids));
      if (n % 16 == 0) deepest = std::min(deepest, brute_room(tool, pose, solids));
    }
  }
  EXPECT_GE(deepest, -1e-6);
  return touches;
}

TEST(PropertyToolContact, NoInstrumentEntersBallsAndPlanesInRandomMotions) {
  std::mt19937 random(12);
  const std::vector<Obstacle> solids = {{"ball", SphereShape{{0, 0, -3}, 2}},
                                        {"lens", eye_lens()},
                                        {"floor", PlaneShape{{0, 0, -6}, {0, 0, 1}}}};
  EXPECT_GT(touches_of_motions(random, solids, cases(8500), 8), cases(1000));
}

TEST(PropertyToolContact, NoInstrumentEntersAMeshInRandomMotions) {
  std::mt19937 random(14);
  const std::vector<Obstacle> block = {{"block", mesh_of(plate({0, 0, -2}, {3, 2.5, 1}))}};
  EXPECT_GT(touches_of_motions(random, block, cases(500), 3.5), cases(200));
}

TEST(PropertyToolContact, NothingTunnelsThroughAThinPlateAtTenTimesTheSpeed) {
  std::mt19937 random(13);
  const std::vector<Obstacle> wall = {{"plate", mesh_of(plate({0, 0, 0}, {40, 40, 0.01}))}};
  for (const InstrumentKind kind : kInstrumentKinds) {
    const Instrument tool = instrument_of(kind);
    for (int n = 0; n < cases(20); ++n) {
      const InstrumentPose from = pose_at({0, 0, random_number(random, 0.5, 10)});
      InstrumentPose asked = from;
      asked.tip_mm += Vec3d(random_number(random, -2, 2), random_number(random, -2, 2), -20);
      const StoppedTool stopped = lead(tool, from, asked, wall);
      EXPECT_NEAR(stopped.pose.tip_mm.z, 0.01, 2e-3);
      ASSERT_EQ(stopped.touches.size(), 1u);
      EXPECT_NEAR(stopped.touches[0].asked_mm, 0.01 - asked.tip_mm.z, 0.01);
      EXPECT_NEAR(stopped.touches[0].force_n,
                  stopped.touches[0].asked_mm * kMPerMm * tool.stiffness_n_m, 1e-12);
      EXPECT_GT(stopped.touches[0].normal.z, 0.999);
    }
  }
}

TEST(PropertyToolContact, NothingPassesAThinBladeThatItIsBesideBeforeAndAfter) {
  const std::vector<Obstacle> blade = {{"blade", mesh_of(plate({0, 0, 0}, {0.01, 5, 3}))}};
  for (const InstrumentKind kind : kInstrumentKinds) {
    const StoppedTool stopped =
        lead(instrument_of(kind), pose_at({-3, 0, -1}), pose_at({17, 0, -1}), blade);
    EXPECT_LT(stopped.pose.tip_mm.x, 0);
    EXPECT_GT(stopped.pose.tip_mm.x, -1);
    ASSERT_EQ(stopped.touches.size(), 1u);
    EXPECT_GT(stopped.touches[0].asked_mm, 16.9);
    EXPECT_LT(stopped.touches[0].normal.x, -0.99);
  }
}

TEST(UnitToolContact, ATipThatIsLedIntoTheRetinaStopsThereAndTellsPlaceAndForce) {
  const Instrument tool = instrument_of(InstrumentKind::vitrector);
  const std::vector<Obstacle> eye = {globe()};
  const Vec3d gate = eye_gate();
  const InstrumentPose from = through_pivot(pose_at({0, 0, 0}), gate);
  for (const double way : {12.0, 120.0}) {  // and at ten times the speed
    InstrumentPose asked = from;
    asked.tip_mm = from.axis * -way;
    const StoppedTool stopped = lead(tool, from, asked, eye, &gate);
    EXPECT_NEAR(stopped.pose.tip_mm.length(), 11, 1e-4);
    ASSERT_EQ(stopped.touches.size(), 1u);
    const ToolTouch& touch = stopped.touches[0];
    EXPECT_NEAR((touch.place_mm - from.axis * -11.0).length(), 0, 1e-3);
    EXPECT_NEAR(touch.asked_mm, way - 11, 1e-6);
    EXPECT_NEAR(touch.force_n, 100 * (way - 11) * 1e-3, 1e-6);
    EXPECT_NEAR(touch.normal.dot(from.axis), 1, 1e-6);
  }
}

TEST(UnitToolContact, ATipThatIsPressedAndLedAlongAFloorSlidesAsFarAsTheHandGoes) {
  const Instrument tool = instrument_of(InstrumentKind::needle);
  const std::vector<Obstacle> floor = {{"floor", PlaneShape{{0, 0, 0}, {0, 0, 1}}}};
  InstrumentPose pose = pose_at({0, 0, 1});
  for (int n = 1; n <= 20; ++n) {
    const InstrumentPose asked = pose_at({0.2 * n, 0.1 * n, -0.5});
    const StoppedTool stopped = lead(tool, pose, asked, floor);
    pose = stopped.pose;
    EXPECT_NEAR(pose.tip_mm.x, asked.tip_mm.x, 2e-3);
    EXPECT_NEAR(pose.tip_mm.y, asked.tip_mm.y, 2e-3);
    EXPECT_NEAR(pose.tip_mm.z, 0, 1e-4);
    ASSERT_EQ(stopped.touches.size(), 1u);
    if (n > 1) {
      EXPECT_NEAR(stopped.touches[0].along_mm, std::hypot(0.2, 0.1), 5e-3);
    }
  }
}

TEST(UnitToolContact, ATipThatIsPressedAlongTheRetinaFollowsItsCurve) {
  const Instrument tool = instrument_of(InstrumentKind::vitrector);
  const std::vector<Obstacle> eye = {globe()};
  const Vec3d gate = eye_gate();
  InstrumentPose pose = through_pivot(pose_at({-6, 0, -6}), gate);
  for (int n = 0; n <= 40; ++n) {
    const double angle = (225 + n) * kRadiansPerDegree;
    const Vec3d out(std::cos(angle), 0, std::sin(angle));
    const StoppedTool stopped = lead(tool, pose, pose_at(out * 11.3, pose.axis), eye, &gate);
    pose = stopped.pose;
    EXPECT_FALSE(stopped.touches.empty());
    EXPECT_LT(pose.tip_mm.cross(out).length(), 0.25);  // the shaft is as thick as that
    EXPECT_GT(pose.tip_mm.length(), 10.5);
  }
}

TEST(PropertyToolContact, AnInstrumentThatBeginsInsideMayLeaveButNotGoDeeper) {
  const Instrument tool = instrument_of(InstrumentKind::needle);
  const std::vector<Obstacle> floor = {{"floor", PlaneShape{{0, 0, 0}, {0, 0, 1}}}};
  const InstrumentPose inside = pose_at({0, 0, -0.3});
  EXPECT_GE(lead(tool, inside, pose_at({0, 0, -2}), floor).pose.tip_mm.z, -0.3 - 1e-6);
  EXPECT_EQ(lead(tool, inside, pose_at({0, 0, 2}), floor).pose.tip_mm.z, 2);
}

TEST(UnitToolContact, AFreeMotionEndsAtTheAskedPoseToTheBit) {
  std::mt19937 random(21);
  const Instrument tool = instrument_of(InstrumentKind::forceps);
  for (int n = 0; n < 100; ++n) {
    InstrumentPose asked = random_eye_pose(random, 4);
    asked.active = 0.5;
    const Vec3d gate = eye_gate();
    asked = through_pivot(asked, gate);
    const StoppedTool stopped = lead(tool, random_eye_pose(random, 4), asked, {globe()}, &gate);
    EXPECT_TRUE(stopped.touches.empty());
    EXPECT_EQ(stopped.pose.tip_mm, asked.tip_mm);
    EXPECT_EQ(stopped.pose.axis, asked.axis);
    EXPECT_EQ(stopped.pose.roll_degrees, asked.roll_degrees);
    EXPECT_EQ(stopped.pose.active, 0.5);
  }
}
