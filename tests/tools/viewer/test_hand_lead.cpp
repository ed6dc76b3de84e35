// Finite elements under the hand: whatever the machine's speed, a stroke leads to one state, its
// journal and its scene to the same, and what is shown ends where the state will be.
#include <gtest/gtest.h>

#include "lib/body/slot_set.h"
#include "lib/session/kept_voxels.h"
#include "raycast/pictures/compare.h"
#include "tests/support/program.h"
#include "tools/console/console.h"
#include "tools/scene/file/view.h"
#include "tools/scene/live/hand_lead.h"
#include "tools/scene/live/live_loop.h"
#include "tools/scene/live/replay.h"
#include "volumes/base/parallel.h"

using namespace supple;
using namespace supple::test;
using namespace supple::tools;

namespace {

using namespace std::chrono_literals;

const char* const kUnderHand =
    "kind = \"model\"\nmodel = \"fem\"\nunder_hand = true\nfem = { tolerance = 1e-7 }";
const char* const kFloor = "kind = \"anchor\"\ngrab_box = [4, 4, 2, 20, 20, 9]";
const char* const kGrab =
    "kind = \"grab\"\ngrab_ball = [12, 12, 15]\nradius = 2\ndirections = [[10, 0, 0], [0, 0, 10]]";

LiveEvent event_of(const std::string& keys) {
  Table root = Table::parse("[[event]]\n" + keys, "event");
  return read_event(root.tables("event").front(), {});
}

std::string drag_to(const std::string& to) {
  return "kind = \"drag\"\nto = " + to;
}

/// A ball on a floor, led by hands.
class UnitHandLead : public ::testing::Test {
 protected:
  UnitHandLead() { write_ball(m_folder, "ball", 24); }

  /// A session that has the floor and finite elements under the hand, and these events.
  std::unique_ptr<LiveSession> led(const std::vector<std::string>& events = {}) {
    auto live = std::make_unique<LiveSession>(
        Table::parse("[volume]\npath = \"" + (m_folder / "ball.nhdr") + "\"", "ball"), nullptr);
    carry_out(*live, {kFloor, kUnderHand});
    carry_out(*live, events);
    return live;
  }
  static void carry_out(LiveSession& live, const std::vector<std::string>& events) {
    for (const std::string& keys : events) live.carry_out(event_of(keys), nullptr);
  }
  static void finish(LiveSession& live) {
    while (live.has_more()) live.go_on(nullptr);
  }
  static void wait_for_all_levels(LiveSession& live) { live.lead()->found(nullptr); }
  static std::string hash(LiveSession& live) { return hash_of(live.session().state()); }

  /// The hash after all events of the journal, or all steps of the scene, without a hand.
  std::string replayed(const Value& file) {
    LiveSession live(Table(file, m_folder / "journal.toml"), nullptr);
    for (const LiveEvent& event : live.events()) {
      live.carry_out(event, nullptr);
      finish(live);
    }
    return hash(live);
  }

  TemporaryFolder m_folder;
};

}  // namespace

TEST_F(UnitHandLead, AFastAndASlowMachineMakeTheSameStateAndSoDoJournalAndScene) {
  const std::vector<std::string> stroke = {kGrab, drag_to("[1, 0, 0.5]"), drag_to("[2, 0, 1]")};
  const auto slow = led(stroke), fast = led(stroke);
  wait_for_all_levels(*fast);
  // A third direction is found while the hand is still there.
  carry_out(*fast, {drag_to("[3, 0.5, 1]")});
  wait_for_all_levels(*fast);
  EXPECT_LE(fast->lead()->state().pose.beyond_mm, 1e-6);
  EXPECT_EQ(fast->lead()->state().pose.parts.size(), 3u);
  carry_out(*fast, {"kind = \"release\""});
  carry_out(*slow, {drag_to("[3, 0.5, 1]"), "kind = \"release\""});
  EXPECT_EQ(slow->history().done.size(), 1u);  // the floor: the stroke is still to be done
  EXPECT_TRUE(slow->has_more());
  finish(*slow);
  finish(*fast);
  EXPECT_EQ(slow->history().done.size(), 2u);
  EXPECT_EQ(slow->lead(), nullptr);
  const std::string state = hash(*slow);
  EXPECT_EQ(hash(*fast), state);
  EXPECT_EQ(replayed(slow->journal()), state);
  EXPECT_EQ(replayed(slow->batch_scene()), state);
  for (const int threads : {1, 2, 5}) {
    on_threads(threads, [&] { EXPECT_EQ(replayed(fast->journal()), state) << threads; });
  }
  // The target is not clipped.
  Slot middle;
  const Body& body = slow->session().body();
  ASSERT_TRUE(slot_of(body.elements, {12, 12, 15}, middle));
  EXPECT_EQ(body.q[0].at(middle), 3 * kFixedOne);
  EXPECT_EQ(body.q[1].at(middle), kFixedOne / 2);
}

