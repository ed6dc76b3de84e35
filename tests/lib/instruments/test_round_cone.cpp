// Points near round cones.
#include <gtest/gtest.h>

#include "tests/lib/instruments/tool_cases.h"
#include "tests/support/sanitized.h"

using namespace supple;
using namespace supple::test;

namespace {

RoundCone random_cone(std::mt19937& random) {
  return {random_point(random, 2), random_point(random, 2), random_number(random, 0.01, 0.5),
          random_number(random, 0.01, 0.5)};
}

}  // namespace

TEST(UnitRoundCone, DistancesFromACapsuleAndFromABallAreThoseOfTheHand) {
  const RoundCone capsule{{0, 0, 0}, {0, 0, 4}, 1, 1};
  EXPECT_NEAR(approach({3, 0, 2}, capsule).distance_mm, 2, 1e-12);
  EXPECT_NEAR(approach({0, 0, -3}, capsule).distance_mm, 2, 1e-12);
  EXPECT_NEAR(approach({0.25, 0, 1}, capsule).distance_mm, -0.75, 1e-12);
  EXPECT_NEAR(approach({3, 0, 2}, capsule).normal.x, 1, 1e-12);
  EXPECT_NEAR(approach({3, 0, 2}, capsule).place_mm.x, 1, 1e-12);
  const RoundCone ball{{1, 0, 0}, {1.5, 0, 0}, 2, 0.1};  // the first ball holds the second
  EXPECT_NEAR(approach({6, 0, 0}, ball).distance_mm, 3, 1e-12);
  // On the axis of a needle no direction is nearer than another.
  EXPECT_NEAR(approach({0, 0, 2}, capsule).normal.length(), 1, 1e-12);
}

TEST(PropertyRoundCone, DistanceOfAPointIsThatOfTheNearestOfDenseBalls) {
  std::mt19937 random(5);
  for (int n = 0; n < cases(2000); ++n) {
    const RoundCone cone = random_cone(random);
    const Vec3d point = random_point(random, 3);
    const Approach found = approach(point, cone);
    const double brute = brute_distance(
        {cone}, 2000, [&](const Vec3d& centre) { return (point - centre).length(); });
    EXPECT_LE(found.distance_mm, brute + 1e-12);
    EXPECT_NEAR(found.distance_mm, brute, 1e-3);
    EXPECT_NEAR((point - found.place_mm).dot(found.normal), found.distance_mm, 1e-12);
  }
}

TEST(PropertyRoundCone, FirstTouchIsThatOfDenseTimes) {
  std::mt19937 random(6);
  constexpr int kTimes = 1000;
  int touched = 0;
  for (int n = 0; n < cases(2000); ++n) {
    const RoundCone from = random_cone(random), to = random_cone(random);
    const Vec3d start = random_point(random, 3), end = random_point(random, 3);
    const auto room = [&](double part) {
      return approach(start + (end - start) * part, between(from, to, part)).distance_mm;
    };
    if (room(0) < 1e-3) continue;
    const std::optional<double> found = first_touch(start, end, from, to);
    touched += found ? 1 : 0;
    if (found) {
      EXPECT_NEAR(room(*found), 0, 1.01e-4);
    }
    for (int t = 0; t <= kTimes; ++t) {
      const double part = double(t) / kTimes;
      if (found && part > *found) break;
      EXPECT_GT(room(part), 0);
    }
  }
  EXPECT_GT(touched, cases(80));
}
