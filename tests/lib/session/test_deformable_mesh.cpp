// Mesh bodies beside the voxel body of a session: forces, limits, one history, states, refusals.
#include <cmath>

#include <gtest/gtest.h>

#include "lib/session/deformable_mesh.h"
#include "lib/session/session.h"
#include "tests/support/errors.h"
#include "tests/support/program.h"
#include "volumes/io/mesh/mesh_writer.h"

using namespace supple;
using namespace supple::test;

namespace {

/// A sheet of triangles in a plane of constant z, a node every `spacing` mm.
LineNetwork sheet(int cells, double spacing, double z) {
  LineNetwork network;
  for (int j = 0; j <= cells; ++j) {
    for (int i = 0; i <= cells; ++i) {
      network.mesh.vertices_lps_mm.emplace_back(i * spacing, j * spacing, z);
    }
  }
  for (int j = 0; j < cells; ++j) {
    for (int i = 0; i < cells; ++i) {
      const int a = j * (cells + 1) + i;
      network.mesh.triangles.push_back({a, a + 1, a + cells + 1});
      network.mesh.triangles.push_back({a + 1, a + cells + 2, a + cells + 1});
    }
  }
  return network;
}

PlacedSelection at(const Vec3d& place) {
  PlacedSelection selection;
  selection.frame = PlaceFrame::lps;
  selection.corners = {place, place};
  return selection;
}

Drag pull(const Vec3d& place, const Vec3d& by) {
  Drag drag;
  PlacedHandle& placed = drag.placed.emplace();
  static_cast<PlacedSelection&>(placed) = at(place);
  placed.by_lps_mm = by;
  return drag;
}

ChosenPart held(const Vec3d& place) {
  ChosenPart part;
  part.placed = at(place);
  return part;
}

SpringStep to_rest() {
  SpringStep springs;
  springs.motion.minimise = true;
  springs.motion.tolerance_mn = 1e-9;
  return springs;
}

class UnitDeformableMesh : public ::testing::Test {
 protected:
  UnitDeformableMesh() {
    write_ball(m_folder, "ball", 24);
    m_options.keeps_undo = true;
  }

  /// A session with these bodies beside a ball.
  std::unique_ptr<Session> session(const std::vector<LineNetwork>& networks) {
    auto opened = std::make_unique<Session>(m_folder / "ball.nhdr", m_options);
    for (std::size_t n = 0; n < networks.size(); ++n) {
      MeshSetup setup;
      setup.name = "body" + std::to_string(n);
      setup.path = m_folder / (setup.name + ".obj");
      write_mesh(setup.path, networks[n]);
      setup.fixes_rim = m_fixes_rim;
      opened->add(setup);
    }
    return opened;
  }

  Step step_of(const std::string& body) const {
    Step step;
    step.body = body;
    return step;
  }

  TemporaryFolder m_folder;
  SessionOptions m_options;
  bool m_fixes_rim = false;
};

}  // namespace

TEST_F(UnitDeformableMesh, AStringPulledAcrossHasTheForceOfItsTwoSprings) {
  LineNetwork string;
  string.mesh.vertices_lps_mm = {{0, 0, 0}, {10, 0, 0}, {20, 0, 0}};
  string.lines = {{0, 1}, {1, 2}};
  const auto opened = session({string});
  Step step = step_of("body0");
  step.fix = {held({0, 0, 0}), held({20, 0, 0})};
  step.drags = {pull({10, 1, 0}, {0, 5, 0})};
  step.springs = to_rest();
  const StepRecord& record = opened->step(step);
  const double length = std::sqrt(125.0);
  const double force_mn = 2 * 100 * (length - 10) * 5 / length;
  ASSERT_EQ(record.mesh->report.reactions.size(), 1u);
  EXPECT_NEAR(record.mesh->report.reactions[0].force_n.y, -force_mn / 1000, 1e-9);
  EXPECT_NEAR(opened->meshes()[0].body().pos_mm[1].y, 5, 1e-12);
}

