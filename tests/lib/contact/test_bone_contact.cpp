// Contact of rigid pieces through whole sessions, judged by an oracle of its own: every voxel of a
// piece, where the offsets of the body put it, among the voxels of the other pieces.
#include <cmath>
#include <functional>
#include <random>

#include <gtest/gtest.h>

#include "lib/contact/piece_contact.h"
#include "lib/contact/piece_overlap.h"
#include "lib/session/handles/rigid_drag.h"
#include "lib/session/session.h"
#include "tests/lib/bone_fixtures.h"
#include "tests/support/program.h"
#include "tests/support/sanitized.h"

using namespace supple;
using namespace supple::test;

namespace {

/// The way that a drag of `by` has gone, mm.
double way_done(const StepRecord& record) {
  return record.drags[0].by_mm.length() * record.report.fraction();
}

bool says(const Session& session, const std::string& part) {
  for (const std::string& line : session.messages()) {
    if (line.find(part) != std::string::npos) return true;
  }
  return false;
}

/// Overlap allowed beyond that at rest, by the widest turn of two pieces against each other.
double allowed_overlap(const Body& body) {
  double most_deg = 0;
  for (const RigidPiece& piece : body.rigid.list) {
    most_deg = std::max(most_deg, piece.pose.turn.angle_deg());
  }
  return kShiftedOverlap + std::min(1.0, most_deg) * (kTurnedOverlap - kShiftedOverlap);
}

/// Drags of which no part leaves the piece deeper in others than it is, as another judge sees it.
struct OpeningDrags {
  int opening = 0, turning = 0, whole = 0;
  int stopped = 0;  // by bone
};

OpeningDrags drags_that_open(Session& session, const Vec3i& grabbed, int tried,
                             const std::function<void(Step&)>& choose) {
  OpeningDrags told;
  const OverlapJudge judge(session.body());
  const double at_rest = judge.deepest();
  for (int n = 0; n < tried; ++n) {
    Step drag = jaw_drag({});
    drag.drags[0].region = Region(grabbed);
    choose(drag);
    const PieceMotion way =
        motions_of_pieces(session.body(), drag.drags, {drag.drags[0].region}).front();
    constexpr double kRounding = 1e-3;
    const double enough = at_rest + kRounding;
    if (judge.deepest_on_way({way.piece}, way.motion, 16, enough) > enough) continue;
    const StepRecord& record = session.step(drag);
    ++told.opening;
    told.turning += way.motion.turns();
    told.whole += record.report.fraction() == 1;
    told.stopped += record.bones.has_value();
    session.undo();
  }
  return told;
}

}  // namespace

TEST(PropertyBoneContact, AWayNeverShrinksWithTheWayAsked) {
  LEFT_OUT_WHEN_SANITIZED();
  const TemporaryFolder folder;
  for (const bool has_third_bone : {false, true}) {
    const std::string path = write_wavy_joint(folder, has_third_bone);
    double before = 0;
    for (const double asked : {0.5, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0}) {
      Session session(path, bone_options());
      const StepRecord& record = session.step(wavy_drag({0, asked, 0}));
      const double done = way_done(record);
      EXPECT_GE(done, before - 1e-4) << asked;
      EXPECT_LT(deepest_overlap(session.body()), kShiftedOverlap + 1e-3) << asked;
      EXPECT_EQ(record.bones.has_value(), done < asked - 1e-9) << asked;
      EXPECT_EQ(says(session, "bone stopped the drag"), record.bones.has_value());
      before = done;
    }
    // The gap of the joint, a voxel and some of its wave, is used.
    EXPECT_GT(before, 1.5);
    EXPECT_LT(before, 3);
  }
}

TEST(PropertyBoneContact, OpeningAJointIsNeverStopped) {
  const TemporaryFolder folder;
  const std::string path = write_wavy_joint(folder, true);
  for (const Vec3d& by : {Vec3d(0.04, 0, 0), Vec3d(1, 0, 0), Vec3d(3, 0, 0), Vec3d(3, 0.5, 0.5)}) {
    Session session(path, bone_options());
    const StepRecord& record = session.step(wavy_drag(by));
    EXPECT_FALSE(record.bones.has_value()) << by.x;
    EXPECT_DOUBLE_EQ(record.report.fraction(), 1) << by.x;
  }
}

TEST(PropertyBoneContact, FiniteElementsLeadBonesAsFarAsTheyLeaveEachOtherRoom) {
  LEFT_OUT_WHEN_SANITIZED();
  const TemporaryFolder folder;
  const std::string path = write_wavy_joint(folder, false);
  Session by_links(path, bone_options());
  Step drag = wavy_drag({0, 4, 0});
  const double reach = way_done(by_links.step(drag));
  Session by_elements(path, bone_options());
  drag.fem.emplace();
  drag.fem->params.tolerance = 0.1;
  drag.fem->params.reaction_tolerance = 0.1;
  const StepRecord& record = by_elements.step(drag);
  EXPECT_TRUE(record.bones.has_value());
  EXPECT_NEAR(way_done(record), reach, 1e-4);
  EXPECT_LT(deepest_overlap(by_elements.body()), kShiftedOverlap + 1e-3);
  EXPECT_TRUE(says(by_elements, "bone stopped the drag"));
}

