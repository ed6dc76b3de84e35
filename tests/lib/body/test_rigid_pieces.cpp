// Rigid motions, poses and parts of pieces, without a session.
#include <cmath>

#include <gtest/gtest.h>

#include "lib/body/rigid_links.h"
#include "lib/body/rigid_pieces.h"
#include "tests/lib/test_bodies.h"
#include "volumes/base/text.h"

using namespace supple;
using namespace supple::test;

namespace {

Vec3d random_vector(std::mt19937& random, double reach) {
  return {pick(random, -reach, reach), pick(random, -reach, reach), pick(random, -reach, reach)};
}

RigidMotion random_motion(std::mt19937& random) {
  RigidMotion motion;
  motion.turn = turn_about(random_vector(random, 1), pick(random, -179, 179));
  motion.about_lps_mm = random_vector(random, 100);
  motion.shift_lps_mm = random_vector(random, 50);
  return motion;
}

/// Turns by the formula of Rodrigues, as a matrix would.
Vec3d turned(const Vec3d& v, const Vec3d& axis, double angle_deg) {
  const Vec3d n = axis.normalized();
  const double angle = angle_deg * 3.14159265358979323846 / 180;
  return v * std::cos(angle) + n.cross(v) * std::sin(angle) +
         n * (n.dot(v) * (1 - std::cos(angle)));
}

RigidPiece piece_of_all(const Body& body) {
  RigidPiece piece;
  std::vector<Slot> slots;
  for_each_element(body.elements, [&](Slot slot) {
    slots.push_back(slot);
    piece.centre_index += Vec3d(voxel_of(body.elements, slot));
  });
  piece.centre_index /= double(slots.size());
  piece.elements = std::make_shared<SlotSet>(std::move(slots));
  return piece;
}

const Geometry kOblique({40, 40, 40}, {3, -7, 11},
                        {Vec3d(0.8, 0.2, 0), Vec3d(-0.3, 1.1, 0.1), Vec3d(0, -0.2, 1.5)});

}  // namespace

TEST(UnitRigid, AMotionTurnsRightHandedAboutItsPointThenShifts) {
  RigidMotion motion;
  motion.turn = turn_about({0, 0, 2}, 90);
  motion.about_lps_mm = {1, 0, 0};
  motion.shift_lps_mm = {0, 0, 5};
  const Vec3d to = motion({3, 0, 0});
  EXPECT_NEAR((to - Vec3d(1, 2, 5)).length(), 0, 1e-12);
  std::mt19937 random(5);
  for (int n = 0; n < 100; ++n) {
    const Vec3d axis = random_vector(random, 1), v = random_vector(random, 30);
    const double angle = pick(random, -179, 179);
    RigidMotion turn;
    turn.turn = turn_about(axis, angle);
    EXPECT_NEAR((turn(v) - turned(v, axis, angle)).length(), 0, 1e-12);
    RigidMotion all = turn;
    all.about_lps_mm = random_vector(random, 20);
    all.shift_lps_mm = random_vector(random, 20);
    const Vec3d about = all.about_lps_mm;
    EXPECT_NEAR((all(v) - about - turned(v - about, axis, angle) - all.shift_lps_mm).length(), 0,
                1e-12);
    EXPECT_NEAR((turn.part(0.3)(v) - turned(v, axis, 0.3 * angle)).length(), 0, 1e-12);
  }
}

TEST(UnitRigid, TheFitOfMovedPointsIsTheirMotion) {
  std::mt19937 random(6);
  for (int n = 0; n < 200; ++n) {
    const RigidMotion motion = random_motion(random);
    RigidFit fit;
    std::vector<Vec3d> points;
    for (int p = 0; p < 3 + n % 5; ++p) points.push_back(random_vector(random, 80));
    for (const Vec3d& point : points) fit.add(point, motion(point));
    const RigidMotion found = fit.motion();
    for (const Vec3d& point : points) {
      EXPECT_NEAR((found(point) - motion(point)).length(), 0, 1e-9) << n;
    }
  }
}