TEST_F(UnitDeformableMesh, ChainMailMovesItAsTheSolverAlone) {
  LineNetwork chain;
  for (int n = 0; n < 20; ++n) chain.mesh.vertices_lps_mm.emplace_back(10.0 * n, 0, 0);
  for (int n = 0; n < 19; ++n) chain.lines.push_back({n, n + 1});
  const auto opened = session({chain});
  Step step = step_of("body0");
  step.fix = {held({0, 0, 0})};
  step.drags = {pull({190, 0, 0}, {45, 0, 0})};
  const StepRecord& record = opened->step(step);

  MeshBody body = make_mesh_body(chain);
  MeshEcm ecm(body, opened->meshes()[0].setup().limits);
  const MeshEcmReport alone = ecm.drag({{{19}, {45, 0, 0}}}, {{0}});
  EXPECT_EQ(opened->meshes()[0].body().pos_mm, body.pos_mm);
  EXPECT_EQ(record.mesh->report.ecm.fraction(), alone.fraction());
  EXPECT_LT(alone.fraction(), 1);
  ASSERT_EQ(opened->messages().size(), 2u);  // the first: no material is given
  EXPECT_NE(opened->messages()[1].find("body \"body0\": what is held stopped the drag at"),
            std::string::npos);
}

TEST_F(UnitDeformableMesh, BodiesHaveOneHistory) {
  m_fixes_rim = true;
  const auto opened = session({sheet(6, 4, 0), sheet(5, 5, 30)});
  const auto places = [&](std::size_t n) { return opened->meshes()[n].body().pos_mm; };
  const std::vector<Vec3d> first = places(0), second = places(1);
  const std::string journal = opened->journal();
  Step push = step_of("body0");
  push.drags = {pull({12, 12, 0}, {0, 0, 3})};
  push.springs = to_rest();
  opened->step(push);
  const std::vector<Vec3d> pushed = places(0);
  opened->drag(Region(Vec3i(12, 12, 16)), {0, 0, 2});
  const std::string between = opened->journal();
  Step other = step_of("body1");
  other.drags = {pull({10, 10, 30}, {1, 0, 0})};
  opened->step(other);
  EXPECT_NE(places(1), second);
  EXPECT_EQ(opened->records().size(), 3u);
  EXPECT_EQ(opened->undo_steps(), 3u);

  EXPECT_TRUE(opened->undo());
  EXPECT_EQ(places(1), second);
  EXPECT_EQ(places(0), pushed);
  EXPECT_EQ(opened->journal(), between);
  EXPECT_TRUE(opened->undo());
  EXPECT_TRUE(opened->state().q[2].empty());
  EXPECT_EQ(places(0), pushed);
  EXPECT_TRUE(opened->undo());
  EXPECT_EQ(places(0), first);
  EXPECT_EQ(opened->journal(), journal);
  EXPECT_FALSE(opened->undo());
}

TEST_F(UnitDeformableMesh, AStateContinuesWithItsBodies) {
  m_fixes_rim = true;
  const auto opened = session({sheet(6, 4, 0)});
  Step step = step_of("body0");
  step.drags = {pull({12, 12, 0}, {0, 0, 3})};
  step.springs.emplace().time_s = 0.02;
  opened->step(step);
  opened->write_state(m_folder / "a.vdb");
  SessionOptions options;
  options.keeps_undo = true;
  Session continued(m_folder / "a.vdb", options);
  ASSERT_EQ(continued.meshes().size(), 1u);
  const DeformableMesh& before = opened->meshes()[0];
  const DeformableMesh& after = continued.meshes()[0];
  EXPECT_EQ(after.record(), before.record());
  EXPECT_FALSE(before.body().velocity_mm_s.empty());
  EXPECT_EQ(after.body().velocity_mm_s, before.body().velocity_mm_s);
  // Both go on alike.
  opened->step(step);
  continued.step(step);
  EXPECT_EQ(after.body().pos_mm, before.body().pos_mm);
}

TEST_F(UnitDeformableMesh, AStateWithoutBodiesKnowsNothingOfThem) {
  Session alone(m_folder / "ball.nhdr", m_options);
  alone.write_state(m_folder / "a.vdb");
  EXPECT_EQ(read_text(m_folder / "a.vdb").find("bodies"), std::string::npos);
  const auto opened = session({sheet(2, 4, 0)});
  opened->write_state(m_folder / "b.vdb");
  EXPECT_NE(read_text(m_folder / "b.vdb").find("bodies"), std::string::npos);
}

