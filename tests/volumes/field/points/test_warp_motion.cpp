// Points through dense warps, along their vectors and against them (point_motion.h).
#include <gtest/gtest.h>

#include "tests/support/random_state.h"
#include "tests/volumes/field/offset_fixtures.h"
#include "volumes/field/points/point_motion.h"

using namespace supple;
using namespace supple::test;

namespace {

using Direction = std::optional<WarpDirection>;

const Geometry kGrid{{12, 10, 9}, {-4, 6, 2}, {Vec3d(0, 2, 0), {-1.5, 0, 0.25}, {0, 0, 3}}};

/// A swirl around the middle of a box of 2 x 1.5 x 3 mm voxels.
Vec3d swirl(const Vec3d& p) {
  const Vec3d d = p - kGrid.world_from_index({5.5, 4.5, 4});
  const double fade = 1.6 * std::exp(-d.length2() / 60);
  return {-fade * d.y, fade * d.x, 0.4 * fade * d.z};
}

}  // namespace

TEST(UnitWarpMotion, OnlyAResampleWarpRunsAgainstItsVectorsOnTheWayForward) {
  const auto shift = [](const Vec3d&) { return Vec3d(1.5, -2, 0.5); };
  const Vec3d place = kGrid.world_from_index({6, 5, 4});
  for (const Direction& direction :
       {Direction(WarpDirection::resample), Direction(), Direction(WarpDirection::material)}) {
    const Warp warp = warp_of(kGrid, direction, shift);
    const double sign = direction == WarpDirection::material ? 1 : -1;
    const Vec3d by = Vec3d(1.5, -2, 0.5) * sign;
    const MovedPoint forward = motion_through(warp, false)->move(place);
    const MovedPoint back = motion_through(warp, true)->move(place);
    EXPECT_LT((forward.to_lps_mm - place - by).length(), 1e-6);
    EXPECT_LT((back.to_lps_mm - place + by).length(), 1e-6);
    EXPECT_EQ(forward.kind, PlaceKind::inside);
    EXPECT_EQ(back.kind, PlaceKind::inside);
  }
}

TEST(PropertyWarpMotion, AgainstTheVectorsUndoesAlongTheVectors) {
  const Warp warp = warp_of(kGrid, WarpDirection::material, swirl);
  const auto along = motion_through(warp, false), against = motion_through(warp, true);
  std::mt19937 random(4);
  std::uniform_real_distribution<double> part(0, 1);
  double worst = 0, longest = 0;
  int folded = 0;
  for (int n = 0; n < 2000; ++n) {
    const Vec3d index(11 * part(random), 9 * part(random), 8 * part(random));
    const Vec3d X = kGrid.world_from_index(index);
    const MovedPoint there = along->move(X), back = against->move(there.to_lps_mm);
    longest = std::max(longest, (there.to_lps_mm - X).length());
    if (there.kind == PlaceKind::folded || back.kind == PlaceKind::folded) {
      ++folded;
      continue;
    }
    ASSERT_EQ(back.kind, PlaceKind::inside) << index;
    worst = std::max(worst, kGrid.index_vector_from_world(back.to_lps_mm - X).length());
  }
  EXPECT_LT(worst, 1e-3);
  EXPECT_GT(longest, 5) << "a warp worth the test";
  EXPECT_LT(folded, 600);
}

TEST(PropertyWarpMotion, GradientsAreThoseOfFiniteDifferences) {
  const Warp warp =
      warp_of(kGrid, WarpDirection::resample, [](const Vec3d& p) { return swirl(p) * 0.4; });
  for (const bool back : {false, true}) {
    const auto motion = motion_through(warp, back);
    const Vec3d place = kGrid.world_from_index({5.3, 4.4, 4.6});
    const MovedPoint moved = motion->move(place);
    for (int a = 0; a < 3; ++a) {
      Vec3d step(0);
      step[a] = 0.01;
      const Vec3d difference =
          (motion->move(place + step).to_lps_mm - motion->move(place - step).to_lps_mm) / 0.02;
      EXPECT_LT((difference - moved.gradient[a]).length(), 1e-3) << back << a;
    }
  }
}

