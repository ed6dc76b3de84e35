// Rigid pieces, removal and their state through whole sessions: two bars of bone that touch, in
// soft tissue.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>

#include <gtest/gtest.h>

#include "lib/material/material.h"
#include "lib/session/session.h"
#include "tests/lib/test_bodies.h"
#include "tests/support/program.h"

using namespace supple;
using namespace supple::test;

namespace {

constexpr Vec3i kDims(30, 18, 16);
const IndexBox kLeft{{6, 7, 6}, {11, 10, 9}}, kRight{{12, 7, 6}, {18, 10, 9}};

class UnitPieces : public ::testing::Test {
 protected:
  UnitPieces() {
    std::string voxels;
    for (int k = 0; k < kDims.z; ++k) {
      for (int j = 0; j < kDims.y; ++j) {
        for (int i = 0; i < kDims.x; ++i) {
          const Vec3i voxel(i, j, k);
          const bool is_air = i == 0 && j == 0 && k == 0;
          const bool is_bone = kLeft.contains(voxel) || kRight.contains(voxel);
          voxels += char(static_cast<unsigned char>(is_air ? 0 : is_bone ? 200 : 100));
        }
      }
    }
    write_text(m_folder / "bars.raw", voxels);
    write_text(m_folder / "bars.nhdr",
               "NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\n"
               "sizes: 30 18 16\nspace directions: (1,0,0) (0,1,0) (0,0,1.5)\n"
               "space origin: (0,0,0)\nencoding: raw\ndata file: bars.raw\n");
    m_options.keeps_undo = true;
    m_options.material = parse_material(
        "domain = [0, 255]\nactive = [1, 255]\nmax_length = [[0, 1.6]]\n"
        "min_length = [[0, 0.6]]\nshear = [[0, 0.29]]\nlinks = 26\nrigid = [180, 255]\n",
        "test");
  }

  TemporaryFolder m_folder;
  SessionOptions m_options;
};

std::array<Vec3d, 8> corners_of(const Body& body, const IndexBox& box) {
  std::array<Vec3d, 8> places;
  for (int n = 0; n < 8; ++n) {
    const Vec3i voxel(n & 1 ? box.hi.x : box.lo.x, n & 2 ? box.hi.y : box.lo.y,
                      n & 4 ? box.hi.z : box.lo.z);
    Vec3d at(voxel);
    for (int c = 0; c < 3; ++c) at[c] += double(body.offset(voxel, c)) / kVoxel;
    places[std::size_t(n)] = body.geometry.world_from_index(at);
  }
  return places;
}

/// Largest change of distances between the corners of a box from those at rest, mm.
double bend(const Body& body, const IndexBox& box) {
  Body rest = body;
  for (BrickValues& q : rest.q) q.clear();
  const auto now = corners_of(body, box), before = corners_of(rest, box);
  double worst = 0;
  for (std::size_t a = 0; a < 8; ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      const double change = (now[a] - now[b]).length() - (before[a] - before[b]).length();
      worst = std::max(worst, std::abs(change));
    }
  }
  return worst;
}

Drag drag_of(const IndexBox& grabbed, const Vec3d& by_mm, double turn_deg = 0) {
  Drag drag{Region(grabbed), by_mm};
  drag.motion.angle_deg = turn_deg;
  return drag;
}

Step step_of(std::vector<Drag> drags) {
  Step request;
  request.drags = std::move(drags);
  return request;
}

Step parting() {
  Step request;
  request.rigid.seeds = {{7, 8, 7}, {17, 8, 7}};
  return request;
}

}  // namespace