TEST_F(UnitDeformableMesh, AStepThatIsCancelledLeavesItAsItWas) {
  class Stopped final : public Progress {
   public:
    void stage(std::string_view) override {}
    void update(double done) override { m_is_cancelled = done > 0.5; }
    bool cancelled() const override { return m_is_cancelled; }

   private:
    bool m_is_cancelled = false;
  };
  m_fixes_rim = true;
  const auto opened = session({sheet(6, 4, 0)});
  Step step = step_of("body0");
  step.drags = {pull({12, 12, 0}, {0, 0, 3})};
  step.springs.emplace().time_s = 0.5;
  const Value before = opened->meshes()[0].record();
  Stopped stopped;
  EXPECT_THROW(opened->step(step, &stopped), Cancelled);
  EXPECT_EQ(opened->meshes()[0].record(), before);
  EXPECT_EQ(opened->undo_steps(), 0u);
  EXPECT_TRUE(opened->records().empty());
}

TEST_F(UnitDeformableMesh, BoxesAndBallsChooseTheNodesInside) {
  m_fixes_rim = false;
  const auto opened = session({sheet(6, 4, 0)});
  Step step = step_of("body0");
  step.fix.emplace_back().placed.emplace();
  PlacedSelection& box = *step.fix[0].placed;
  box.frame = PlaceFrame::ras;
  box.corners = {Vec3d(0, 0, -1), Vec3d(-8, -24, 1)};  // LPS x from 0 to 8
  Drag& drag = step.drags.emplace_back();
  PlacedHandle& ball = drag.placed.emplace();
  ball.frame = PlaceFrame::lps;
  ball.ball = Vec3d(24, 24, 0);
  ball.radius_mm = 4.5;
  ball.by = Vec3d(0, 0, 1);
  const StepRecord& record = opened->step(step);
  EXPECT_EQ(record.mesh->move.fix.size(), 3u * 7u);
  EXPECT_EQ(record.mesh->move.handles[0].nodes.size(), 3u);
  for (const int node : record.mesh->move.fix) {
    EXPECT_EQ(opened->meshes()[0].body().pos_mm[std::size_t(node)],
              opened->meshes()[0].body().rest_mm[std::size_t(node)]);
  }
}

TEST_F(UnitDeformableMesh, WhatAMeshDoesNotKnowIsRefusedByName) {
  const auto opened = session({sheet(3, 4, 0)});
  const auto field_of = [&](const std::function<void(Step&)>& change) {
    Step step = step_of("body0");
    step.drags = {pull({0, 0, 0}, {0, 0, 1})};
    change(step);
    try {
      opened->step(step);
    } catch (const InputError& error) {
      return error.problem().field;
    }
    return std::string("nothing");
  };
  const std::vector<Vec3d> before = opened->meshes()[0].body().pos_mm;
  EXPECT_EQ(field_of([](Step& step) { step.cuts.emplace_back(); }), "cut");
  EXPECT_EQ(field_of([](Step& step) { step.relax.emplace(); }), "relax");
  EXPECT_EQ(field_of([](Step& step) { step.fem.emplace(); }), "model");
  EXPECT_EQ(field_of([](Step& step) { step.limits = Limits::ball; }), "limits");
  EXPECT_EQ(field_of([](Step& step) { step.drags[0].placed->rotate_deg = 10; }), "rotate");
  EXPECT_EQ(field_of([](Step& step) { step.drags[0].soft_mm = 3; }), "soft");
  EXPECT_EQ(field_of([](Step& step) {
              step.drags[0].placed->density = NumberPair{0, 1};
            }),
            "density");
  EXPECT_EQ(field_of([](Step& step) { step.body = "bodyO"; }), "body");
  EXPECT_EQ(field_of([](Step& step) { step.springs.emplace().structural_n_m = 1; }), "structural");
  EXPECT_EQ(field_of([](Step&) {}), "nothing");
  EXPECT_TRUE(opened->undo());
  EXPECT_EQ(opened->meshes()[0].body().pos_mm, before);
}
