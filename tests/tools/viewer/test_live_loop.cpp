// The thread of a live session: what follows a release gives way to events that may move the body,
// and answers those that only look from within.
#include <thread>

#include <gtest/gtest.h>

#include "tests/support/program.h"
#include "tests/support/sanitized.h"
#include "tools/console/console.h"
#include "tools/scene/file/view.h"
#include "tools/scene/live/live_loop.h"

using namespace supple;
using namespace supple::test;
using namespace supple::tools;

namespace {

LiveEvent event(const std::string& keys) {
  Table root = Table::parse("[[event]]\n" + keys, "event");
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
  void carried_out(const LiveEvent&) override { done_before = int(m_live.history().done.size()); }
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
    m_live.emplace(Table::parse("[volume]\npath = \"" + (m_folder / "ball.nhdr") + "\"", "ball"),
                   nullptr);
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
  bool is_solved() const { return m_live->history().done.back().step.fem.has_value(); }

  TemporaryFolder m_folder;
  Console m_console{GlobalOptions()};
  std::optional<LiveSession> m_live;
};

TEST_F(UnitLiveLoop, ACameraIsCarriedOutWithinFiniteElements) {
  const Intruder seen = run_with("kind = \"camera\"\ncamera = { view = \"left\" }");
  EXPECT_EQ(seen.done_before, 2);  // the anchor and the drag
  EXPECT_EQ(seen.slices, 1);
  EXPECT_TRUE(is_solved());
  EXPECT_EQ(seen.refusals, "");
}

const char* const kCameras[] = {"kind = \"camera\"\ncamera = { view = \"left\" }",
                                "kind = \"camera\"\ncamera = { view = \"right\" }"};

/// A hand that turns the camera and changes the size of the view as long as the body settles.
class Restless final : public LoopWatcher {
 public:
  Restless(LiveSession& live, EventMailbox& mailbox) : m_live(live), m_mailbox(mailbox) {}
  ~Restless() override { rest(); }

  void begins() override {
    ++slices;
    if (m_live.has_more() && !m_hand.joinable()) m_hand = std::thread([this] { turn(); });
  }
  void went_on() override {
    if (m_live.has_more()) return;
    rest();
    m_mailbox.close();
  }
  void drew(const Image&, const LiveCost&, const Stopwatch&) override { ++pictures; }
  bool refused(const LiveEvent&, const std::string& why) override {
    refusals += why;
    return true;
  }

  LiveLoop* loop = nullptr;
  int slices = 0, pictures = 0;
  std::string refusals;
  std::atomic<bool> is_tired{false};  // it gave up

 private:
  void turn() {
    const auto start = std::chrono::steady_clock::now();
    for (int n = 0; !m_rests; ++n) {
      m_mailbox.post(event(kCameras[n % 2]));
      m_mailbox.post([this, n] { loop->set_frame({{32 + n % 2, 32}, true, 50}); }, TaskKind::looks);
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      if (std::chrono::steady_clock::now() - start < std::chrono::seconds(30)) continue;
      is_tired = true;
      return m_mailbox.close();
    }
  }
  void rest() {
    m_rests = true;
    if (m_hand.joinable()) m_hand.join();
  }