TEST_F(UnitPieces, BarsThatTouchAreOnePieceUntilSeedsPartThem) {
  Session session(m_folder / "bars.nhdr", m_options);
  ASSERT_EQ(session.body().rigid.list.size(), 1u);
  EXPECT_EQ(session.body().rigid.list[0].elements->size(), 6u * 16 + 7 * 16);
  session.step(parting());
  ASSERT_EQ(session.body().rigid.list.size(), 2u);
  // Half of the way from 7 to 17 is 12, which goes to the earlier seed.
  EXPECT_EQ(session.body().rigid.list[0].elements->size(), 7u * 16);
  EXPECT_EQ(session.body().rigid.list[1].elements->size(), 6u * 16);
  // They are parted: links between them are cut, in what the state shows, too.
  EXPECT_EQ(session.state().cuts.count(), 16);
}

TEST_F(UnitPieces, FiniteElementsLeavePiecesRigid) {
  Session session(m_folder / "bars.nhdr", m_options);
  Step request = step_of({drag_of({{2, 7, 6}, {2, 10, 9}}, {0, 2, 0})});
  request.fix = {{{29, 0, 0}, {29, 17, 15}}};
  request.fem.emplace();
  const FemRecord& pulled = session.step(request).equilibrium;
  // Both bars are one piece, which turns and follows the tissue; linear equations let it grow.
  EXPECT_EQ(pulled.fitted_pieces, 1);
  EXPECT_GT(pulled.fitted_max_voxels, 0);
  EXPECT_LT(pulled.fitted_max_voxels, 0.05);
  EXPECT_LT(bend(session.body(), kLeft), 1e-4);
  EXPECT_LT(bend(session.body(), kRight), 1e-4);
  EXPECT_GT(session.body().offset(kLeft.lo, 1), kVoxel / 10);
  EXPECT_GT(session.body().offset(kLeft.lo, 1), session.body().offset(kRight.hi, 1));

  request = step_of({drag_of({{7, 8, 7}, {7, 8, 7}}, {0, 0, 0.75}, 4)});
  request.release = true;
  request.fix = {{{29, 0, 0}, {29, 17, 15}}};
  request.fem.emplace();
  // What holds a piece gives it the pose.
  EXPECT_EQ(session.step(request).equilibrium.fitted_pieces, 0);
  EXPECT_LT(bend(session.body(), kLeft), 1e-4);
  EXPECT_LT(bend(session.body(), kRight), 1e-4);
}

TEST_F(UnitPieces, AHandleOnAVoxelOfAPieceMovesAllOfIt) {
  Session session(m_folder / "bars.nhdr", m_options);
  session.drag(Vec3i(7, 8, 7), {0.5, -1.25, 0.75});
  for (const IndexBox& box : {kLeft, kRight}) {
    EXPECT_EQ(session.body().offset(box.lo, 0), kVoxel / 2);
    EXPECT_EQ(session.body().offset(box.hi, 1), -kVoxel * 5 / 4);
    EXPECT_EQ(session.body().offset(box.hi, 2), kVoxel / 2);
  }
  EXPECT_EQ(check_links(session.body()).violated, 0);
}

TEST_F(UnitPieces, ATurnedPieceKeepsItsShapeAndItsLinksToTissueHold) {
  Session session(m_folder / "bars.nhdr", m_options);
  session.step(parting());
  Step turn = step_of({drag_of({{15, 8, 7}, {15, 8, 7}}, {0, 0, 0}, 12)});
  turn.drags[0].motion.about_lps_mm = Vec3d(12, 8.5, 11.25);
  const StepRecord& record = session.step(turn);
  EXPECT_EQ(record.report.fraction(), 1);
  const IndexBox right{{13, 7, 6}, {18, 10, 9}};
  EXPECT_LT(bend(session.body(), right), 1e-4);
  EXPECT_EQ(check_links(session.body()).violated, 0);
  // 6 mm from the axis, by 12 degrees.
  const Vec3d at(18 - 12, 7 - 8.5, 0);
  const double angle = 12 * 3.14159265358979323846 / 180;
  EXPECT_NEAR(session.body().offset({18, 7, 6}, 0) / double(kVoxel),
              at.x * std::cos(angle) - at.y * std::sin(angle) - at.x, 2e-5);
  EXPECT_NEAR(session.body().offset({18, 7, 6}, 1) / double(kVoxel),
              at.x * std::sin(angle) + at.y * std::cos(angle) - at.y, 2e-5);
}

