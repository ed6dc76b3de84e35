// Sessions: the whole job without a window, its journal, and steps taken back.
#include <gtest/gtest.h>

#include "lib/material/material.h"
#include "lib/relax/cell_moduli.h"
#include "lib/relax/reaction.h"
#include "lib/session/file/step_keys.h"
#include "lib/session/session.h"
#include "tests/lib/test_bodies.h"
#include "tests/support/program.h"
#include "volumes/base/json.h"

using namespace supple;
using namespace supple::test;

namespace {

/// Collects what a session says, and cancels when asked to.
class Heard final : public Progress {
 public:
  void stage(std::string_view name) override { stages.emplace_back(name); }
  void update(double) override {}
  bool cancelled() const override { return is_cancelled; }
  void warn(const std::string& line) override { warnings.push_back(line); }

  std::vector<std::string> stages, warnings;
  bool is_cancelled = false;
};

class UnitSession : public ::testing::Test {
 protected:
  UnitSession() {
    write_ball(m_folder, "ball", 24);
    m_options.keeps_undo = true;
  }

  TemporaryFolder m_folder;
  std::string m_ball = m_folder / "ball.nhdr";
  SessionOptions m_options;
};

const Vec3i kGrabbed(12, 12, 16);

}  // namespace

TEST_F(UnitSession, ForcesOfCellsFollowAMaterialThatChanges) {
  std::string voxels;
  for (int n = 0; n < 8 * 8 * 12; ++n) voxels += char(n % 8 < 4 ? 50 : 120);
  write_text(m_folder / "block.raw", voxels);
  write_text(m_folder / "block.nhdr",
             "NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\n"
             "sizes: 8 8 12\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n"
             "space origin: (0,0,0)\nencoding: raw\ndata file: block.raw\n");
  const auto material = [](const std::string& stiffness) {
    return parse_material(
        "domain = [0, 255]\nactive = [1, 255]\nmax_length = [[0, 3]]\n"
        "min_length = [[0, 0.1]]\nshear = [[0, 2]]\npoisson = [[0, 0.45]]\n"
        "stiffness = " +
            stiffness + "\n",
        "test");
  };
  m_options.material = material("[[80, 1], [90, 40]]");
  Session session(m_folder / "block.nhdr", m_options);
  Step request;
  request.fix.push_back({{0, 0, 0}, {7, 7, 0}});
  request.drags.push_back({Region({0, 0, 11}, {7, 7, 11}), {0, 0, 1}});
  request.relax = RelaxParams();
  request.relax->poisson = true;
  request.tells_reactions = true;
  const StepRecord relaxed = session.step(request);
  ASSERT_EQ(relaxed.reactions.size(), 1u);
  Step change;
  change.material = material("[[80, 20], [90, 1]]");
  change.tells_reactions = true;
  const StepRecord record = session.step(change);
  ASSERT_EQ(record.reactions.size(), 1u);
  const Body& body = session.body();
  const SlotSet end = elements_of(body, Region({0, 0, 11}, {7, 7, 11}), "grab");
  const SlotSet fixed = elements_of(body, Region({0, 0, 0}, {7, 7, 0}), "fix");
  const Vec3d expected =
      reactions(body, {end}, fixed, {end, {}, {}}, moduli_by_poisson(body))[0].force_n;
  EXPECT_LT(expected.z, -0.01);
  EXPECT_LT((record.reactions[0].reaction.force_n - expected).length(), 1e-9 * expected.length());

  // A drag that is not relaxed has springs alone; taken back, cells press as they did.
  ASSERT_TRUE(session.undo());
  Step drag;
  drag.drags.push_back({Region({0, 0, 11}, {7, 7, 11}), {0, 0, 0.5}});
  drag.tells_reactions = true;
  const StepRecord dragged = session.step(drag);
  const Vec3d of_springs = reactions(body, {end}, fixed, {end, {}, {}})[0].force_n;
  EXPECT_LT((dragged.reactions[0].reaction.force_n - of_springs).length(),
            1e-9 * of_springs.length());
  ASSERT_TRUE(session.undo());
  Step nothing;
  nothing.tells_reactions = true;
  EXPECT_EQ(session.step(nothing).reactions[0].reaction.force_n,
            relaxed.reactions[0].reaction.force_n);
}

