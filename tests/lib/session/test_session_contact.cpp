// Contact of the sides of cuts through whole sessions: an incision, lips that are pushed into each
// other.
#include <gtest/gtest.h>

#include "lib/contact/cut_lips.h"
#include "lib/material/material.h"
#include "lib/session/session.h"
#include "tests/support/program.h"
#include "tests/support/sanitized.h"
#include "volumes/base/parallel.h"

using namespace supple;
using namespace supple::test;

namespace {

constexpr int kLong = 24, kTall = 18, kBone = 4;  // voxels; cuts end above z = kBone

/// Tests with the number of links of the material as parameter.
class PropertySessionContact : public ::testing::TestWithParam<int> {
 protected:
  PropertySessionContact() {
    std::string voxels;
    for (int k = 0; k < kTall; ++k) {
      for (int n = 0; n < kLong * kLong; ++n) {
        const bool is_air = k == kTall - 1 && n == 0;
        voxels += char(static_cast<unsigned char>(is_air ? 0 : k < kBone ? 200 : 100));
      }
    }
    write_text(m_folder / "plate.raw", voxels);
    write_text(m_folder / "plate.nhdr",
               "NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\n"
               "sizes: 24 24 18\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n"
               "space origin: (0,0,0)\nencoding: raw\ndata file: plate.raw\n");
  }

  SessionOptions options(const std::string& more) const {
    SessionOptions options;
    options.keeps_undo = true;
    options.material = parse_material(
        "domain = [0, 255]\nactive = [1, 255]\nmax_length = [[0, 1.5]]\nmin_length = [[0, 0.6]]\n"
        "shear = [[0, 0.28]]\nlinks = " +
            std::to_string(GetParam()) + "\nrelax = false\n" + more,
        "test");
    return options;
  }
  std::string volume() const { return m_folder / "plate.nhdr"; }

  TemporaryFolder m_folder;
};

/// Down to the bone across i, from j = `from` to `to`, leaning by `lean` voxels per voxel.
CutSurface incision(double from, double to, double lean = 0) {
  CutSurface plane;
  plane.in_voxels = true;
  plane.corner = {11.5 - lean * (kTall - kBone) / 2, from, kBone - 0.5};
  plane.edge1 = {0, to - from, 0};
  plane.edge2 = {lean * (kTall - kBone), 0, double(kTall - kBone)};
  return plane;
}

Step pushed(const Vec3d& by_mm, const IndexBox& lip = {{8, 9, 12}, {10, 14, 16}}) {
  Step request;
  request.drags.push_back({Region(lip), by_mm});
  return request;
}

std::int64_t overlaps(Session& session) {
  return session.pose().offsets.certificate.overlapped_voxels;
}

}  // namespace

TEST_P(PropertySessionContact, FiniteElementsTellWhereTheSidesOfACutOverlap) {
  Session session(volume(), options(""));
  session.cut(incision(4, 20));
  Step apart = pushed({-2, 0, 0});
  apart.fix = {{{0, 0, 0}, {kLong - 1, kLong - 1, kBone - 1}}};
  apart.fem.emplace();
  apart.fem->params.set_accuracy(FemAccuracy::picture);
  EXPECT_EQ(session.step(apart).contact.left, 0);
  EXPECT_EQ(overlaps(session), 0);
  Step into = apart;
  into.drags[0].by_mm = {5, 0, 0};
  const StepRecord& record = session.step(into);
  EXPECT_GT(overlaps(session), 20);
  EXPECT_GT(record.contact.left, 20);
  // The handle's element nearest to the cut goes 3 voxels from rest, its neighbour beyond hardly.
  EXPECT_NEAR(record.contact.left_voxels, 3, 0.6);
  EXPECT_NEAR(record.contact.voxel.x, 11, 1);
  EXPECT_GE(record.contact.voxel.y, 8);
  EXPECT_LE(record.contact.voxel.y, 15);
}