TEST_F(UnitHandLead, TurnsOfABoneAreFollowedAboutAnyAxes) {
  const auto live =
      led({"kind = \"step\"\nrigid = [{ name = \"bone\", grab_box = [8, 11, 12, 15, 12, 13] }]",
           "kind = \"grab\"\nrigid_at = [9, 11, 12]\ndirections = [[10, 0, 0], [0, 0, 10]]",
           drag_to("[0.5, 0, 0]")});
  wait_for_all_levels(*live);
  carry_out(*live, {drag_to("[0.5, 0, 0.25]\nturn = [0, 20, 0]")});
  wait_for_all_levels(*live);
  EXPECT_EQ(live->lead()->state().pose.parts.size(), 4u);
  // Another angle about the same axis needs nothing else, another axis all linear maps.
  carry_out(*live, {drag_to("[0.5, 0, 0]\nturn = [0, -30, 0]")});
  EXPECT_TRUE(live->lead()->state().is_done);
  EXPECT_LE(live->lead()->state().pose.beyond_mm, 1e-6);
  for (const char* turn : {"[10, 0, 0]", "[0, 0, 10]", "[6, -9, 8]"}) {
    carry_out(*live, {drag_to(std::string("[0.5, 0, 0.25]\nturn = ") + turn)});
    wait_for_all_levels(*live);
    EXPECT_EQ(live->lead()->state().pose.parts.size(), 11u);
    EXPECT_LE(live->lead()->state().pose.beyond_mm, 1e-6);
  }
  const auto now = HandLead::Clock::now();
  live->lead()->shape(now);
  const BodyShape shown = *live->lead()->shape(now + 1s);
  carry_out(*live, {"kind = \"release\""});
  finish(*live);
  const Body& body = live->session().body();
  EXPECT_NEAR(body.rigid.list.front().pose.turn.angle_deg(), std::sqrt(181.0), 1e-3);
  for_each_element(body.elements, [&](Slot slot) {
    for (std::size_t c = 0; c < 3; ++c) {
      ASSERT_NEAR(double(shown[c].at(slot)), double(body.q[c].at(slot)), 0.01 * kFixedOne);
    }
  });
  const std::string state = hash(*live);
  EXPECT_EQ(replayed(live->journal()), state);
  EXPECT_EQ(replayed(live->batch_scene()), state);
}

TEST_F(UnitHandLead, DirectionsThatAreNoneAreRefused) {
  const std::string grab = "kind = \"grab\"\ngrab = [12, 12, 15]\ndirections = ";
  EXPECT_EQ(event_of(grab + "[[0, 0, 2, 90], [1, 0, 0]]").directions.front().turn_deg, 90);
  std::string many;
  for (int n = 0; n < 13; ++n) many += "[1, 0, 0], ";
  for (const std::string& rows :
       {std::string("[[0, 0, 0, 90]]"), std::string("[[1, 0]]"), "[" + many + "]"}) {
    try {
      event_of(grab + rows);
      ADD_FAILURE() << rows;
    } catch (const InputError& error) {
      EXPECT_EQ(error.problem().field, "event[1].directions") << rows;
    }
  }
}