TEST(UnitWarpMotion, PointsBeyondTheGridStayAndAreNamed) {
  const Warp warp =
      warp_of(kGrid, WarpDirection::material, [](const Vec3d&) { return Vec3d(1, 0, 0); });
  const Vec3d beyond = kGrid.world_from_index({11.51, 4, 4}),
              last = kGrid.world_from_index({11, 9, 8});
  EXPECT_EQ(motion_through(warp, false)->move(beyond).kind, PlaceKind::outside);
  EXPECT_EQ(motion_through(warp, false)->move(beyond).to_lps_mm, beyond);
  EXPECT_EQ(motion_through(warp, false)->move(last).kind, PlaceKind::inside);
  const Vec3d border = kGrid.world_from_index({11.49, -0.49, 4});
  EXPECT_EQ(motion_through(warp, false)->move(border).kind, PlaceKind::inside) << "as in ITK";
  EXPECT_LT((motion_through(warp, true)->move(border + Vec3d(1, 0, 0)).to_lps_mm - border).length(),
            1e-5);
  EXPECT_EQ(motion_through(warp, true)->move(last + Vec3d(1, 0, 0)).kind, PlaceKind::inside);
  EXPECT_EQ(motion_through(warp, true)->move(beyond + Vec3d(50, 0, 0)).kind, PlaceKind::outside);
  const Vec3d far(1e300, 0, 0);
  EXPECT_EQ(motion_through(warp, true)->move(far).kind, PlaceKind::outside);
}

TEST(PropertyWarpMotion, NoFalsePlaceComesOutOfAFold) {
  const Warp warp = warp_of(unit_geometry({20, 6, 6}), WarpDirection::material,
                            [](const Vec3d& p) { return Vec3d(p.x < 9.5 ? 0 : -4, 0, 0); });
  const auto along = motion_through(warp, false), against = motion_through(warp, true);
  EXPECT_EQ(along->move({9.5, 2, 2}).kind, PlaceKind::folded);
  for (double x = 0.1; x < 15; x += 0.37) {
    const MovedPoint back = against->move({x, 2.5, 2.5});
    ASSERT_NE(back.kind, PlaceKind::unresolved) << x;
    EXPECT_LT((along->move(back.to_lps_mm).to_lps_mm - Vec3d(x, 2.5, 2.5)).length(), 1e-4) << x;
    EXPECT_EQ(back.kind == PlaceKind::folded, x >= 6 && x < 10) << x;
    if (x < 9) {
      EXPECT_LT((back.to_lps_mm - Vec3d(x, 2.5, 2.5)).length(), 1e-4) << "the shortest";
    }
  }
}

TEST(FaultWarpMotion, VectorsThatLeadNowhereAreRefused) {
  const auto jump = [](double by) {
    return warp_of(unit_geometry({4, 4, 4}), WarpDirection::resample,
                   [by](const Vec3d& p) { return Vec3d(1, 1, 1) * (p.x < 2 ? by : -by); });
  };
  EXPECT_THROW(motion_through(jump(1e30), false), InputError);
  EXPECT_THROW(motion_through(jump(9e5), false), InputError);
  const Warp far = warp_of(unit_geometry({4, 4, 4}), WarpDirection::resample,
                           [](const Vec3d&) { return Vec3d(1e30, 0, 0); });
  EXPECT_THROW(motion_through(far, false), InputError);
  EXPECT_EQ(motion_through(jump(9e5), true)->move({1, 1, 1}).to_lps_mm.x, 900001);
  EXPECT_NO_THROW(motion_through(jump(10), false)->move({1, 1, 1}));
}

TEST(UnitWarpMotion, AWarpOfOneSliceMovesWhatLiesInIt) {
  const Warp warp = warp_of(unit_geometry({8, 8, 1}), WarpDirection::material,
                            [](const Vec3d&) { return Vec3d(1.25, 0.5, 0); });
  EXPECT_EQ(motion_through(warp, false)->move({3, 3, 0.25}).to_lps_mm, Vec3d(4.25, 3.5, 0.25));
  EXPECT_EQ(motion_through(warp, false)->move({3, 3, 0.75}).kind, PlaceKind::outside);
  EXPECT_LT((motion_through(warp, true)->move({4.25, 3.5, 0}).to_lps_mm - Vec3d(3, 3, 0)).length(),
            1e-6);
}
