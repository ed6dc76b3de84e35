// The thread of a live session: what follows a release gives way to events, and is done after them.
#include <gtest/gtest.h>

#include "tests/support/program.h"
#include "tools/live/live_loop.h"

using namespace supple;
using namespace supple::test;
using namespace supple::tools;

namespace {

LiveEvent event(const std::string& keys) {
  TomlTable root = TomlTable::parse("[[event]]\n" + keys, "event");
  return read_event(root.tables("event").front(), {});
}

/// Posts something at the moment when finite elements begin for the first time.
class Intruder final : public LoopWatcher {
 public:
  Intruder(LiveSession& live, EventMailbox& mailbox, std::string keys)
      : m_live(live), m_mailbox(mailbox), m_keys(std::move(keys)) {}

  void begins() override {
    if (!m_live.is_unsettled() || m_keys.empty()) return;
    m_mailbox.post(event(std::exchange(m_keys, {})));
  }
  void went_on() override { ++slices; }
  void carried_out(const LiveEvent&) override { done_before = int(m_live.done().size()); }
  bool refused(const LiveEvent&, const std::string& why) override {
    refusals += why;
    return true;
  }

  int slices = 0;       // of finite elements
  int done_before = 0;  // steps, when the last event was carried out
  std::string refusals;

 private:
  LiveSession& m_live;
  EventMailbox& m_mailbox;
  std::string m_keys;
};

/// A ball that is dragged and released while finite elements are the model, and an event just then.
class UnitLiveLoop : public ::testing::Test {
 protected:
  UnitLiveLoop() {
    write_ball(m_folder, "ball", 96);
    m_live.emplace(
        TomlTable::parse("[volume]\npath = \"" + (m_folder / "ball.nhdr") + "\"", "ball"), nullptr);
  }

  Intruder run_with(const std::string& intruder) {
    EventMailbox mailbox;
    Intruder watcher(*m_live, mailbox, intruder);
    for (const char* keys : {"kind = \"model\"\nmodel = \"fem\"\nfem = { tolerance = 1e-9 }",
                             "kind = \"anchor\"\ngrab_box = [16, 16, 4, 80, 80, 24]",
                             "kind = \"grab\"\ngrab = [48, 48, 68]",
                             "kind = \"drag\"\nto = [0.5, 1.25, 0.75]", "kind = \"release\""}) {
      mailbox.post(event(keys));
    }
    LiveLoop loop(*m_live, {{32, 32}, true, 50}, watcher, m_console);
    mailbox.close();
    loop.run(mailbox);
    return watcher;
  }
  void carry_out(const std::string& keys) { m_live->carry_out(event(keys), nullptr); }
  bool is_solved() const { return m_live->done().back().step.fem.has_value(); }

  TemporaryFolder m_folder;
  Console m_console{GlobalOptions()};
  std::optional<LiveSession> m_live;
};

TEST_F(UnitLiveLoop, FiniteElementsGiveWayToACameraAndComeAfterIt) {
  const Intruder seen = run_with("kind = \"camera\"\ncamera = { view = \"left\" }");
  EXPECT_EQ(seen.done_before, 2);  // the anchor and the drag
  EXPECT_EQ(seen.slices, 2);
  EXPECT_TRUE(is_solved());
  EXPECT_EQ(seen.refusals, "");
}

TEST_F(UnitLiveLoop, FiniteElementsGiveWayToAnEventOfTheBodyForGood) {
  const Intruder seen = run_with("kind = \"undo\"");
  EXPECT_EQ(seen.slices, 1);
  EXPECT_FALSE(is_solved());
  EXPECT_EQ(m_live->done().size(), 1U);
  EXPECT_EQ(m_live->undone().size(), 1U);
  EXPECT_EQ(seen.refusals, "");
}

Image settled(LivePicture& picture) {
  while (picture.refine()) {
  }
  return *picture.settled();
}

/// As it is seen within a budget that leaves time for all of it.
Image first_of(LivePicture& picture) {
  constexpr double kBudgetMs = 1e6;
  EXPECT_TRUE(picture.follow());
  picture.prepare(kBudgetMs);
  return picture.first_pixels(kBudgetMs);
}

TEST_F(UnitLiveLoop, ADragAfterASettledPictureIsSeenAtOnceAsItSettles) {
  SceneView view = m_live->view();
  view.size = {64, 64};
  LivePicture picture(m_live->session(), view, m_console);
  const Image first = first_of(picture);  // a draft
  const Image rest = settled(picture);
  EXPECT_NE(first.rgba, rest.rgba);

  carry_out("kind = \"grab\"\ngrab = [48, 48, 80]");
  for (const char* drag : {"kind = \"drag\"\nto = [0, 0, 6]", "kind = \"drag\"\nto = [0, 6, 8]"}) {
    carry_out(drag);
    const Image dragged = first_of(picture);
    EXPECT_NE(dragged.rgba, rest.rgba);
    EXPECT_EQ(dragged.rgba, settled(picture).rgba);
    LivePicture other(m_live->session(), view, m_console);
    EXPECT_EQ(dragged.rgba, settled(other).rgba);
  }
  // Another view is begun anew.
  view.camera.camera = zoomed(picture.view().camera.camera.value(), 2);
  picture.look(view);
  const Image near = first_of(picture);
  EXPECT_NE(near.rgba, settled(picture).rgba);
  LivePicture other(m_live->session(), view, m_console);
  EXPECT_EQ(picture.settled()->rgba, settled(other).rgba);
}

}  // namespace