TEST_F(UnitPieces, ATurnThatAnchorsStopGoesAPartOfItsAngle) {
  Session session(m_folder / "bars.nhdr", m_options);
  session.step(parting());
  Step turn = step_of({drag_of({{18, 8, 7}, {18, 8, 7}}, {0, 0, 0}, 15)});
  turn.drags[0].motion.about_lps_mm = Vec3d(12, 8.5, 11.25);
  turn.fix = {{{13, 12, 5}, {20, 12, 10}}, {{13, 5, 5}, {20, 5, 10}}};
  const StepRecord& record = session.step(turn);
  const double fraction = record.report.fraction();
  EXPECT_GT(fraction, 0.2);
  EXPECT_LT(fraction, 1);
  EXPECT_LT(bend(session.body(), {{13, 7, 6}, {18, 10, 9}}), 1e-4);
  const double turned = 2 * std::acos(session.body().rigid.list[1].pose.turn.w);
  EXPECT_NEAR(turned * 180 / 3.14159265358979323846, 15 * fraction, 1e-9);
  EXPECT_EQ(session.body().offset({15, 12, 7}, 1), 0);
}

TEST_F(UnitPieces, TissuePullsAFreePieceAlongAndAnAnchoredOneStopsIt) {
  Session session(m_folder / "bars.nhdr", m_options);
  session.step(parting());
  session.drag(Vec3i(24, 8, 7), {8, 0, 0});
  const Body& body = session.body();
  const std::int32_t by = body.offset({18, 8, 7}, 0);
  EXPECT_GT(by, 0);
  EXPECT_EQ(body.offset({13, 7, 6}, 0), by);
  EXPECT_EQ(body.rigid.list[1].pose.shift_q[0], by);
  EXPECT_LT(body.offset({11, 8, 7}, 0), by);  // the other piece is another node
  ASSERT_TRUE(session.undo());
  session.fix({{13, 7, 6}, {13, 7, 6}});  // one voxel holds the piece
  const StepRecord& record = session.drag(Vec3i(24, 8, 7), {8, 0, 0});
  // Six links from the bar's end, each stretches by 0.6.
  EXPECT_NEAR(record.report.fraction() * 8, 6 * 0.6, 1e-3);
  EXPECT_EQ(session.body().offset({18, 8, 7}, 0), 0);
}

TEST_F(UnitPieces, AStateKeepsPiecesAndPosesAndGoesOnAsIfItHadNotBeenWritten) {
  Session session(m_folder / "bars.nhdr", m_options);
  session.step(parting());
  session.step(step_of({drag_of(kLeft, {0.3, 0.1, 0}, 9)}));
  session.write_state(m_folder / "turned.vdb");
  SessionOptions options;
  options.keeps_undo = true;
  Session further(m_folder / "turned.vdb", options);
  ASSERT_EQ(further.body().rigid.list.size(), 2u);
  for (std::size_t n = 0; n < 2; ++n) {
    EXPECT_EQ(further.body().rigid.list[n].pose, session.body().rigid.list[n].pose);
    EXPECT_EQ(further.body().rigid.list[n].name, session.body().rigid.list[n].name);
  }
  EXPECT_EQ(further.state().cuts, session.state().cuts);
  EXPECT_TRUE(further.body().links_known_valid);
  for (Session* each : {&session, &further}) {
    Step more = step_of({drag_of(kRight, {0, 0.5, 0}, -6)});
    more.release = true;
    each->step(more);
  }
  EXPECT_EQ(further.state().q, session.state().q);
  EXPECT_EQ(further.journal(), session.journal());
}