TEST_P(PropertySessionContact, AnIncisionDoesNotPassThroughItself) {
  for (const double lean : {0.0, 0.5}) {
    Session passing(volume(), options("contact = false\n"));
    passing.cut(incision(4, 20, lean));
    passing.step(pushed({4, 0.5, 0}));
    ASSERT_GT(overlaps(passing), 20) << lean;

    Session session(volume(), options(""));
    session.cut(incision(4, 20, lean));
    Step push = pushed({4, 0.5, 0});
    push.fix = {{{12, 0, 0}, {12, 0, 0}}};
    const StepRecord& record = session.step(push);
    EXPECT_GT(record.contact.overlapping, 20);
    EXPECT_EQ(record.contact.left, 0);
    EXPECT_EQ(overlaps(session), 0) << lean;
    EXPECT_EQ(check_links(session.body()).violated, 0);
    // The other lip gives way.
    EXPECT_GT(session.body().offset({13, 11, 15}, 0), 0);
  }
}

TEST_P(PropertySessionContact, ARelaxationDoesNotPushTheLipsThroughEachOther) {
  for (const char* bone : {"", "rigid = [150, 255]\n"}) {
    Session session(volume(), options(bone));
    session.cut(incision(4, 20));
    Step push = pushed({2.5, 0, 0});
    push.fix = {{{12, 0, 0}, {12, 0, 0}}};
    EXPECT_GT(session.step(push).contact.overlapping, 0);
    Step relax;
    relax.relax = RelaxParams();
    relax.relax->passes = 100;
    const StepRecord& record = session.step(relax);
    EXPECT_TRUE(record.contact.overlapping > 0 || record.contact.parts < kContactParts);
    EXPECT_EQ(record.contact.left, 0);
    EXPECT_EQ(overlaps(session), 0) << bone;
    EXPECT_EQ(check_links(session.body()).violated, 0);
  }
}

TEST_P(PropertySessionContact, LipsOfALaterCutAreKeptApartToo) {
  Session session(volume(), options(""));
  CutSurface elsewhere = incision(4, 20);
  elsewhere.corner.x = 18.5;
  session.cut(elsewhere);
  session.step(pushed({1, 0, 0}, {{16, 9, 12}, {17, 14, 16}}));
  session.cut(incision(4, 20));
  EXPECT_GT(session.step(pushed({4, 0.5, 0})).contact.overlapping, 20);
  EXPECT_EQ(overlaps(session), 0);
}

TEST_P(PropertySessionContact, LipsThatAreBothHeldStopTheDragWhereTheyMeet) {
  Session session(volume(), options(""));
  session.cut(incision(-1, 25));
  Step push = pushed({6, 0, 0}, {{0, 0, 8}, {10, 23, 16}});
  push.fix = {{{13, 0, 8}, {23, 23, 17}}, {{12, 0, 0}, {12, 0, 0}}};
  const StepRecord& record = session.step(push);
  EXPECT_EQ(record.contact.left, 0);
  EXPECT_LT(record.contact.parts, kContactParts);
  // The drag tells of it, and goes as far.
  EXPECT_LE(record.report.fraction(), double(record.contact.parts) / kContactParts);
  EXPECT_NEAR(session.body().offset({5, 11, 12}, 0) / 65536.0, 6 * record.report.fraction(), 1e-3);
  EXPECT_EQ(overlaps(session), 0);
  // One link on either side of the cut gives way by 0.4, and so do the halves of a link to the
  // face.
  EXPECT_GT(session.body().offset({5, 11, 12}, 0), 0.7 * 65536);
  EXPECT_LT(session.body().offset({5, 11, 12}, 0), (1.2 + kLipOverlap + 1.0 / 64) * 65536);
}

TEST_P(PropertySessionContact, TissueOverRigidBoneDoesNotPassThroughItself) {
  for (const double lean : {0.0, 0.5}) {
    Session session(volume(), options("rigid = [150, 255]\n"));
    session.cut(incision(4, 20, lean));
    Step push = pushed({3, 0.5, 0});
    push.fix = {{{12, 0, 0}, {12, 0, 0}}};
    const StepRecord& record = session.step(push);
    ASSERT_FALSE(session.body().rigid.empty());
    EXPECT_GT(record.contact.overlapping, 20);
    EXPECT_EQ(record.contact.left, 0);
    EXPECT_EQ(overlaps(session), 0) << lean;
    EXPECT_EQ(check_links(session.body()).violated, 0);
    EXPECT_GT(session.body().offset({13, 11, 15}, 0), 0);
    EXPECT_EQ(session.body().offset({13, 11, 2}, 0), 0);  // bone
  }
}

