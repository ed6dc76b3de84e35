// Treatment by Enhanced ChainMail of links that finite elements left beyond their limits.
#include <algorithm>
#include <cstdlib>
#include <memory>

#include <gtest/gtest.h>

#include "lib/material/material.h"
#include "lib/session/session.h"
#include "tests/support/program.h"

using namespace supple;
using namespace supple::test;

namespace {

constexpr int kEdge = 16;

/// A block of soft tissue with narrow limits, its lower face held and its upper one pulled and
/// sheared far beyond them by finite elements.
class UnitBeyondLimits : public ::testing::Test {
 protected:
  UnitBeyondLimits() {
    write_text(m_folder / "block.raw", std::string(std::size_t(kEdge * kEdge * kEdge), char(100)));
    write_text(m_folder / "block.nhdr",
               "NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\n"
               "sizes: 16 16 16\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n"
               "space origin: (0,0,0)\nencoding: raw\ndata file: block.raw\n");
    m_options.keeps_undo = true;
    m_options.material = parse_material(
        "domain = [0, 255]\nactive = [1, 255]\nmax_length = [[0, 1.1]]\nmin_length = [[0, 0.9]]\n"
        "shear = [[0, 0.1]]\nstiffness = [[0, 20]]\nlinks = 26\n",
        "test");
  }

  std::unique_ptr<Session> pulled(LinksBeyond beyond) {
    auto session = std::make_unique<Session>(m_folder / "block.nhdr", m_options);
    Step request;
    request.fix.push_back({{0, 0, 0}, {15, 15, 0}});
    request.drags = {Drag{Region({6, 6, 15}, {9, 9, 15}), {0.3, 0, 4}}};
    request.fem = FemStep();
    request.fem->links_beyond = beyond;
    session->step(request);
    EXPECT_GT(check_links(session->body()).violated, 0);
    return session;
  }

  /// The largest change of an offset in voxels.
  static double largest_change(const Body& body, const std::array<BrickValues, 3>& before) {
    double largest = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t slot = 0; slot < body.elements.brick_count() * kBrickVoxels; ++slot) {
        const double change = double(body.q[c].at(slot)) - before[c].at(slot);
        largest = std::max(largest, std::abs(change) / kFixedOne);
      }
    }
    return largest;
  }

  TemporaryFolder m_folder;
  SessionOptions m_options;
};

constexpr double kLittle_mm = 0.01;
const Vec3i kAside(2, 13, 8);

}  // namespace

TEST_F(UnitBeyondLimits, AreProjectedByTheNextDragUnlessTheyAreKept) {
  const auto jump = [&](LinksBeyond beyond) {
    const auto session = pulled(beyond);
    const std::array<BrickValues, 3> before = session->body().q;
    session->drag(kAside, {kLittle_mm, 0, 0});
    return largest_change(session->body(), before);
  };
  EXPECT_GT(jump(LinksBeyond::project), 0.1);
  EXPECT_LE(jump(LinksBeyond::keep), kLittle_mm + 1e-4);
}

TEST_F(UnitBeyondLimits, DragsGoOnFromWhatIsKeptAndMakeNoLinkWorse) {
  const auto session = pulled(LinksBeyond::keep);
  const LinkCheck before = check_links(session->body());
  const std::int32_t was = session->body().offset(kAside, 0);
  session->drag(kAside, {0.25, 0, 0});
  EXPECT_EQ(session->body().offset(kAside, 0) - was, kFixedOne / 4);
  EXPECT_GT(session->records().back().report.moved, 100);  // tissue follows
  EXPECT_LE(check_links(session->body()).worst_excess_voxels, before.worst_excess_voxels + 1e-4);
  // What is held stays.
  EXPECT_EQ(session->body().offset({7, 7, 15}, 2), 4 * kFixedOne);
  EXPECT_EQ(session->body().offset({7, 7, 0}, 2), 0);
}