TEST_F(UnitPieces, StepsTakenBackRestorePiecesPosesAndRemovedElements) {
  Session session(m_folder / "bars.nhdr", m_options);
  std::vector<State> states = {session.state()};
  session.step(parting());
  states.push_back(session.state());
  session.step(step_of({drag_of(kRight, {0, 0, 0}, 8)}));
  states.push_back(session.state());
  Step removal;
  ChosenPart part;
  part.selection = Selection();
  part.selection->rigid_at = Vec3i(7, 8, 7);
  removal.remove = {part};
  EXPECT_EQ(session.step(removal).removed, 7 * 16);
  for (std::size_t n = states.size(); n-- > 0;) {
    ASSERT_TRUE(session.undo());
    const State state = session.state();
    EXPECT_EQ(state.q, states[n].q) << n;
    EXPECT_EQ(state.elements, states[n].elements) << n;
    EXPECT_EQ(state.cuts, states[n].cuts) << n;
    EXPECT_EQ(state.pieces, states[n].pieces) << n;
    EXPECT_EQ(state.piece_records, states[n].piece_records) << n;
  }
}

TEST_F(UnitPieces, WhatIsRemovedIsVoidInTheStateAndAfterIt) {
  Session session(m_folder / "bars.nhdr", m_options);
  session.step(parting());
  session.drag(Vec3i(24, 8, 7), {1, 0, 0});
  const Vec3i kept(24, 8, 7), gone(7, 8, 7);
  const std::int64_t elements = session.body().elements.active_count();
  Step removal;
  ChosenPart part;
  part.selection = Selection();
  part.selection->rigid_at = gone;
  removal.remove = {part};
  session.step(removal);
  EXPECT_EQ(session.body().elements.active_count(), elements - 7 * 16);
  EXPECT_FALSE(session.body().elements.is_active(gone));
  EXPECT_EQ(session.state().density.at(gone), 0);
  EXPECT_EQ(session.state().density.at(kept), 100);
  EXPECT_EQ(session.body().offset(kept, 0), kVoxel);
  ASSERT_EQ(session.body().rigid.list.size(), 1u);
  // What was held still is: it stops the drag of its neighbour.
  EXPECT_LT(session.drag(Vec3i(25, 8, 7), {3, 0, 0}).report.fraction(), 1);
  EXPECT_EQ(session.body().offset(kept, 0), kVoxel);
  session.write_state(m_folder / "removed.vdb");
  Session further(m_folder / "removed.vdb");
  EXPECT_EQ(further.state().elements, session.state().elements);
  EXPECT_EQ(further.state().q, session.state().q);
}

TEST_F(UnitPieces, TwoHandlesOfAPieceMakeTheNearestMotionOrAreRefused) {
  Session session(m_folder / "bars.nhdr", m_options);
  session.step(parting());
  // The ends of the right bar, opposed: a turn about its middle.
  session.step(step_of({drag_of({{13, 8, 7}, {13, 8, 7}}, {0, -0.4, 0}),
                        drag_of({{18, 8, 7}, {18, 8, 7}}, {0, 0.4, 0})}));
  EXPECT_LT(bend(session.body(), {{13, 7, 6}, {18, 10, 9}}), 1e-4);
  EXPECT_NEAR(session.body().offset({18, 8, 7}, 1) / double(kVoxel), 0.4, 0.01);
  const std::string error = input_error([&] {
    session.step(step_of({drag_of({{13, 8, 7}, {13, 8, 7}}, {-2, 0, 0}),
                          drag_of({{18, 8, 7}, {18, 8, 7}}, {2, 0, 0})}));
  });
  EXPECT_NE(error.find("voxel 13,8,7 of 13,8,7"), std::string::npos) << error;
  EXPECT_NE(error.find("mm from the nearest rigid motion"), std::string::npos) << error;
}

TEST_F(UnitPieces, AScaleOfAPieceIsRefused) {
  Session session(m_folder / "bars.nhdr", m_options);
  Step scale = step_of({drag_of(kLeft, {0, 0, 0})});
  scale.drags[0].motion.scale = Vec3d(1.1);
  EXPECT_EQ(input_error([&] { session.step(scale); }),
            "grab 6,7,6:11,10,9: found a scale of rigid piece:6,7,6, expected a shift or a turn");
}