TEST_P(PropertySessionContact, OverRigidBoneHeldLipsStopTheDragOnItsStraightWay) {
  Session session(volume(), options("rigid = [150, 255]\n"));
  session.cut(incision(-1, 25));
  Step push = pushed({4, 0, 0}, {{0, 0, 10}, {10, 23, 16}});
  push.fix = {{{13, 0, 10}, {23, 23, 17}}, {{12, 0, 0}, {12, 0, 0}}};
  const StepRecord& record = session.step(push);
  EXPECT_EQ(record.contact.left, 0);
  EXPECT_LT(record.contact.parts, kContactParts);
  EXPECT_NEAR(session.body().offset({5, 11, 12}, 0) / 65536.0, 4 * record.report.fraction(), 1e-3);
  EXPECT_EQ(overlaps(session), 0);
  EXPECT_EQ(check_links(session.body()).violated, 0);
}

TEST_P(PropertySessionContact, LiveDragsOverRigidBoneKeepTheLipsApart) {
  Session session(volume(), options("rigid = [150, 255]\n"));
  session.cut(incision(-1, 25));
  Step push = pushed({0.4, 0, 0}, {{0, 0, 10}, {10, 23, 16}});
  push.fix = {{{13, 0, 10}, {23, 23, 17}}, {{12, 0, 0}, {12, 0, 0}}};
  push.shift_pieces = true;
  int stopped = 0;
  for (int n = 0; n < 8; ++n) {
    const StepRecord& record = session.step(push);
    EXPECT_EQ(record.contact.left, 0) << n;
    stopped += record.contact.parts < kContactParts;
    push.fix.clear();
  }
  EXPECT_GT(stopped, 0);
  EXPECT_EQ(overlaps(session), 0);
  EXPECT_EQ(check_links(session.body()).violated, 0);
}

/// Tissue without room beside a bone that is led is crushed, and told.
TEST_P(PropertySessionContact, TissueStopsNoDragOfBone) {
  Session session(volume(), options("rigid = [150, 255]\n"));
  CutSurface off_bone;
  off_bone.in_voxels = true;
  off_bone.corner = {-1, -1, kBone - 0.5};
  off_bone.edge1 = {26, 0, 0};
  off_bone.edge2 = {0, 26, 0};
  session.cut(off_bone);
  Step lift = pushed({0, 0, 3}, {{4, 4, 1}, {4, 4, 1}});
  lift.fix = {{{0, 0, 5}, {23, 23, 16}}};
  lift.shift_pieces = true;
  session.step(lift);
  EXPECT_EQ(session.body().offset({4, 4, 1}, 2), 3 * 65536);
  // Tissue is told of where the bone comes to rest.
  Step rest;
  rest.relax = RelaxParams();
  rest.relax->passes = 4;
  EXPECT_GT(session.step(rest).contact.left, 0);
  EXPECT_EQ(session.body().offset({4, 4, 1}, 2), 3 * 65536);
  ASSERT_TRUE(session.undo());
  ASSERT_TRUE(session.undo());
  // A drag at once ends there, too.
  lift.shift_pieces = false;
  const StepRecord& record = session.step(lift);
  EXPECT_EQ(record.contact.parts, kContactParts);
  EXPECT_TRUE(record.contact.is_crushed);
  EXPECT_EQ(session.body().offset({4, 4, 1}, 2), 3 * 65536);
}