TEST_F(UnitBeyondLimits, UndoAndSoftHandlesKnowWhatIsKept) {
  const auto session = pulled(LinksBeyond::keep);
  const std::array<BrickValues, 3> before = session->body().q;
  Step soft;
  soft.drags = {Drag{Region(kAside), {1, 0, 0}}};
  soft.drags[0].selection = Selection();
  soft.drags[0].selection->box = IndexBox{kAside, kAside};
  soft.drags[0].soft_mm = 4;
  session->step(soft);
  const std::array<BrickValues, 3> once = session->body().q;
  session->step(soft);
  ASSERT_TRUE(session->undo());
  EXPECT_EQ(largest_change(session->body(), once), 0);
  ASSERT_TRUE(session->undo());
  EXPECT_EQ(largest_change(session->body(), before), 0);
  session->step(soft);
  EXPECT_EQ(largest_change(session->body(), once), 0);
}

TEST_F(UnitBeyondLimits, SidesThatWerePressedIntoEachOtherDoNotStopOtherDrags) {
  for (const LinksBeyond beyond : {LinksBeyond::project, LinksBeyond::keep}) {
    Session session(m_folder / "block.nhdr", m_options);
    Step request;
    request.cuts.emplace_back();
    CutSurface& plane = request.cuts.back();
    plane.in_voxels = true;
    plane.corner = {-1, -1, 7.5};
    plane.edge1 = {10, 0, 0};
    plane.edge2 = {0, 20, 0};
    request.fix.push_back({{0, 0, 0}, {15, 15, 7}});
    request.drags = {Drag{Region({0, 0, 8}, {5, 15, 8}), {0, 0, -0.2}}};
    request.fem = FemStep();
    request.fem->links_beyond = beyond;
    session.step(request);
    EXPECT_GT(session.records().back().contact.left, 0);
    const std::int32_t was = session.body().offset({14, 8, 14}, 0);
    session.drag(Vec3i(14, 8, 14), {0.25, 0, 0});
    EXPECT_EQ(session.body().offset({14, 8, 14}, 0) - was, kFixedOne / 4);
    EXPECT_EQ(session.records().back().contact.parts, kContactParts);
    session.drag(Vec3i(2, 8, 8), {0, 0, -0.25});
    EXPECT_LT(session.records().back().contact.parts, kContactParts);
  }
}

TEST_F(UnitBeyondLimits, AStateIsContinuedAsTheSessionIs) {
  const auto session = pulled(LinksBeyond::keep);
  session->drag(kAside, {1, 0, 0});
  const std::string path = m_folder / "state.vdb";
  write_state(path, session->state());
  SessionOptions options;
  const auto continued = std::make_unique<Session>(path, options);
  EXPECT_EQ(largest_change(continued->body(), session->body().q), 0);
  session->drag(kAside, {1.5, 0.5, 0});
  continued->drag(kAside, {1.5, 0.5, 0});
  EXPECT_EQ(largest_change(continued->body(), session->body().q), 0);
}

TEST_F(UnitBeyondLimits, ARelaxationProjectsThem) {
  const auto session = pulled(LinksBeyond::keep);
  session->drag(kAside, {kLittle_mm, 0, 0});
  RelaxParams params;
  params.passes = 4;
  const StepRecord& record = session->relax(params);
  EXPECT_GT(record.relaxed.projected_links, 0);
  EXPECT_EQ(check_links(session->body()).violated, 0);
}

TEST_F(UnitBeyondLimits, ACancelIsHeardWhileTheyAreFound) {
  class StopWhereTheyAreFound final : public Progress {
   public:
    void stage(std::string_view name) override {
      m_is_there = name == "keeping links beyond limits";
    }
    void update(double) override {}
    bool cancelled() const override { return m_is_there; }

   private:
    bool m_is_there = false;
  } stop;
  Session session(m_folder / "block.nhdr", m_options);
  Step request;
  request.fix.push_back({{0, 0, 0}, {15, 15, 0}});
  request.drags = {Drag{Region({6, 6, 15}, {9, 9, 15}), {0.3, 0, 4}}};
  request.fem = FemStep();
  request.fem->links_beyond = LinksBeyond::keep;
  EXPECT_THROW(session.step(request, &stop), Cancelled);
  for (const BrickValues& q : session.body().q) EXPECT_TRUE(q.empty());
  EXPECT_EQ(session.body().beyond, nullptr);
}