TEST_F(UnitPieces, RelaxationLeavesPiecesWhereTheyAre) {
  Session session(m_folder / "bars.nhdr", m_options);
  session.step(parting());
  session.step(step_of({drag_of(kRight, {1, 0.5, 0}, 8)}));
  const State before = session.state();
  Step relax;
  relax.release = true;  // not held by the handle that turned it
  relax.relax = RelaxParams();
  relax.relax->passes = 30;
  session.step(relax);
  EXPECT_NE(session.state().q, before.q);
  for (const RigidPiece& piece : session.body().rigid.list) {
    piece.elements->for_each([&](Slot slot) {
      for (std::size_t c = 0; c < 3; ++c) {
        ASSERT_EQ(session.body().q[c].at(slot), before.q[c].at(slot));
      }
    });
  }
}

TEST_F(UnitPieces, ACutThroughAPiecePartsIt) {
  Session session(m_folder / "bars.nhdr", m_options);
  session.drag(Vec3i(7, 8, 7), {0.5, 0, 0});
  CutSurface plane;
  plane.in_voxels = true;
  plane.corner = {14.5, -1, -1};
  plane.edge1 = {0, 40, 0};
  plane.edge2 = {0, 0, 40};
  session.cut(plane);
  ASSERT_EQ(session.body().rigid.list.size(), 2u);
  for (const RigidPiece& piece : session.body().rigid.list) {
    EXPECT_EQ(piece.pose.shift_q[0], kVoxel / 2);
  }
  Step apart = step_of({drag_of({{16, 8, 7}, {16, 8, 7}}, {1, 0, 0})});
  apart.release = true;
  session.step(apart);
  EXPECT_EQ(session.body().offset({15, 8, 7}, 0), kVoxel * 3 / 2);
  EXPECT_LT(session.body().offset({14, 8, 7}, 0), kVoxel);
}

TEST_F(UnitPieces, APieceOfBentTissueTakesTheNearestPose) {
  m_options.material->rigid.reset();
  Session session(m_folder / "bars.nhdr", m_options);
  session.drag(Vec3i(18, 8, 7), {0, 3, 0});
  EXPECT_GT(bend(session.body(), kRight), 0.1);
  Step rigid;
  ChosenPart part;
  part.name = "bar";
  part.selection = Selection();
  part.selection->box = kRight;
  rigid.rigid.parts = {part};
  rigid.release = true;
  session.step(rigid);
  EXPECT_LT(bend(session.body(), kRight), 1e-4);
  EXPECT_EQ(check_links(session.body()).violated, 0);
  ASSERT_FALSE(session.messages().empty());
  EXPECT_NE(session.messages().back().find("projected"), std::string::npos);
}

TEST_F(UnitPieces, RandomDragsNeverBendAPiece) {
  Session session(m_folder / "bars.nhdr", m_options);
  session.step(parting());
  std::mt19937 random(9);
  int turned = 0, done = 0;
  for (int n = 0; n < 60; ++n) {
    Step request;
    request.release = true;
    if (n % 3 == 0) request.fix = {{{0, 0, 1}, {29, 2, 15}}};
    Drag drag = drag_of({{0, 0, 0}, {0, 0, 0}}, {pick(random, -2, 2), pick(random, -2, 2), 0});
    const Vec3i at(4 + int(random() % 22), 4 + int(random() % 10), 3 + int(random() % 9));
    drag.region = Region(at);
    if (n % 2 == 0) {
      drag.motion.angle_deg = pick(random, -4, 4);
      drag.motion.axis_lps = Vec3d(pick(random, -1, 1), pick(random, -1, 1), 1);
    }
    request.drags = {drag};
    if (!input_error([&] { session.step(request); }).empty()) continue;
    ++done;
    ASSERT_LT(bend(session.body(), {{6, 7, 6}, {12, 10, 9}}), 1e-4) << n;
    ASSERT_LT(bend(session.body(), {{13, 7, 6}, {18, 10, 9}}), 1e-4) << n;
    ASSERT_EQ(check_links(session.body()).violated, 0) << n;
  }
  for (const RigidPiece& piece : session.body().rigid.list) turned += piece.pose.turn.w < 1;
  EXPECT_GE(done, 40);
  EXPECT_GE(turned, 1);
}