TEST_F(UnitSession, StepsTakenBackLeaveTheStateBitForBit) {
  Session session(m_ball, m_options);
  std::vector<State> states = {session.state()};
  session.fix({{4, 4, 8}, {20, 20, 9}});
  states.push_back(session.state());
  session.drag(kGrabbed, {0, 3, 0});
  states.push_back(session.state());
  session.relax(RelaxParams());
  states.push_back(session.state());
  CutSurface plane;
  plane.in_voxels = true;
  plane.corner = {-1, -1, 12.5};
  plane.edge1 = {40, 0, 0};
  plane.edge2 = {0, 40, 0};
  EXPECT_GT(session.cut(plane).cut_links, 0);
  for (std::size_t n = states.size(); n-- > 0;) {
    ASSERT_TRUE(session.undo());
    const State state = session.state();
    EXPECT_EQ(state.q, states[n].q) << n;
    EXPECT_EQ(state.cuts, states[n].cuts) << n;
    EXPECT_EQ(state.anchors, states[n].anchors) << n;
    EXPECT_EQ(state.configuration, states[n].configuration) << n;
  }
  EXPECT_FALSE(session.undo());
}

TEST_F(UnitSession, AfterAStepTakenBackTheNextOneIsAsIfItHadNotBeen) {
  Session straight(m_ball, m_options), detour(m_ball, m_options);
  detour.drag(kGrabbed, {2, -1, 0});
  ASSERT_TRUE(detour.undo());
  straight.drag(kGrabbed, {0, 3, 1});
  detour.drag(kGrabbed, {0, 3, 1});
  EXPECT_EQ(straight.state().q, detour.state().q);
  EXPECT_EQ(straight.journal(), detour.journal());
}

TEST_F(UnitSession, AMotionAfterAStepTakenBackBeginsAtTheNodesOfFiniteElements) {
  Step pull;
  pull.fix = {{{0, 0, 0}, {23, 23, 7}}};
  pull.drags.push_back({kGrabbed, {0, 2, 0}});
  pull.fem.emplace().keeps_nodes = true;
  Step swing;
  swing.release = true;
  swing.fix = pull.fix;
  swing.fem.emplace().motion.emplace().time_s = 0.01;
  swing.fem->motion->step_s = 2e-3;
  const auto swung_after = [&](int detours) {
    Session session(m_ball, m_options);
    session.step(pull);
    for (int n = 0; n < detours; ++n) session.drag(kGrabbed, {0, 0, 1});
    for (int n = 0; n < detours; ++n) EXPECT_TRUE(session.undo());
    session.step(swing);
    const auto q = session.state().q;
    while (session.undo()) continue;
    EXPECT_EQ(session.undo_bytes(), 0u);
    return q;
  };
  const auto straight = swung_after(0);
  EXPECT_EQ(swung_after(1), straight);
  EXPECT_EQ(swung_after(2), straight);
}

TEST_F(UnitSession, AStateIsContinuedWithItsJournalAndAnchors) {
  Session session(m_ball, m_options);
  session.fix({{4, 4, 8}, {20, 20, 9}});
  session.drag(kGrabbed, {0, 2, 0});
  session.write_state(m_folder / "ball.vdb");
  Session further(m_folder / "ball.vdb", m_options);
  EXPECT_EQ(further.state().q, session.state().q);
  EXPECT_EQ(further.journal(), session.journal());
  further.drag(kGrabbed, {0, 1, 0});
  session.drag(kGrabbed, {0, 1, 0});
  EXPECT_EQ(further.state().anchors, session.state().anchors);
  EXPECT_EQ(further.journal(), session.journal());
}