/// The bone would bend on the straight way: it goes the whole of it, and lips that find room part.
TEST_P(PropertySessionContact, BoneThatTurnsKeepsItsShapeAndLipsPart) {
  Session session(volume(), options("rigid = [150, 255]\n"));
  session.cut(incision(4, 20));
  Step turn = pushed({0, 0, 0}, {{4, 4, 1}, {4, 4, 1}});
  turn.drags[0].motion.angle_deg = 1;
  turn.drags.push_back(pushed({2.2, 0.5, 0}).drags[0]);
  const StepRecord& record = session.step(turn);
  EXPECT_GT(record.contact.overlapping, 0);
  EXPECT_EQ(record.contact.left, 0);
  EXPECT_EQ(record.contact.parts, kContactParts);
  EXPECT_EQ(overlaps(session), 0);
  EXPECT_EQ(check_links(session.body()).violated, 0);
  const Body& body = session.body();
  for (const Vec3i& voxel : {Vec3i(0, 0, 0), Vec3i(23, 23, 3), Vec3i(12, 20, 1)}) {
    const auto by_pose = PoseOffsets(body.geometry, body.rigid.list[0])(voxel);
    for (int c = 0; c < 3; ++c) EXPECT_EQ(body.offset(voxel, c), by_pose[std::size_t(c)]) << c;
  }
}

/// Tissue that is cut off its bone and pressed onto it further than it gives.
TEST_P(PropertySessionContact, BoneUnderPressedTissueKeepsItsShape) {
  enum class Bone { fixed, turned, free };
  for (const Bone bone : {Bone::fixed, Bone::turned, Bone::free}) {
    Session session(volume(), options("rigid = [150, 255]\n"));
    CutSurface off_bone;
    off_bone.in_voxels = true;
    off_bone.corner = {2, 2, kBone - 0.5};
    off_bone.edge1 = {20, 0, 0};
    off_bone.edge2 = {0, 20, 0};
    session.cut(off_bone);
    Step press = pushed({0, 0, -3}, {{11, 11, 10}, {13, 13, 11}});
    if (bone == Bone::fixed) press.fix = {{{12, 0, 0}, {12, 0, 0}}};
    if (bone == Bone::free) press.fix = {{{0, 0, 16}, {1, 1, 16}}};
    if (bone == Bone::turned) {
      press.drags.push_back(pushed({0, 0, 0}, {{4, 4, 1}, {4, 4, 1}}).drags[0]);
      press.drags[1].motion.angle_deg = 0.5;
    }
    const StepRecord& record = session.step(press);
    EXPECT_GT(record.contact.overlapping, 0);
    if (bone == Bone::turned) {
      // A bone that moves is not stopped. So the drag is whole, and overlap is left.
      EXPECT_EQ(record.contact.parts, kContactParts);
      EXPECT_GT(record.contact.left, 0);
    } else {
      EXPECT_LT(record.contact.parts, kContactParts);
      EXPECT_EQ(record.contact.left, 0);
    }
    const Body& body = session.body();
    ASSERT_EQ(body.rigid.list.size(), 1u);
    const PoseOffsets by_pose(body.geometry, body.rigid.list[0]);
    body.rigid.list[0].elements->for_each([&](Slot slot) {
      const Vec3i voxel = voxel_of(body.elements, slot);
      for (int c = 0; c < 3; ++c) {
        ASSERT_EQ(body.offset(voxel, c), by_pose(voxel)[std::size_t(c)]) << voxel;
      }
    });
  }
}

TEST_P(PropertySessionContact, DoesNotDependOnThreadsAndIsTakenBack) {
  const auto moved_on = [&](int threads) {
    return on_threads(threads, [&] {
      Session session(volume(), options(""));
      session.cut(incision(4, 20, 0.4));
      const State before = session.state();
      EXPECT_GT(session.step(pushed({3, 1, -1})).contact.overlapping, 0);
      const State after = session.state();
      EXPECT_TRUE(session.undo());
      EXPECT_EQ(session.state().q, before.q);
      return after;
    });
  };
  const State one = moved_on(1), many = moved_on(4);
  EXPECT_EQ(one.q, many.q);
}

LEFT_OUT_WHEN_SANITIZED("PropertySessionContact.*/1");
INSTANTIATE_TEST_SUITE_P(, PropertySessionContact, ::testing::Values(6, 26));
