// Directions that a hand's target lacks, by the span that they are to have.
#include <random>

#include <gtest/gtest.h>

#include "lib/session/hand/hand_span.h"
#include "volumes/geometry/geometry.h"

using namespace supple;

namespace {

const Geometry kSpanGrid({9, 9, 9}, {1, 2, 3},
                         {Vec3d(0.5, 0, 0), Vec3d(0, 0.5, 0), Vec3d(0, 0, 1.25)});
const std::vector<HandDirection> kViewPlane = {{{10, 0, 0}}, {{0, 0, 10}}};

DragPose turn_of(const Vec3d& axis_lps, double angle_deg, const Vec3d& by_mm = Vec3d(0)) {
  DragPose pose{by_mm, {}};
  pose.motion.axis_lps = axis_lps;
  pose.motion.angle_deg = angle_deg;
  return pose;
}

std::vector<HandDirection> lacking(const DragPose& target,
                                   const std::vector<HandDirection>& directions) {
  return lacking_directions(target, directions, kSpanGrid);
}

}  // namespace

TEST(UnitHandSpan, AShiftLacksWhatIsAcrossAndNothingThatIsRounding) {
  EXPECT_TRUE(lacking({{3, 0, -7}, {}}, kViewPlane).empty());
  EXPECT_TRUE(lacking({{3, 0.0005, -7}, {}}, kViewPlane).empty());
  const auto across = lacking({{3, -0.5, -7}, {}}, kViewPlane);
  ASSERT_EQ(across.size(), 1u);
  EXPECT_EQ(across[0].way, Vec3d(0, -10, 0));
  EXPECT_EQ(across[0].turn_deg, 0);
}

TEST(UnitHandSpan, OneAxisLacksTwoTurnsAnotherOneAllLinearMaps) {
  std::vector<HandDirection> directions = kViewPlane;
  const auto take = [&](const DragPose& target) {
    const auto more = lacking(target, directions);
    directions.insert(directions.end(), more.begin(), more.end());
    return more.size();
  };
  EXPECT_EQ(take(turn_of({1, 2, -2}, 7)), 2u);
  EXPECT_EQ(take(turn_of({-1, -2, 2}, 200)), 0u);
  EXPECT_EQ(take(turn_of({1.0, 2.00000001, -2}, 50)), 0u);
  EXPECT_EQ(take(turn_of({0, 1, 0}, 3, {0, 1, 0})), 8u);
  EXPECT_EQ(directions.size(), kMostDirections);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(-1, 1);
  for (int n = 0; n < 100; ++n) {
    const Vec3d axis(any(random), any(random), any(random));
    EXPECT_EQ(take(turn_of(axis, 180 * any(random), axis * 20)), 0u) << axis;
  }
  // No more than a scene may have.
  directions = std::vector<HandDirection>(kMostDirections - 1, {{10, 0, 0}});
  EXPECT_EQ(take(turn_of({0, 1, 0}, 3, {0, 1, 0})), 1u);
}
