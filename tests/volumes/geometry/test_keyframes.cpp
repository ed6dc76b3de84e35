// Values between keyframes, turns as quaternions and paths of poses.
#include <cmath>

#include <gtest/gtest.h>

#include "volumes/geometry/pose_path.h"

namespace supple {
namespace {

double distance(const Vec3d& a, const Vec3d& b) {
  return (a - b).length();
}

TEST(UnitKeyframes, EveryEasingMeetsItsKeysAndStaysBeyondThem) {
  for (const Easing easing : {Easing::smooth, Easing::linear, Easing::spline, Easing::hold}) {
    Track<double> track;
    track.add(1, 5, easing);
    track.add(2, 7, easing);
    track.add(4, 6, easing);
    EXPECT_EQ(track.at(-3), 5);
    EXPECT_EQ(track.at(1), 5);
    EXPECT_NEAR(track.at(2), 7, 1e-14);
    EXPECT_EQ(track.at(4), 6);
    EXPECT_EQ(track.at(9), 6);
  }
}

TEST(UnitKeyframes, EasingsBetweenTwoKeysAreTheirFormulas) {
  const auto at_quarter = [](Easing easing) {
    Track<double> track;
    track.add(0, 10, easing);
    track.add(4, 20, Easing::linear);
    return track.at(1);
  };
  EXPECT_EQ(at_quarter(Easing::linear), 12.5);
  EXPECT_EQ(at_quarter(Easing::hold), 10);
  EXPECT_DOUBLE_EQ(at_quarter(Easing::smooth), 10 + 10 * (3 * 0.0625 - 2 * 0.015625));
  EXPECT_DOUBLE_EQ(at_quarter(Easing::spline), 12.5);  // straight on beyond both ends
}

/// Hermite's cubic with the tangents of Catmull and Rom over unequal times.
TEST(UnitKeyframes, ASplineIsThatOfCatmullAndRom) {
  const double t[] = {0, 1, 3, 4}, p[] = {2, -1, 5, 4};
  Track<double> track;
  for (int n = 0; n < 4; ++n) track.add(t[n], p[n], Easing::spline);
  const auto slope = [&](int a, int b) { return (p[b] - p[a]) / (t[b] - t[a]); };
  const auto tangent = [&](int n) {
    const double before = t[n] - t[n - 1], after = t[n + 1] - t[n];
    return (after * slope(n - 1, n) + before * slope(n, n + 1)) / (before + after);
  };
  for (double time = 1; time <= 3; time += 0.125) {
    const double s = (time - 1) / 2, h = 2;
    const double expected =
        (2 * s * s * s - 3 * s * s + 1) * p[1] + (s * s * s - 2 * s * s + s) * h * tangent(1) +
        (3 * s * s - 2 * s * s * s) * p[2] + (s * s * s - s * s) * h * tangent(2);
    EXPECT_NEAR(track.at(time), expected, 1e-12) << time;
  }
}

TEST(UnitTurn, ATurnIsThatOfItsAxisAndAngle) {
  EXPECT_LT(distance(turn_about({0, 0, 2}, 90)({1, 0, 0}), {0, 1, 0}), 1e-15);
  EXPECT_LT(distance(turn_about({1, 1, 1}, 120)({1, 2, 3}), {3, 1, 2}), 1e-14);
  const Turn both = turn_about({1, 0, 0}, 90) * turn_about({0, 0, 1}, 90);
  EXPECT_LT(distance(both({1, 0, 0}), {0, 0, 1}), 1e-15);
  EXPECT_NEAR(turn_about({0, 3, 4}, -40).angle_deg(), 40, 1e-12);
  EXPECT_LT(distance(turn_about({0, 3, 4}, -40).axis(), {0, -0.6, -0.8}), 1e-14);
}

TEST(UnitTurn, AxesGiveTheirTurnBack) {
  const Vec3d around[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, -2, 0.5}};
  for (const Vec3d& axis : around) {
    for (double angle = -180; angle <= 180; angle += 15) {
      const Turn turn = turn_about(axis, angle);
      const std::array<Vec3d, 3> axes = {turn({1, 0, 0}), turn({0, 1, 0}), turn({0, 0, 1})};
      EXPECT_LT(distance(turn_to(axes)({1, 2, 3}), turn({1, 2, 3})), 1e-12) << axis << angle;
    }
  }
}

TEST(UnitTurn, BetweenTwoTurnsTheAngleGrowsEvenly) {
  const Turn from = turn_about({0, 0, 1}, 20);
  const Turn to = turn_about({1, 2, 0}, 70) * from;
  for (const double s : {-0.5, 0.0, 0.25, 0.5, 1.0, 1.5}) {
    const Turn expected = turn_about({1, 2, 0}, 70 * s) * from;
    EXPECT_LT(distance(between(from, to, s)({3, 1, 2}), expected({3, 1, 2})), 1e-13) << s;
  }
  // The shorter way round.
  const Turn short_way = between(turn_about({0, 0, 1}, 170), turn_about({0, 0, 1}, -170), 0.5);
  EXPECT_LT(distance(short_way({1, 0, 0}), {-1, 0, 0}), 1e-14);
}

TEST(UnitPosePath, TurnsAboutOneAxisGoRoundMoreThanOnce) {
  PosePath path;
  path.add_turn(0, {0, 0, 1}, 0, Easing::linear);
  path.add_turn(2, {0, 0, -5}, -720, Easing::linear);
  EXPECT_DOUBLE_EQ(path.at(0.5).angle_deg, 180);
  EXPECT_DOUBLE_EQ(path.at(1.75).angle_deg, 630);
  EXPECT_EQ(path.at(1).axis, Vec3d(0, 0, 1));
}

TEST(UnitPosePath, TurnsAboutSeveralAxesTakeTheShortestArc) {
  PosePath path;
  path.add_turn(0, {0, 0, 1}, 90, Easing::linear);
  path.add_turn(1, {1, 0, 0}, 90, Easing::linear);
  const Turn expected = between(turn_about({0, 0, 1}, 90), turn_about({1, 0, 0}, 90), 0.3);
  const PathPose pose = path.at(0.3);
  EXPECT_LT(distance(turn_about(pose.axis, pose.angle_deg)({1, 2, 3}), expected({1, 2, 3})), 1e-13);
}

TEST(UnitPosePath, ShiftTurnAndScaleHaveKeysOfTheirOwn) {
  PosePath path;
  path.add_shift(0, {0, 0, 0}, Easing::linear);
  path.add_scale(1, Vec3d(2), Easing::linear);
  path.add_shift(4, {8, 0, 0}, Easing::linear);
  const PathPose pose = path.at(1.5);
  EXPECT_EQ(pose.shift_mm, Vec3d(3, 0, 0));
  EXPECT_EQ(pose.scale, Vec3d(2));
  EXPECT_EQ(pose.angle_deg, 0);
}

}  // namespace
}  // namespace supple