TEST_F(UnitPieces, AJointSpacePartsTissueHalfwayBetweenNearPieces) {
  m_options.material->rigid.reset();
  Step request;
  for (const IndexBox& box : {IndexBox{{6, 7, 6}, {9, 10, 9}}, IndexBox{{14, 7, 6}, {18, 10, 9}}}) {
    ChosenPart part;
    part.selection = Selection();
    part.selection->box = box;
    request.rigid.parts.push_back(part);
  }
  // The gap from 9 to 14 is 5 mm: too far for a joint of 4.5, near enough for one of 5.
  request.rigid.joint_mm = 4.5;
  Session apart(m_folder / "bars.nhdr", m_options);
  apart.step(request);
  EXPECT_EQ(apart.state().cuts.count(), 0);
  request.rigid.joint_mm = 5;
  Session near(m_folder / "bars.nhdr", m_options);
  near.step(request);
  const State state = near.state();
  EXPECT_EQ(state.cuts.count(), 16);  // the links from 11 to 12, halfway, or from 12 to 13
  for (int j = 7; j <= 10; ++j) {
    int cut = 0;
    for (int i = 9; i < 14; ++i) {
      const Vec3i low(i, j, 8);
      cut += state.cuts.is_cut(std::size_t(state.elements.find(low)), brick_offset(low), 0);
    }
    EXPECT_EQ(cut, 1) << j;
  }
}

TEST_F(UnitPieces, RetractionOpensACutLikeAWedgeAndLeavesItsEndsClosed) {
  m_options.material->rigid.reset();
  Session session(m_folder / "bars.nhdr", m_options);
  CutSurface plane;
  plane.in_voxels = true;
  plane.corner = {5, 8.5, 7};
  plane.edge1 = {20, 0, 0};
  plane.edge2 = {0, 0, 12};
  Retraction retraction;
  retraction.corner = plane.corner;
  retraction.edge1 = plane.edge1;
  retraction.edge2 = plane.edge2;
  retraction.in_voxels = true;
  retraction.by_mm = 3;
  retraction.width_mm = 1;
  Step request;
  request.cuts = {plane};
  request.retract = {retraction};
  session.step(request);
  const Body& body = session.body();
  const auto gap = [&](int i, int k) {
    return double(body.offset({i, 9, k}, 1) - body.offset({i, 8, k}, 1)) / kVoxel;
  };
  EXPECT_NEAR(gap(15, 15), 3, 1e-4);  // the middle, at the skin
  EXPECT_GE(gap(15, 11), 3 * 0.5 - 1e-4);
  EXPECT_LT(gap(15, 9), 2.2);
  EXPECT_LE(gap(4, 15), 0.6 + 1e-4);  // before the end: a link, which stretches by 0.6
  EXPECT_EQ(check_links(body).violated, 0);
  // Held: a drag of something else leaves the lips at least so far apart.
  session.drag(Vec3i(15, 2, 7), {0, 0.5, 0});
  EXPECT_GE(gap(15, 15), 3 - 1e-4);
}