TEST(PropertyBoneContact, FreePiecesStayOutOfOthersUnderFiniteElementsAndNothingHoldsThemThen) {
  LEFT_OUT_WHEN_SANITIZED();
  const TemporaryFolder folder;
  const std::string path = write_wavy_joint(folder, false);
  Step press = wavy_drag({});  // tissue beside the free bone, towards the held one
  press.drags = {{Region(IndexBox{{32, 8, 8}, {36, 24, 24}}), Vec3d(-6, 0, 0)}};
  press.fem.emplace();
  press.fem->params.set_accuracy(FemAccuracy::picture);
  SessionOptions options = bone_options();
  options.material->has_contact = false;
  Session passing(path, options);
  passing.step(press);
  ASSERT_GT(deepest_overlap(passing.body()), 0.7);

  Session session(path, bone_options());
  const StepRecord& record = session.step(press);
  ASSERT_EQ(record.meetings.size(), 1u);
  EXPECT_TRUE(record.meetings[0].is_kept);
  EXPECT_GT(record.meetings[0].overlap_voxels, 0.7);
  EXPECT_LT(deepest_overlap(session.body()), allowed_overlap(session.body()) + 1e-3);
  const double there = session.body().offset({24, 16, 16}, 0);
  EXPECT_LT(there, -0.5 * kFixedOne);

  Step back = press;
  back.rigid = {};
  back.fix.clear();
  back.drags[0].by_mm = Vec3d(9, 0, 0);
  EXPECT_TRUE(session.step(back).meetings.empty());
  EXPECT_GT(session.body().offset({24, 16, 16}, 0), there + kFixedOne);
}

TEST(PropertyBoneContact, AFreePieceGoesAlongWithTheOneThatItMeetsUnderFiniteElements) {
  LEFT_OUT_WHEN_SANITIZED();
  const TemporaryFolder folder;
  const std::string path = write_wavy_joint(folder, true);
  Step press = wavy_drag({2, 0, 0});
  press.drags.push_back({Region(IndexBox{{37, 8, 13}, {39, 23, 17}}), Vec3d(-11, 0, 0)});
  press.fem.emplace();
  press.fem->params.set_accuracy(FemAccuracy::picture);
  SessionOptions options = bone_options();
  options.material->has_contact = false;
  Session passing(path, options);
  passing.step(press);
  ASSERT_GT(deepest_overlap(passing.body()), 0.6);
  Session session(path, bone_options());
  const StepRecord& record = session.step(press);
  ASSERT_FALSE(record.meetings.empty());
  EXPECT_TRUE(record.meetings[0].is_kept);
  EXPECT_FALSE(record.bones.has_value());
  EXPECT_LT(deepest_overlap(session.body()), allowed_overlap(session.body()) + 1e-3);
}

TEST(PropertyBoneContact, DragsInAllDirectionsThatOpenAJointAreDoneWhole) {
  LEFT_OUT_WHEN_SANITIZED();
  const TemporaryFolder folder;
  Session session(write_wavy_joint(folder, false), bone_options());
  Step part = wavy_drag({});
  part.drags.clear();
  session.step(part);
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const OpeningDrags told = drags_that_open(session, Vec3i(24, 16, 16), 60, [&](Step& drag) {
    drag.drags[0].by_mm =
        Vec3d(1.5 + 1.5 * uniform(random), 2 * uniform(random), 2 * uniform(random));
    if (uniform(random) > 0) return;
    drag.drags[0].motion.angle_deg = 6 * uniform(random);
    drag.drags[0].motion.axis_lps = {uniform(random), uniform(random), uniform(random)};
  });
  EXPECT_GE(told.opening, 12);
  EXPECT_GE(told.turning, 3);
  EXPECT_GE(told.whole, 0.9 * told.opening);
  EXPECT_EQ(told.stopped, 0);
}

TEST(PropertyBoneContact, LiveDragsReachAsFarAsOneOfAll) {
  const TemporaryFolder folder;
  const std::string path = write_wavy_joint(folder, false);
  Session whole(path, bone_options());
  const double reach = way_done(whole.step(wavy_drag({0, 4, 0})));
  ASSERT_LT(reach, 3);
  Session live(path, bone_options());
  Step part = wavy_drag({0, 0.15, 0});
  part.shift_pieces = true;
  double done = 0;
  for (int n = 0; n < 25; ++n) {
    done += way_done(live.step(part));
    part.rigid = {};
    part.fix.clear();
  }
  EXPECT_NEAR(done, reach, 2.0 / 256);
  EXPECT_LT(deepest_overlap(live.body()), kShiftedOverlap + 1e-3);
}