TEST_F(UnitSession, WarningsAreToldAndKeptAndNothingIsPrinted) {
  Heard heard;
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  Session session(m_ball, m_options, &heard);
  session.drag(kGrabbed, {0, 2, 0}, &heard);
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  ASSERT_FALSE(session.messages().empty());
  EXPECT_NE(session.messages()[0].find("no material given"), std::string::npos);
  EXPECT_EQ(session.messages(), heard.warnings);
  EXPECT_FALSE(heard.stages.empty());
}

TEST_F(UnitSession, ACancelledStepLeavesTheBodyAsItWas) {
  Session session(m_ball, m_options);
  session.drag(kGrabbed, {0, 2, 0});
  const State before = session.state();
  Heard heard;
  heard.is_cancelled = true;
  EXPECT_THROW(session.drag(kGrabbed, {0, 2, 0}, &heard), Cancelled);
  EXPECT_EQ(session.state().q, before.q);
  EXPECT_EQ(session.journal(), before.configuration);
}

TEST_F(UnitSession, WithoutUndoNothingIsKeptAndUndoIsAnError) {
  Session session(m_ball);
  session.drag(kGrabbed, {0, 2, 0});
  EXPECT_THROW(session.undo(), std::logic_error);
}

TEST_F(UnitSession, OnlyStepsThatCutKeepTheCutsThatWereThereBefore) {
  Session session(m_ball, m_options);
  CutSurface plane;
  plane.in_voxels = true;
  plane.corner = {-1, -1, 12.5};
  plane.edge1 = {40, 0, 0};
  plane.edge2 = {0, 40, 0};
  session.cut(plane);
  const LinkCuts first = session.body().cuts;
  const std::size_t after_first = session.undo_bytes();
  session.release();
  const std::size_t of_release = session.undo_bytes() - after_first;
  EXPECT_LT(of_release, first.bytes() / 4);
  plane.corner = {12.5, -1, -1};
  plane.edge1 = {0, 0, 40};
  session.cut(plane);
  EXPECT_GE(session.undo_bytes() - after_first - of_release, first.bytes());
  for (int n = 0; n < 2; ++n) {
    ASSERT_TRUE(session.undo());
    EXPECT_EQ(session.body().cuts, first) << n;
  }
  EXPECT_EQ(session.undo_bytes(), after_first);
  ASSERT_TRUE(session.undo());
  EXPECT_TRUE(session.body().cuts.empty());
  EXPECT_EQ(session.undo_bytes(), 0u);
}

TEST_F(UnitSession, HandlesArePlacedInTheMiddleOfTheirElements) {
  const Session session(m_ball, m_options);
  Selection ball;
  ball.ball_index = Vec3d(12, 12, 16);
  ball.radius_mm = 2.5;
  Step step;
  for (const Vec3i& voxel : {Vec3i(12, 12, 16), Vec3i(10, 14, 12), Vec3i(10, 14, 12)}) {
    step.drags.push_back({Region(IndexBox{voxel, voxel}), {1, 0, 0}});
  }
  step.drags.back().selection = ball;
  const std::vector<HandlePlace> places = session.places(step);
  ASSERT_EQ(places.size(), step.drags.size());
  const Vec3d expected[] = {{12, 12, 16}, {10, 14, 12}, {12, 12, 16}};
  for (std::size_t n = 0; n < places.size(); ++n) {
    EXPECT_LT((places[n].centre_index - expected[n]).length(), 1e-9) << places[n].centre_index;
  }
  EXPECT_EQ(places[0].elements, 1);
  EXPECT_GT(places[2].elements, 30);
}

