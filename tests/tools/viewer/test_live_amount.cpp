// A part of the displacement as a live picture shows it, against the displacement itself.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "raycast/drawings/slice.h"
#include "tests/support/program.h"
#include "tools/console/console.h"
#include "tools/scene/file/view.h"
#include "tools/scene/live/live_picture.h"
#include "tools/scene/live/live_session.h"
#include "tools/scene/live/rest_picture.h"

using namespace supple;
using namespace supple::test;
using namespace supple::tools;

namespace {

/// A ball whose top is led away.
class PropertyLiveAmount : public ::testing::Test {
 protected:
  PropertyLiveAmount() {
    write_ball(m_folder, "ball", 48);
    m_live.emplace(Table::parse("[volume]\npath = \"" + (m_folder / "ball.nhdr") + "\"", "ball"),
                   nullptr);
    for (const char* keys : {"kind = \"grab\"\ngrab_ball = [24, 24, 34]\nradius = 5",
                             "kind = \"drag\"\nto = [3, 2, 1]"}) {
      Table root = Table::parse(std::string("[[event]]\n") + keys, "event");
      m_live->carry_out(read_event(root.tables("event").front(), {}), nullptr);
    }
    SceneView view = m_live->view();
    view.size = {40, 40};
    m_picture.emplace(m_live->session(), view, m_console);
    m_picture->follow();
    m_whole = m_picture->displacement();
  }

  /// Shows this much of it, and compares where places were at rest.
  void expect_amount(double amount, bool exact) {
    m_picture->set_amount(amount);
    m_picture->follow();
    if (exact) {
      while (m_picture->refine()) {
      }
    } else {
      m_picture->prepare(0);
    }
    const RestPlaceAt rest = m_picture->rest_places(exact);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> place(8, 40);
    // The inverse holds at voxels, and is interpolated between them.
    const auto coordinate = [&] { return exact ? std::round(place(random)) : place(random); };
    int moved = 0;
    for (int n = 0; n < 3000; ++n) {
      const double i = coordinate(), j = coordinate(), k = coordinate();
      const Vec3d x(i, j, k);
      Vec3d y, u;
      if (!rest(x, y) || !m_whole.u.sample(y, u)) continue;
      EXPECT_LT((y + u * amount - x).length(), 0.002) << amount << " at " << x;
      moved += u.length() > 0.5;
    }
    EXPECT_GT(moved, 100);
  }
  Image settled() {
    while (m_picture->refine()) {
    }
    return *m_picture->settled();
  }

  TemporaryFolder m_folder;
  Console m_console{GlobalOptions()};
  std::optional<LiveSession> m_live;
  std::optional<LivePicture> m_picture;
  Displacement m_whole;
};

}  // namespace

TEST_F(PropertyLiveAmount, TissueIsThatPartOfTheWayFromItsPlaceAtRest) {
  for (const double amount : {0.5, 0.1, 1.5, 1.}) expect_amount(amount, true);
  for (const double amount : {0.3, 1.2, 1., 0.7}) expect_amount(amount, false);
}

TEST_F(PropertyLiveAmount, AllOfItIsAsBeforeAndTheSessionDoesNotKnow) {
  const std::array<BrickValues, 3> before = m_live->session().body().q;
  const Image whole = settled();
  m_picture->set_amount(0.5);
  EXPECT_TRUE(m_picture->follow());
  EXPECT_FALSE(m_picture->follow());
  EXPECT_NE(settled().rgba, whole.rgba);
  m_picture->set_amount(1);
  m_picture->follow();
  EXPECT_EQ(settled().rgba, whole.rgba);
  EXPECT_TRUE(m_live->session().body().q == before);
}

TEST_F(PropertyLiveAmount, PictureAtRestBesideItIsThatOfNoneOfIt) {
  const Image whole = settled();
  RestPicture beside(*m_picture);
  EXPECT_EQ(beside.draft(1e-9).width, 10);
  const Image at_rest = *beside.settled();
  EXPECT_NE(at_rest.rgba, whole.rgba);
  EXPECT_EQ(m_picture->settled()->rgba, whole.rgba);
  SceneView view = m_picture->view();
  view.deformed = false;
  m_picture->look(view);
  m_picture->follow();
  EXPECT_EQ(settled().rgba, at_rest.rgba);
}