TEST(PropertyBoneContact, BonesThatLieInEachOtherMayPartAgain) {
  const TemporaryFolder folder;
  const std::string path = write_wavy_joint(folder, false);
  SessionOptions options = bone_options();
  options.material->has_contact = false;
  Session passing(path, options);
  passing.step(wavy_drag({0, 4, 0}));
  const double deep = deepest_overlap(passing.body());
  ASSERT_GT(deep, 0.5);
  const std::string state = folder / "deep.vdb";
  passing.write_state(state);
  Session session(state, bone_options());
  Step back = wavy_drag({0, -4, 0});
  back.rigid = {};
  back.fix.clear();
  EXPECT_FALSE(session.step(back).bones.has_value());
  EXPECT_LT(deepest_overlap(session.body()), kShiftedOverlap);
}

/// The upper jaw of the scan, parted as docs/scenes/head_upper_jaw.toml parts it, in a crop.
class PropertyJawContact : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::string head = public_volume("ct_head.nhdr");
    if (head.empty()) GTEST_SKIP() << "no head CT (tools/fetch_ct_head.sh)";
    m_path = write_jaw_crop(public_volume("ct_head.raw"), m_folder);
  }

  TemporaryFolder m_folder;
  std::string m_path;
};

TEST_F(PropertyJawContact, TwentyRandomDragsLeaveNoBoneInAnotherOrAreShortened) {
  LEFT_OUT_WHEN_SANITIZED();
  Session session(m_path, bone_options());
  session.step(jaw_step());
  const double at_rest = deepest_overlap(session.body());
  std::mt19937 random(50);
  std::uniform_real_distribution<double> uniform(-1, 1);
  int opening = 0, opened = 0, stopped = 0;
  for (int n = 0; n < 20; ++n) {
    // Walls of the box that parts the jaw are above, behind and beside it: down and forward is
    // away.
    const bool opens = n % 2 == 0, turns = n % 4 == 3;
    Vec3d by(6 * uniform(random), 6 * uniform(random), 6 * uniform(random));
    if (opens) by = Vec3d(0, std::abs(by.y), -std::abs(by.z));
    Step drag = jaw_drag(by);
    if (turns) {
      drag.drags[0].motion.angle_deg = 5 * uniform(random);
      drag.drags[0].motion.axis_lps = {uniform(random), uniform(random), uniform(random)};
    }
    const StepRecord& record = session.step(drag);
    EXPECT_LE(deepest_overlap(session.body()) - at_rest,
              (turns ? kTurnedOverlap : kShiftedOverlap) + 1e-3)
        << n << ": " << by.x << ", " << by.y << ", " << by.z;
    opening += opens;
    opened += opens && !record.bones;
    stopped += record.bones.has_value();
    EXPECT_EQ(check_links(session.body()).violated, 0) << n;
    ASSERT_TRUE(session.undo());
  }
  EXPECT_GT(stopped, 3);
  EXPECT_GE(opened, 0.9 * opening) << opening;
  std::printf("%d of 20 stopped, %d of %d that open whole\n", stopped, opened, opening);
}

TEST_F(PropertyJawContact, DragsThatOpenTheJointAreDoneWhole) {
  Session session(m_path, bone_options());
  session.step(jaw_step());
  std::mt19937 random(51);
  std::uniform_real_distribution<double> uniform(-1, 1);
  int n = 0;
  const OpeningDrags told = drags_that_open(session, Vec3i(44, 61, 12), 24, [&](Step& drag) {
    // Down, forward, both, to a side and turned about an axis through both condyles: the walls
    // beside the jaw let none of the last two go.
    const double down = -3 - 3 * uniform(random), forward = 3 + 3 * uniform(random);
    drag.drags[0].by_mm = Vec3d(0, n % 3 == 0 ? 0 : forward, n % 3 == 1 ? 0 : down);
    if (n % 8 == 6) drag.drags[0].by_mm.x = 2 * uniform(random);
    if (n % 8 == 7) {
      drag.drags[0].motion.angle_deg = 6 * uniform(random);
      drag.drags[0].motion.axis_lps = {1, 0, 0};
      drag.drags[0].motion.about_lps_mm = session.geometry().world_from_index({44, -22, 21});
    }
    ++n;
  });
  EXPECT_GE(told.opening, 15);
  EXPECT_GE(told.whole, 0.9 * told.opening);
  EXPECT_EQ(told.stopped, 0);
}

TEST_F(PropertyJawContact, WaysOfTheJawNeverShrinkWithTheWayAsked) {
  LEFT_OUT_WHEN_SANITIZED();
  Session session(m_path, bone_options());
  session.step(jaw_step());
  for (const Vec3d& direction : {Vec3d(0, 1, 0), Vec3d(0, 0, 1), Vec3d(0.3, 0.8, 0.5)}) {
    double before = 0;
    for (const double asked : {1.0, 2.0, 4.0, 8.0}) {
      const double done = way_done(session.step(jaw_drag(direction * asked)));
      EXPECT_GE(done, before - 1e-3) << direction.x << " " << direction.y << " " << asked;
      before = done;
      ASSERT_TRUE(session.undo());
    }
  }
}