TEST_F(UnitSession, PlacesOfAStepAreTheSameInEveryFrameAndOnTheGrid) {
  const IndexBox anchor{{4, 4, 8}, {20, 20, 9}};
  Session gridded(m_ball, m_options);
  Step plain;
  plain.drags.push_back({Region(kGrabbed), {1, -0.5, 2}});
  plain.fix.push_back(anchor);
  Selection gone;
  gone.box = IndexBox{{12, 12, 4}, {12, 12, 5}};
  plain.remove.emplace_back().selection = gone;
  gridded.step(plain);
  const Geometry& geometry = gridded.geometry();
  for (const PlaceFrame frame : {PlaceFrame::voxel, PlaceFrame::lps, PlaceFrame::ras}) {
    const auto placed = [&](const Vec3i& voxel) {
      const Vec3d lps = geometry.world_from_index(Vec3d(voxel));
      if (frame == PlaceFrame::voxel) return Vec3d(voxel);
      return frame == PlaceFrame::lps ? lps : Vec3d(-lps.x, -lps.y, lps.z);
    };
    const auto take = [&](const IndexBox& box, PlacedSelection& selection) {
      selection.frame = frame;
      selection.corners = {placed(box.lo), placed(box.hi)};
    };
    Step step;
    step.place = "a.toml:7";
    take({kGrabbed, kGrabbed}, step.drags.emplace_back().placed.emplace());
    step.drags.back().placed->by_lps_mm =
        geometry.world_vector_from_index(Vec3d(1, -0.5, 2) / geometry.spacing_mm());
    take(anchor, step.fix.emplace_back().placed.emplace());
    take({{12, 12, 4}, {12, 12, 5}}, step.remove.emplace_back().placed.emplace());
    Session session(m_ball, m_options);
    session.check(step);
    EXPECT_EQ(session.places(step)[0].centre_index, Vec3d(kGrabbed));
    const StepRecord& record = session.step(step);
    EXPECT_EQ(session.state().q, gridded.state().q);
    EXPECT_EQ(session.state().anchors, gridded.state().anchors);
    EXPECT_EQ(record.removed, 2);
    EXPECT_FALSE(record.drags.front().placed || record.fix.front().placed)
        << "a record is on the grid";
    step.drags.back().placed->corners = {placed({0, 0, 0}), placed({0, 0, 0})};
    try {
      session.step(step);
      ADD_FAILURE() << "a voxel in the air";
    } catch (const InputError& error) {
      EXPECT_EQ(error.problem().file, "a.toml:7");
    }
  }
}

TEST_F(UnitSession, AProgramReadsAStepFromAnyTableWithItsKeys) {
  const Value handle = {{"grab", {12, 12, 16}}, {"soft", 2}, {"by", {1, -0.5, 2}}};
  const Value anchor = {{"grab_ball", {12, 12, 6}}, {"radius", 2}};
  const Value keys = {{"handles", Value::List{handle}},
                      {"anchors", Value::List{anchor}},
                      {"fix", Value::List{Value(Vec3i(12, 12, 9))}},
                      {"fix_density", {1, 10}}};
  Table table(keys, "host");
  const Step step = read_step(table, {});
  EXPECT_EQ(step.keys, keys);
  EXPECT_EQ(step.drags.front().placed->keys, Value({{"grab", {12, 12, 16}}, {"soft", 2}}));
  ASSERT_EQ(step.fix.size(), 3u);
  EXPECT_EQ(step.fix[0].box()->lo, Vec3i(12, 12, 9));
  EXPECT_EQ(step.fix[1].placed->keys, anchor);
  EXPECT_EQ(step.fix[2].placed->keys, Value({{"grab_density", {1.0, 10.0}}}));
  // The session that it asks holds the ball and the box, and a journal has boxes first.
  Session session(m_ball, m_options);
  session.step(step);
  const Value journal = parse_json(session.journal())["steps"].front();
  std::vector<std::string> names;
  for (const auto& [name, value] : journal.entries()) names.push_back(name);
  EXPECT_EQ(std::vector<std::string>(names.begin(), names.begin() + 3),
            (std::vector<std::string>{"handles", "fix", "anchors"}));
  EXPECT_EQ(journal["anchors"].size(), 2u);
}