TEST(UnitRigid, PointsThatLeaveATurnOpenGiveTheSmallestOne) {
  RigidFit single, row, turned_row;
  single.add({1, 2, 3}, {4, 2, 3});
  EXPECT_FALSE(single.motion().turns());
  EXPECT_NEAR((single.motion()({9, 9, 9}) - Vec3d(12, 9, 9)).length(), 0, 1e-12);
  for (int n = 0; n < 5; ++n) {
    row.add(Vec3d(n, 0, 0), Vec3d(n, 1, 0));
    turned_row.add(Vec3d(n, 0, 0), Vec3d(0, n, 0));
  }
  EXPECT_NEAR((row.motion()({0, 0, 7}) - Vec3d(0, 1, 7)).length(), 0, 1e-9);
  // A quarter about z, and none about the row itself.
  EXPECT_NEAR((turned_row.motion()({0, 0, 7}) - Vec3d(0, 0, 7)).length(), 0, 1e-9);
}

TEST(PropertyRigid, PointsOfALineTurnByTheAngleBetweenTheLines) {
  std::mt19937 random(10);
  for (int n = 0; n < 100; ++n) {
    const RigidMotion motion = random_motion(random);
    const Vec3d along = random_vector(random, 1).normalized(), at = random_vector(random, 50);
    RigidFit fit;
    for (int p = 0; p < 4; ++p) fit.add(at + along * p, motion(at + along * p));
    const Vec3d to = (motion(at + along) - motion(at)).normalized();
    const double angle = std::acos(std::clamp(along.dot(to), -1.0, 1.0));
    EXPECT_NEAR(fit.motion().turn.angle_deg(), angle * 180 / 3.14159265358979323846, 1e-3) << n;
  }
}

TEST(PropertyRigid, ThousandMovesLeaveEveryElementWithinRoundingOfARigidPose) {
  std::mt19937 random(7);
  Body body = body_of(homogeneous({9, 8, 7}, 1.2, 0.8, 0.3));
  body.geometry = kOblique;
  RigidPiece piece = piece_of_all(body);
  std::vector<Vec3i> voxels;
  piece.elements->for_each([&](Slot slot) { voxels.push_back(voxel_of(body.elements, slot)); });
  for (int n = 0; n < 1000; ++n) {
    RigidMotion motion = random_motion(random);
    motion.shift_lps_mm = motion.shift_lps_mm * 0.01;
    piece.pose = moved_by(motion, piece, kOblique);
    for (int c = 0; c < 3; ++c) piece.pose.shift_q[std::size_t(c)] %= 1 << 26;
  }
  const PoseOffsets offsets(kOblique, piece);
  const auto place = [&](const Vec3i& voxel) {
    Vec3d at(voxel);
    const auto q = offsets(voxel);
    for (int c = 0; c < 3; ++c) at[c] += double(q[std::size_t(c)]) / kVoxel;
    return kOblique.world_from_index(at);
  };
  double worst = 0;
  for (const Vec3i& a : voxels) {
    const Vec3i& b = voxels.front();
    const double now = (place(a) - place(b)).length();
    const double rest =
        (kOblique.world_from_index(Vec3d(a)) - kOblique.world_from_index(Vec3d(b))).length();
    worst = std::max(worst, std::abs(now - rest));
  }
  EXPECT_LT(worst, 5e-5);
  EXPECT_GT(worst, 0);
}

TEST(PropertyRigid, MovingThereAndBackRestoresThePose) {
  std::mt19937 random(8);
  Body body = body_of(homogeneous({5, 4, 3}, 1.2, 0.8, 0.3));
  RigidPiece piece = piece_of_all(body);
  for (int n = 0; n < 100; ++n) {
    const RigidMotion motion = random_motion(random);
    RigidMotion back = motion;
    back.turn = back.turn.inverse();
    back.about_lps_mm = motion.about_lps_mm + motion.shift_lps_mm;
    back.shift_lps_mm = -motion.shift_lps_mm;
    const RigidPose before = piece.pose;
    piece.pose = moved_by(motion, piece, body.geometry);
    piece.pose = moved_by(back, piece, body.geometry);
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_LE(std::abs(piece.pose.shift_q[c] - before.shift_q[c]), 2);
      EXPECT_NEAR(piece.pose.turn.v[int(c)], before.turn.v[int(c)], 1e-12);
    }
    piece.pose = before;
  }
}