TEST_F(UnitPieces, FiniteElementsHoldTheLipsOfARetractionWhereTheyAreDrawn) {
  m_options.material = parse_material(
      "domain = [0, 255]\nactive = [1, 255]\nmax_length = [[0, 1.6]]\nmin_length = [[0, 0.6]]\n"
      "shear = [[0, 0.29]]\nstiffness = [[0, 20]]\n",
      "test");
  Session session(m_folder / "bars.nhdr", m_options);
  CutSurface plane;
  plane.in_voxels = true;
  plane.corner = {5, 8.5, 7};
  plane.edge1 = {20, 0, 0};
  plane.edge2 = {0, 0, 12};
  Step request;
  request.cuts = {plane};
  request.retract.emplace_back();
  Retraction& retraction = request.retract.back();
  retraction.corner = plane.corner;
  retraction.edge1 = plane.edge1;
  retraction.edge2 = plane.edge2;
  retraction.in_voxels = true;
  retraction.by_mm = 3;
  retraction.width_mm = 1;
  request.fix.push_back({{0, 0, 1}, {29, 3, 7}});
  request.fem = FemStep();
  session.step(request);
  const Body& body = session.body();
  const auto gap = [&](int i, int k) {
    return double(body.offset({i, 9, k}, 1) - body.offset({i, 8, k}, 1)) / kVoxel;
  };
  EXPECT_NEAR(gap(15, 15), 3, 1e-4);                          // the middle, at the skin
  EXPECT_NEAR(gap(10, 11), 3 * 4 * 0.25 * 0.75 * 0.5, 1e-4);  // a quarter along, half as deep
  Step by_springs;
  by_springs.springs = SpringStep();
  by_springs.retract = request.retract;
  const std::string error = input_error([&] { session.step(by_springs); });
  EXPECT_NE(error.find("retract: found beside springs"), std::string::npos) << error;
}

TEST_F(UnitPieces, ARetractionBesideAPathOpensInEqualPartsPoseByPose) {
  Session session(m_folder / "bars.nhdr", m_options);
  CutSurface plane;
  plane.in_voxels = true;
  plane.corner = {5, 8.5, 11};
  plane.edge1 = {20, 0, 0};
  plane.edge2 = {0, 0, 8};
  Step request;
  request.cuts = {plane};
  request.retract.emplace_back();
  Retraction& retraction = request.retract.back();
  retraction.corner = plane.corner;
  retraction.edge1 = plane.edge1;
  retraction.edge2 = plane.edge2;
  retraction.in_voxels = true;
  retraction.by_mm = 3;
  retraction.width_mm = 1;
  Drag away{Region({15, 2, 7}, {15, 2, 7}), {0, -0.5, 0}};
  away.way = {{{0.25, 0, 0}, {}}, {{0.25, -0.25, 0}, {}}, {{0, -0.5, 0}, {}}};
  request.drags = {away};
  const StepRecord& record = session.step(request);
  const Body& body = session.body();
  const auto half = [&](int j) { return double(body.offset({15, j, 15}, 1)) / kVoxel; };
  EXPECT_NEAR(half(9), 1.5, 2e-4);
  EXPECT_NEAR(half(8), -1.5, 2e-4);
  EXPECT_EQ(body.offset({15, 2, 7}, 1), -kVoxel / 2);
  EXPECT_EQ(check_links(body).violated, 0);
  // The record has what was asked for.
  ASSERT_EQ(record.retract.size(), 1u);
  EXPECT_EQ(record.retract[0].by_mm, 3);
}

TEST_F(UnitPieces, ARetractionWithoutTissueOnASideIsRefused) {
  Session session(m_folder / "bars.nhdr", m_options);
  Retraction beside;
  beside.place = "scene:3";
  beside.corner = {0, 17.5, 0};
  beside.edge1 = {20, 0, 0};
  beside.edge2 = {0, 0, 20};
  beside.by_mm = 1;
  Step request;
  request.retract = {beside};
  const std::string error = input_error([&] { session.step(request); });
  EXPECT_NE(error.find("scene:3: retract: found no element within 3 mm"), std::string::npos)
      << error;
}

TEST_F(UnitPieces, AMaterialMayMakeRigidWhatABodyDoesNotHave) {
  m_options.material->rigid = std::pair<double, double>(250, 255);
  Session session(m_folder / "bars.nhdr", m_options);
  Step request;
  request.rigid.density = NumberPair(250, 255);  // what a step names must be there
  EXPECT_NE(input_error([&] { session.step(request); }).find("found no element"),
            std::string::npos);
}