TEST_F(UnitHandLead, PicturesFollowWhileTheStateWaitsAndBlendIntoThePose) {
  const auto live = led({kGrab, drag_to("[2, 0, 0]")});
  const std::string before = hash(*live);
  HandLead& lead = *live->lead();
  wait_for_all_levels(*live);
  EXPECT_TRUE(lead.is_changing());
  const auto now = HandLead::Clock::now();
  const auto middle_of = [&](HandLead::Clock::time_point at) {
    Slot slot;
    slot_of(live->session().body().elements, {12, 12, 12}, slot);
    return lead.shape(at)->at(0).at(slot);
  };
  const std::int32_t first = middle_of(now), half = middle_of(now + 100ms),
                     last = middle_of(now + 300ms);
  EXPECT_FALSE(lead.is_changing());
  EXPECT_EQ(middle_of(now + 400ms), last);
  EXPECT_NEAR(double(half), 0.5 * (double(first) + double(last)), 2);
  const LeadState told = lead.state();
  EXPECT_TRUE(told.is_done);
  EXPECT_EQ(told.pose.error_mm, 0);
  EXPECT_GT(told.force_n.length(), 0);
  EXPECT_EQ(hash(*live), before);
  const BodyShape shown = *lead.shape(now + 400ms);
  carry_out(*live, {"kind = \"release\""});
  finish(*live);
  const Body& body = live->session().body();
  for_each_element(body.elements, [&](Slot slot) {
    for (std::size_t c = 0; c < 3; ++c) {
      ASSERT_NEAR(double(shown[c].at(slot)), double(body.q[c].at(slot)), 2);
    }
  });
}

TEST_F(UnitHandLead, OneStrokeIsOneStepThatUndoTakesBackWhetherItIsDoneOrNot) {
  const std::vector<std::string> stroke = {kGrab, drag_to("[1, 0, 0]"), drag_to("[2, 0, 1]"),
                                           "kind = \"release\""};
  const auto done = led(stroke), waiting = led(stroke);
  const std::string before = hash(*waiting);
  finish(*done);
  const std::string after = hash(*done);
  for (LiveSession* live : {done.get(), waiting.get()}) {
    carry_out(*live, {"kind = \"undo\""});
    EXPECT_FALSE(live->has_more());
    EXPECT_EQ(live->lead(), nullptr);
    EXPECT_EQ(hash(*live), before);
    EXPECT_EQ(replayed(live->journal()), before);
    carry_out(*live, {"kind = \"redo\""});
    EXPECT_EQ(hash(*live), after);
    EXPECT_EQ(replayed(live->journal()), after);
    EXPECT_EQ(replayed(live->batch_scene()), after);
  }
}

TEST_F(UnitHandLead, ReleaseWithoutMotionRestoreAndStopLeaveNothing) {
  const auto live = led();
  const std::string before = hash(*live);
  carry_out(*live, {kGrab, "kind = \"release\""});
  EXPECT_EQ(live->lead(), nullptr);
  EXPECT_FALSE(live->has_more());
  carry_out(*live, {kGrab, drag_to("[2, 0, 0]"), drag_to("[0, 0, 0]"), "kind = \"release\""});
  EXPECT_FALSE(live->has_more());
  carry_out(*live, {kGrab, drag_to("[2, 0, 0]"), "kind = \"release\"\nrestore = true"});
  EXPECT_FALSE(live->has_more());
  carry_out(*live, {kGrab, drag_to("[2, 0, 0]"), "kind = \"release\""});
  live->stop();
  EXPECT_FALSE(live->has_more());
  EXPECT_EQ(hash(*live), before);
  EXPECT_EQ(replayed(live->journal()), before);
}

TEST_F(UnitHandLead, TheSolidIsMadeBeforeTheGrabAndStaysWhereAStrokeIsCancelled) {
  const auto live = led({kGrab, drag_to("[2, 0, 0]")});
  const auto solid = [&] { return live->lead()->found(nullptr)->voxels; };
  const auto first = solid();
  carry_out(*live, {"kind = \"release\"\nrestore = true", kGrab});
  EXPECT_EQ(solid(), first);
  carry_out(*live, {"kind = \"release\"",
                    "kind = \"cut\"\nplane = { corner = [12, -1, 14], edge1 = [0, 26, 0], "
                    "edge2 = [0, 0, 12], frame = \"voxel\" }",
                    kGrab});
  EXPECT_NE(solid(), first);
}