  LiveSession& m_live;
  EventMailbox& m_mailbox;
  std::atomic<bool> m_rests{false};
  std::thread m_hand;
};

TEST_F(UnitLiveLoop, FiniteElementsEndThoughCamerasAndSizesKeepComing) {
  LEFT_OUT_WHEN_SANITIZED();
  EventMailbox mailbox;
  Restless watcher(*m_live, mailbox);
  for (const char* keys : {"kind = \"model\"\nmodel = \"fem\"\nfem = { tolerance = 1e-7 }",
                           "kind = \"anchor\"\ngrab_box = [16, 16, 4, 80, 80, 24]",
                           "kind = \"grab\"\ngrab = [48, 48, 68]",
                           "kind = \"drag\"\nto = [0.5, 1.25, 0.75]", "kind = \"release\""}) {
    mailbox.post(event(keys));
  }
  LiveLoop loop(*m_live, {{32, 32}, true, 50}, watcher, m_console);
  watcher.loop = &loop;
  loop.run(mailbox);
  EXPECT_FALSE(watcher.is_tired);
  EXPECT_TRUE(is_solved());
  EXPECT_GT(watcher.pictures, 3);  // within the one slice, too
  EXPECT_EQ(watcher.slices, 6);    // five events and one slice
  EXPECT_EQ(watcher.refusals, "");
}

TEST_F(UnitLiveLoop, RelaxationEndsThoughEveryCameraIsFollowedByAnother) {
  EventMailbox mailbox;
  struct Turning final : LoopWatcher {
    Turning(LiveSession& live_, EventMailbox& mailbox_) : live(live_), mailbox(mailbox_) {}
    void carried_out(const LiveEvent& done) override {
      if (!live.has_more()) return;
      cameras += done.is_of_view() ? 1 : 0;
      if (cameras < 10000) mailbox.post(event(kCameras[cameras % 2]));
    }
    void went_on() override {
      if (!live.has_more()) mailbox.close();
    }
    LiveSession& live;
    EventMailbox& mailbox;
    int cameras = 0;
  } watcher(*m_live, mailbox);
  for (const char* keys :
       {"kind = \"grab\"\ngrab = [48, 48, 68]", "kind = \"drag\"\nto = [0, 3, 3]",
        "kind = \"release\"", "kind = \"relax\"\npasses = 40"}) {
    mailbox.post(event(keys));
  }
  LiveLoop loop(*m_live, {{32, 32}, true, 50}, watcher, m_console);
  loop.run(mailbox);
  EXPECT_FALSE(m_live->has_more());
  EXPECT_GT(watcher.cameras, 3);
  EXPECT_LT(watcher.cameras, 1000);
}

TEST(UnitEventMailbox, WhatLooksIsTakenPastWhatReadsAndNotPastWhatMoves) {
  EventMailbox mailbox;
  mailbox.post([] {}, TaskKind::reads);
  mailbox.post(event(kCameras[0]));
  EXPECT_FALSE(mailbox.moves_wait());
  mailbox.post(event("kind = \"undo\""));
  mailbox.post(event(kCameras[1]));
  EXPECT_TRUE(mailbox.moves_wait());
  ASSERT_TRUE(mailbox.take_look());
  EXPECT_FALSE(mailbox.take_look());
  EXPECT_EQ(mailbox.take(false)->kind, TaskKind::reads);
  EXPECT_FALSE(mailbox.take_look());
  EXPECT_EQ(mailbox.take(false)->event.kind, EventKind::undo);
  EXPECT_FALSE(mailbox.moves_wait());
  EXPECT_TRUE(mailbox.take_look());
}

TEST(UnitEventMailbox, EventsThatMoveAreGivenUpAndAllElseStays) {
  EventMailbox mailbox;
  mailbox.post([] {});
  mailbox.post(event("kind = \"undo\""));
  mailbox.post(event(kCameras[0]));
  mailbox.post(event("kind = \"release\""));
  const std::vector<LiveEvent> dropped = mailbox.drop_moves();
  ASSERT_EQ(dropped.size(), 2U);
  EXPECT_EQ(dropped[0].kind, EventKind::undo);
  EXPECT_EQ(dropped[1].kind, EventKind::release);
  EXPECT_TRUE(mailbox.moves_wait());  // the task
  EXPECT_TRUE(mailbox.take(false)->task);
  EXPECT_FALSE(mailbox.moves_wait());
  EXPECT_EQ(mailbox.take(false)->event.kind, EventKind::camera);
}

TEST_F(UnitLiveLoop, FiniteElementsGiveWayToAnEventOfTheBodyForGood) {
  const Intruder seen = run_with("kind = \"undo\"");
  EXPECT_EQ(seen.slices, 1);
  EXPECT_FALSE(is_solved());
  EXPECT_EQ(m_live->history().done.size(), 1U);
  EXPECT_EQ(m_live->history().undone.size(), 1U);
  EXPECT_EQ(seen.refusals, "");
}

Image settled(LivePicture& picture) {
  while (picture.refine()) {
  }
  return *picture.settled();
}

/// First picture within a budget that leaves time for all of it.
Image first_of(LivePicture& picture) {
  constexpr double kBudgetMs = 1e6;
  EXPECT_TRUE(picture.follow());
  picture.prepare(kBudgetMs);
  return picture.first_pixels(kBudgetMs);
}

TEST_F(UnitLiveLoop, AFirstPictureHasAQuarterOfTheWidthHoweverLate) {
  SceneView view = m_live->view();
  view.size = {128, 128};
  LivePicture picture(m_live->session(), view, m_console);
  EXPECT_TRUE(picture.follow());
  constexpr double kBudgetMs = 1e-3;
  picture.prepare(kBudgetMs);
  EXPECT_GE(picture.first_pixels(kBudgetMs).width, 32);
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