TEST(UnitTissuePresets, StandForKeysThatAreNotGiven) {
  const MaterialTable head = read_material("ct-head");
  EXPECT_EQ(head.links, 26);
  ASSERT_TRUE(head.rigid);
  EXPECT_EQ(head.rigid->first, 300);
  EXPECT_EQ(head.active_lo, -300);
  EXPECT_FALSE(head.fits_domain);
  const MaterialTable own = parse_material(
      "preset = \"ct-head\"\nlinks = 6\nrigid = [500, 3100]\n"
      "shear = [[-300, 0.1]]\n",
      "own");
  EXPECT_EQ(own.links, 6);
  EXPECT_EQ(own.rigid->first, 500);
  EXPECT_EQ(own.shear1(0), 0.1);
  EXPECT_EQ(own.min_length(0), head.min_length(0));
  EXPECT_EQ(material_to_toml(parse_material(material_to_toml(own), "text")), material_to_toml(own));
  EXPECT_TRUE(read_material("mr-brain").fits_domain);
  const std::string error = input_error([] { parse_material("preset = \"ct-heat\"\n", "own"); });
  EXPECT_NE(error.find("\"ct-head\""), std::string::npos) << error;
}

/// Takes minutes: run by hand with SUPPLE_CT_HEAD=build/data/ct_head.nhdr (docs/models/rigid.md).
TEST(ExtremesRigid, TwoHundredRandomDragsOfAHeadLeaveBoneRigid) {
  const char* path = std::getenv("SUPPLE_CT_HEAD");
  if (path == nullptr) GTEST_SKIP() << "SUPPLE_CT_HEAD names no head CT";
  SessionOptions options;
  options.material = read_material("ct-head");
  Session session(path, options);
  const Body& body = session.body();
  std::vector<Slot> slots;
  for_each_element(body.elements, [&](Slot slot) { slots.push_back(slot); });
  std::mt19937 random(12);
  double worst_mm = 0, milliseconds = 0;
  int done = 0, turned = 0;
  for (int n = 0; n < 200; ++n) {
    const Vec3i at = voxel_of(body.elements, slots[random() % slots.size()]);
    Step request =
        step_of({drag_of({at, at}, {pick(random, -8, 8), pick(random, -8, 8), pick(random, -8, 8)},
                         n % 4 == 0 ? pick(random, -5, 5) : 0)});
    request.drags[0].motion.axis_lps = Vec3d(pick(random, -1, 1), 1, pick(random, -1, 1));
    request.release = true;
    if (!input_error([&] { session.step(request); }).empty()) continue;
    ++done;
    milliseconds += session.records().back().report.milliseconds;
    for (const RigidPiece& piece : body.rigid.list) {
      // Elements against the motion that fits them best, whatever pose the piece has in mind.
      RigidFit fit;
      const auto now = [&](Slot slot) {
        Vec3d place(voxel_of(body.elements, slot));
        for (int c = 0; c < 3; ++c) place[c] += body.q[std::size_t(c)].at(slot) / double(kVoxel);
        return body.geometry.world_from_index(place);
      };
      const auto rest = [&](Slot slot) {
        return body.geometry.world_from_index(Vec3d(voxel_of(body.elements, slot)));
      };
      piece.elements->for_each([&](Slot slot) { fit.add(rest(slot), now(slot)); });
      const RigidMotion motion = fit.motion();
      piece.elements->for_each([&](Slot slot) {
        worst_mm = std::max(worst_mm, (motion(rest(slot)) - now(slot)).length());
      });
    }
  }
  for (const RigidPiece& piece : body.rigid.list) turned += piece.pose.turn.w < 1;
  std::printf("drags %d of 200, %.1f ms each, turned pieces %d of %zu, worst residual %.2g mm\n",
              done, milliseconds / done, turned, body.rigid.list.size(), worst_mm);
  EXPECT_LE(worst_mm, 1e-3 * 0.957);
  EXPECT_EQ(check_links(body).violated, 0);
  EXPECT_GE(done, 100);
}