TEST_F(UnitSession, AJournalListsBoxesBeforeOtherAnchorsWhateverTheirOrder) {
  Step step;
  Selection ball;
  ball.ball_index = Vec3d(12, 12, 6);
  ball.radius_mm = 2;
  step.fix.emplace_back().selection = ball;
  step.fix.push_back({{12, 12, 9}, {12, 12, 9}});
  Session session(m_ball, m_options);
  session.step(step);
  const std::string journal = session.journal();
  EXPECT_LT(journal.find("\"fix\""), journal.find("\"anchors\"")) << journal;
}

TEST_F(UnitSession, AHandleThatSlidesGoesOnAlongTheAxesThatAreFree) {
  const Vec3d by(0.6, -0.4, 9);
  const auto dragged = [&](const Vec3d& by_mm, bool slides) {
    Session session(m_ball, m_options);
    session.fix({{4, 4, 8}, {20, 20, 9}});
    Step request;
    request.drags.push_back({Region(kGrabbed), by_mm});
    request.drags[0].slides = slides;
    const StepRecord record = session.step(request);
    Vec3d reached;
    for (int c = 0; c < 3; ++c) reached[c] = double(session.body().offset(kGrabbed, c)) / kVoxel;
    reached *= session.geometry().spacing_mm();
    return std::tuple(record, reached, session.state().q);
  };
  const auto [stopped, there, q_there] = dragged(by, false);
  EXPECT_FALSE(stopped.slid);
  EXPECT_LT(stopped.report.fraction(), 0.5);
  EXPECT_NEAR(there.x, 0.6 * stopped.report.fraction(), 1e-4);
  const auto [slid, reached, q] = dragged(by, true);
  ASSERT_TRUE(slid.slid);
  EXPECT_EQ(slid.report.fraction(), stopped.report.fraction());
  EXPECT_EQ(slid.slid->x, 1);
  EXPECT_EQ(slid.slid->y, 1);
  EXPECT_NEAR(slid.slid->z, stopped.report.fraction(), 1e-4);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(reached[c], way_done(slid, by)[c], 1e-4) << c;
  // Axes know nothing of each other, so that each is where a drag along it alone ends.
  for (int c = 0; c < 2; ++c) {
    Vec3d alone(0.0);
    alone[c] = by[c];
    EXPECT_NEAR(std::get<1>(dragged(alone, false))[c], reached[c], 1e-4) << c;
  }
  // A drag that nothing stops is as without it.
  EXPECT_EQ(std::get<2>(dragged({0.6, -0.4, 1}, true)),
            std::get<2>(dragged({0.6, -0.4, 1}, false)));
}

TEST_F(UnitSession, ADragAlongOneAxisCreatesNoOtherCoordinate) {
  Session session(m_ball, {});
  session.drag(kGrabbed, {0, 3, 0});
  const Body& body = session.body();
  EXPECT_GT(body.q[1].stored_bricks(), 0u);
  for (const std::size_t other : {0, 2}) EXPECT_EQ(body.q[other].bytes(), 0u) << other;
  EXPECT_EQ(session.state().q[0].bytes(), 0u);
}

TEST_F(UnitSession, WithoutRelaxationThereIsNoStiffness) {
  const auto relaxes = [&](bool asked) {
    Session session(m_ball, {});
    Heard heard;
    Step request;
    request.drags.push_back({Region(kGrabbed), {0, 3, 0}});
    if (asked) request.relax = RelaxParams();
    session.step(request, &heard);
    // Relaxation leaves fractions beside the offsets.
    EXPECT_EQ(session.body().fraction[1].stored_bricks() > 0, asked);
    return std::count(heard.stages.begin(), heard.stages.end(), "relaxing") > 0;
  };
  EXPECT_FALSE(relaxes(false));
  EXPECT_TRUE(relaxes(true));
}