TEST(UnitRigid, ConnectedPartsFollowUncutLinks) {
  Body body = body_of(homogeneous({10, 3, 3}, 1.2, 0.8, 0.3));
  for_each_element(body.elements, [&](Slot slot) {
    if (voxel_of(body.elements, slot).x == 4) {
      body.cuts.cut(slot / kBrickVoxels, int(slot % kBrickVoxels), 0);
    }
  });
  const SlotSet all = slots_in_box(body.elements, {{0, 0, 0}, {9, 2, 2}});
  EXPECT_EQ(connected_parts(body.elements, {}, all).size(), 1u);
  const auto parts = connected_parts(body.elements, body.cuts, all);
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_EQ(parts[0].size(), 45u);
  EXPECT_EQ(parts[1].size(), 45u);
}

TEST(UnitRigid, ElementsGoToTheNearestSeedByWayOfTheSetInMm) {
  Body body = body_of(homogeneous({12, 3, 1}, 1.2, 0.8, 0.3));
  body.geometry = Geometry({12, 3, 1}, {0, 0, 0}, {Vec3d(1, 0, 0), Vec3d(0, 4, 0), Vec3d(0, 0, 1)});
  // A row above, one below, joined at one end only.
  SlotSet set = slots_in_box(body.elements, {{0, 0, 0}, {11, 0, 0}});
  set.add(slots_in_box(body.elements, {{0, 2, 0}, {11, 2, 0}}));
  set.add(slots_in_box(body.elements, {{0, 1, 0}, {0, 1, 0}}));
  const auto slot = [&](int i, int j) {
    Slot found = 0;
    slot_of(body.elements, {i, j, 0}, found);
    return found;
  };
  const auto parts = flooded_parts(body, {}, {}, set, {slot(11, 0), slot(3, 2)});
  ASSERT_EQ(parts.size(), 2u);
  // The way from (3, 2) is 3 + 8 + n mm to (n, 0), that from (11, 0) is 11 - n: equal at 0.
  EXPECT_EQ(parts[0].size(), 12u);
  EXPECT_EQ(parts[1].size(), 13u);
  EXPECT_TRUE(parts[0].contains(slot(0, 0)));
  EXPECT_TRUE(parts[1].contains(slot(0, 1)));
}

TEST(UnitRigid, PartsOfSeedsMeetWhereBoneIsLeastDenseHoweverFarThatIsFromTheSeeds) {
  const Body body = body_of(homogeneous({20, 4, 4}, 1.2, 0.8, 0.3));
  // A long bone up to i = 14, whose marrow is less dense than the joint, a short one from 16 on.
  std::vector<float> values(body.elements.brick_count() * kBrickVoxels, 0);
  const auto slot = [&](const Vec3i& voxel) {
    Slot found = 0;
    slot_of(body.elements, voxel, found);
    return found;
  };
  const auto density = [](const Vec3i& at) {
    if (at.x == 15) return 350;
    const bool is_marrow = at.x < 14 && at.y % 3 > 0 && at.z % 3 > 0;
    return is_marrow ? 310 : 700 + 40 * ((at.x * 7 + at.y * 3 + at.z) % 5);
  };
  for_each_element(body.elements,
                   [&](Slot s) { values[s] = float(density(voxel_of(body.elements, s))); });
  const DensityGrid grid = make_density_grid(body.elements, values, 0);
  const SlotSet all = slots_in_box(body.elements, {{0, 0, 0}, {19, 3, 3}});
  const auto parts = flooded_parts(body, grid, {}, all, {slot({0, 0, 0}), slot({18, 2, 2})});
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_EQ(parts[0].size() + parts[1].size(), all.size());
  all.for_each([&](Slot s) {
    const int i = voxel_of(body.elements, s).x;
    if (i == 15) return;  // the joint itself is as near to either side
    EXPECT_EQ(parts[0].contains(s), i < 15) << to_text(voxel_of(body.elements, s));
  });
}