TEST_F(UnitHandLead, AnotherGrabFinishesTheStrokeBeforeItAndOtherStepsTheOneThatIsHeld) {
  const auto live = led({kGrab, drag_to("[2, 0, 1]"), "kind = \"release\"", kGrab});
  EXPECT_EQ(live->history().done.size(), 2u);
  carry_out(*live,
            {drag_to("[0, 0, 1]"), "kind = \"anchor\"\ngrab_box = [4, 12, 10, 6, 14, 12]",
             drag_to("[1, 0, 1]"), "kind = \"undo\"", drag_to("[0, 0, 2]"), "kind = \"release\""});
  finish(*live);
  EXPECT_EQ(live->history().done.size(), 5u);
  EXPECT_EQ(replayed(live->journal()), hash(*live));
  EXPECT_EQ(replayed(live->batch_scene()), hash(*live));
}

TEST_F(UnitHandLead, WhatCannotBeUnderAHandIsRefused) {
  const auto live = led();
  EXPECT_THROW(carry_out(*live, {"kind = \"push\"\ngrab_ball = [12, 12, 20]\nradius = 2"}),
               InputError);
  for (const char* model :
       {"\"springs\"", "\"fem\"\nfem = { accuracy = \"picture\" }",
        "\"fem\"\nfem = { strain = \"finite\" }", "\"fem\"\nfem = { refine = 1 }"}) {
    const std::string keys = std::string("kind = \"model\"\nunder_hand = true\nmodel = ") + model;
    EXPECT_THROW(event_of(keys), InputError) << model;
  }
}

TEST_F(UnitHandLead, TheLoopDrawsLevelsAsTheyComeAndEndsTheStroke) {
  const auto live = led();
  EventMailbox mailbox;
  /// Lets go once the last level is shown.
  struct Letting final : LoopWatcher {
    Letting(LiveSession& live_, EventMailbox& mailbox_) : live(live_), mailbox(mailbox_) {}
    bool has_later_work() const override {
      const HandLead* const lead = live.lead();
      if (lead == nullptr || !lead->state().is_done || lead->is_changing()) return false;
      if (!mailbox.is_closed()) mailbox.post(event_of("kind = \"release\""));
      mailbox.close();
      return false;
    }
    void drew(const Image&, const LiveCost&, const Stopwatch&) override { ++pictures; }
    LiveSession& live;
    EventMailbox& mailbox;
    int pictures = 0;
  } watcher(*live, mailbox);
  Console console{GlobalOptions()};
  LiveLoop loop(*live, {{32, 32}, true, 50}, watcher, console);
  for (const char* keys : {kGrab, "kind = \"drag\"\nto = [2, 0, 1]"}) mailbox.post(event_of(keys));
  loop.run(mailbox);
  EXPECT_GT(watcher.pictures, 2);  // of the event, and of levels
  EXPECT_EQ(live->history().done.size(), 2u);
  EXPECT_EQ(replayed(live->journal()), hash(*live));
}

TEST_F(UnitHandLead, AFilmShowsTheLastLevelWheneverTheHandRests) {
  Console console{GlobalOptions()};
  std::string text = "[volume]\npath = \"" + (m_folder / "ball.nhdr") + "\"\n";
  for (const std::string& keys : std::vector<std::string>{
           kFloor, kUnderHand, kGrab, drag_to("[3, 0, 1]"), "kind = \"release\""}) {
    text += "[[event]]\nat = " + std::to_string(text.size()) + "\n" + keys + "\n";
  }
  ReplayOptions options;
  options.size = {96, 96};
  Replay replay(Table::parse(text, "film"), options, console, console);
  std::vector<Image> pictures;
  replay.film([&](const Image& image) {
    if (pictures.empty() || image.rgba != pictures.back().rgba) pictures.push_back(image);
  });
  ASSERT_GE(pictures.size(), 2u);
  EXPECT_GT(compare(pictures.back(), pictures.front(), true).rmse, 0.01);
  // Places under the hand and in the body may round differently.
  EXPECT_LT(compare(pictures[1], pictures.back(), true).rmse, 1e-3);
}
