// Operations that hands lead: the poses that they ask for are all that a session depends on, so
// that it is saved as a scene with tracks and done again to the last bit, by steps of one length.
#include <atomic>
#include <random>
#include <thread>

#include <gtest/gtest.h>

#include "tests/tools/scene/operation/small_eye.h"
#include "tools/scene/operation/event_news.h"
#include "tools/scene/operation/live_operation.h"
#include "tools/scene/operation/operation_loop.h"
#include "volumes/base/error.h"
#include "volumes/base/files.h"

using namespace supple;
using namespace supple::tools;

namespace {

struct Replayed {
  std::string digest;
  std::vector<Vec3d> focus_mm;  // of each step
  std::vector<double> zoom;
};

/// All steps of a scene that was saved, by its tracks.
Replayed replayed(const std::string& path) {
  const OperationScene scene = read_operation(Table::read(path));
  Operation operation(scene.setup);
  Replayed all;
  for (int n = 1; n <= scene.step_count(); ++n) {
    const double time_s = n * scene.setup.step_s;
    operation.step(scene.poses_at(time_s));
    all.focus_mm.push_back(scene.views.front().focus_at(time_s));
    all.zoom.push_back(scene.views.front().zoom_at(time_s));
  }
  all.digest = operation.digest();
  return all;
}

/// A wish as a hand would have it that grips and peels.
PoseWish wish_of(std::mt19937& random, const InstrumentPose& now) {
  std::uniform_real_distribution<double> part(-1, 1);
  PoseWish wish;
  if (random() % 4 != 0) {
    const Vec3d to = now.tip_mm + Vec3d(part(random), part(random), part(random)) * 0.3;
    wish.tip_mm = Vec3d(std::clamp(to.x, -2.0, 2.0), std::clamp(to.y, -2.0, 2.0),
                        std::clamp(to.z, -11.0, -8.0));
  }
  if (random() % 8 == 0) wish.opening_degrees = random() % 2 == 0 ? 0 : 20;
  if (random() % 8 == 0) wish.roll_degrees = 180 * part(random);
  return wish;
}

PoseWish wish_to(const Vec3d& tip_mm) {
  PoseWish wish;
  wish.tip_mm = tip_mm;
  return wish;
}

class ScratchSession : public ::testing::Test {
 protected:
  ScratchFolder m_folder;
  std::string path() const { return m_folder / "session.toml"; }
};
using PropertyLiveOperation = ScratchSession;
using UnitOperationLoop = ScratchSession;

class Listener final : public OperationListener {
 public:
  void stepped(const OperationSample& sample) override {
    times_s.push_back(sample.time_s);
    ++steps;
  }
  void pictured(const Image& image, const PixelSize& size) override {
    EXPECT_EQ(size, (PixelSize{64, 48}));
    width = image.width;
    ++pictures;
    std::this_thread::sleep_for(sleep);
  }
  std::vector<double> times_s;
  std::atomic<int> steps{0}, pictures{0}, width{0};
  std::chrono::milliseconds sleep{0};
};

}  // namespace

TEST_F(PropertyLiveOperation, ASavedSessionIsDoneAgainToTheSameBits) {
  std::mt19937 random(5);
  LiveOperation live(small_eye());
  const int forceps = live.find("forceps");
  Replayed expected;
  for (int n = 0; n < 120; ++n) {
    if (n >= 20 && n % 3 == 0) live.ask(forceps, wish_of(random, live.asked(forceps)));
    if (n == 90) live.let_go(forceps);
    if (n == 40 || n == 41 || n == 77) {
      LookWish look;
      look.focus_mm = Vec3d(0.01 * n, 0.1, -10.5);
      if (n != 41) look.zoom = 1 + 0.01 * n;
      live.look(look);
    }
    live.step();
    expected.focus_mm.push_back(live.view().focus_at(live.time_s()));
    expected.zoom.push_back(live.view().zoom_at(live.time_s()));
  }
  live.save(path());
  const Replayed again = replayed(path());
  EXPECT_EQ(again.digest, live.operation().digest());
  EXPECT_EQ(again.focus_mm, expected.focus_mm);
  EXPECT_EQ(again.zoom, expected.zoom);
}

TEST_F(PropertyLiveOperation, ModelsThatWereExchangedAreExchangedAgain) {
  LiveOperation live(small_eye()), other(small_eye());
  const int membrane = live.find_membrane("membrane");
  PoseWish grip;
  grip.tip_mm = Vec3d(0.8, 0, -10.95);
  grip.opening_degrees = 0;
  const auto lead = [&](LiveOperation& session, int n) {
    if (n == 20) session.ask(0, grip);
    if (n == 50) session.ask(0, wish_to({0.4, 0, -10}));
    session.step();
  };
  for (int n = 0; n < 100; ++n) {
    if (n == 30 || n == 70) live.take_model(membrane, MembraneModel::ecm);
    if (n == 60) live.take_model(membrane, MembraneModel::springs);
    lead(live, n);
    lead(other, n);
    EXPECT_EQ(live.model(membrane) == MembraneModel::ecm, (n >= 30 && n < 60) || n >= 70) << n;
  }
  EXPECT_NE(live.operation().digest(), other.operation().digest());
  live.save(path());
  EXPECT_EQ(replayed(path()).digest, live.operation().digest());
  live.restart();
  EXPECT_EQ(live.model(membrane), MembraneModel::springs);
}

TEST_F(PropertyLiveOperation, ASavedSessionCanBeGoneOnWithAndSavedAgain) {
  LiveOperation first(small_eye());
  for (int n = 0; n < 30; ++n) first.step();
  first.save(path());
  LiveOperation second(Table::read(path()));
  for (int n = 0; n < 30; ++n) second.step();
  EXPECT_EQ(second.operation().digest(), first.operation().digest());
  second.save(path());
  EXPECT_EQ(replayed(path()).digest, first.operation().digest());
}

TEST(UnitLiveOperation, WhatNoHandLeadsFollowsItsTrack) {
  LiveOperation live(small_eye());
  PoseWish wish;
  wish.active = 0.5;
  live.ask(live.find("lamp"), wish);
  for (int n = 0; n < 50; ++n) live.step();
  EXPECT_FALSE(live.is_led(0));
  EXPECT_TRUE(live.is_led(1));
  EXPECT_LT((live.operation().sample().instruments[0].pose.tip_mm - Vec3d(1.5, 0, -8)).length(),
            1e-3);
  EXPECT_EQ(live.asked(1).active, 0.5);
  EXPECT_EQ(live.asked(1).tip_mm, Vec3d(-4, -1.5, -2.5)) << "what was not asked for stays";
}

TEST(UnitLiveOperation, AHandWithoutAnAxisLeadsTheShaftThroughItsIncision) {
  LiveOperation live(small_eye());
  PoseWish wish;
  wish.tip_mm = Vec3d(-1, 0.5, -9);
  live.ask(0, wish);
  for (int n = 0; n < 50; ++n) live.step();
  Vec3d incision_mm{0, 0, 0};
  for (const Incision& one : live.scene().setup.eye->incisions) {
    if (one.name == "nasal") incision_mm = one.place_mm;
  }
  EXPECT_LT((live.asked(0).axis - (incision_mm - *wish.tip_mm).normalized()).length(), 1e-12);
  EXPECT_LT(live.operation().sample().turn_degrees.length(), 0.1) << "and the eye does not turn";
}

TEST(UnitLiveOperation, ARestartIsANewSession) {
  LiveOperation live(small_eye()), other(small_eye());
  for (int n = 0; n < 40; ++n) live.step();
  live.restart();
  EXPECT_EQ(live.steps(), 0);
  for (int n = 0; n < 40; ++n) live.step(), other.step();
  EXPECT_EQ(live.operation().digest(), other.operation().digest());
}

TEST(UnitEventNews, ATouchIsToldOfWhenItBeginsAndWhenItIsOverHoweverLongItLasts) {
  EventNews news;
  std::vector<OperationEvent> told;
  const auto step = [&](int n, double force_n) {
    OperationSample sample;
    sample.time_s = 0.02 * n;
    if (force_n > 0)
      sample.events.push_back({sample.time_s, "touch", "needle", "lens", {}, force_n});
    if (n == 70) sample.events.push_back({sample.time_s, "gripped", "forceps", "membrane", {}, 3});
    for (const OperationEvent& event : news.of(sample)) told.push_back(event);
  };
  // A touch that lets go for five steps is one; the second lasts until it begins again.
  for (int n = 1; n <= 50; ++n) step(n, n >= 25 && n < 30 ? 0 : n == 40 ? 0.5 : 0.1);
  for (int n = 51; n <= 100; ++n) step(n, n < 90 ? 0 : 0.2);
  step(1, 0.3);
  std::vector<std::string> texts;
  for (const OperationEvent& event : told) {
    texts.push_back(event.kind + " " + std::to_string(std::lround(event.time_s / 0.02)) + " " +
                    std::to_string(std::lround(event.value * 10)));
  }
  EXPECT_EQ(texts, (std::vector<std::string>{"touch 1 1", "touch_ended 63 5", "gripped 70 30",
                                             "touch 90 2", "touch 1 3"}));
}

TEST(FaultLiveOperation, AnInstrumentThatIsNotThereIsToldWithTheNamesThatAre) {
  LiveOperation live(small_eye());
  try {
    live.find("scalpel");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("forceps or lamp"), std::string::npos) << error.what();
  }
  PoseWish wish;
  wish.axis = Vec3d(0.0);
  EXPECT_THROW(live.ask(0, wish), InputError);
  EXPECT_FALSE(live.is_led(0));
}

TEST_F(UnitOperationLoop, StepsAreEquallyLongHoweverLateTheyAre) {
  LiveOperation live(small_eye());
  Listener listener;
  listener.sleep = std::chrono::milliseconds(150);
  OperationLoop loop(live, listener);
  std::thread thread([&] { loop.run(); });
  std::mt19937 random(7);
  for (int n = 0; n < 2000 && listener.steps < 20; ++n) {
    std::this_thread::sleep_for(std::chrono::milliseconds(random() % 30));
    loop.post([&live, wish = wish_of(random, {{1, 0, -9}})] { live.ask(0, wish); });
  }
  loop.end();
  thread.join();
  ASSERT_GE(listener.times_s.size(), 20u);
  for (std::size_t n = 0; n < listener.times_s.size(); ++n) {
    EXPECT_EQ(listener.times_s[n], double(n + 1) * live.scene().setup.step_s);
  }
  EXPECT_GT(loop.dropped_s(), 0);
  live.save(path());
  EXPECT_EQ(replayed(path()).digest, live.operation().digest());
}

TEST(UnitOperationLoopPause, TimeStandsStillAndPicturesFollowWhatIsAskedFor) {
  LiveOperation live(small_eye());
  Listener listener;
  OperationLoop loop(live, listener);
  loop.pause(true);
  std::thread thread([&] { loop.run(); });
  const auto pictures_reach = [&](int count) {
    for (int n = 0; n < 500 && listener.pictures < count; ++n) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return listener.pictures.load();
  };
  EXPECT_EQ(pictures_reach(1), 1);
  loop.post([&live] {
    LookWish look;
    look.zoom = 2;
    live.look(look);
  });
  EXPECT_EQ(pictures_reach(2), 2);
  loop.post([&loop] { loop.watch(false), loop.pause(false); });
  std::this_thread::sleep_for(std::chrono::milliseconds(60));
  loop.end();
  thread.join();
  EXPECT_EQ(live.steps(), 0);
  EXPECT_EQ(listener.pictures, 2) << "nobody looks";
}

TEST(UnitOperationLoopHand,
     PicturesAreSmallerWhileAHandMovesAndWholeWhereItRestsOrTheyAreSoonEnough) {
  for (const double led_picture_ms : {1e-9, 1e9}) {
    LiveOperation live(small_eye());
    Listener listener;
    OperationLoop loop(live, listener, led_picture_ms);
    loop.pause(true);
    std::thread thread([&] { loop.run(); });
    const auto width_becomes = [&](int width, bool is_led) {
      for (int n = 0; n < 1000 && listener.width != width; ++n) {
        if (is_led) loop.post([&loop] { loop.tell_hand(); });
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
      }
      return listener.width == width;
    };
    EXPECT_TRUE(width_becomes(64, false));
    if (led_picture_ms < 1) {
      EXPECT_TRUE(width_becomes(24, true));
      EXPECT_TRUE(width_becomes(64, false));
    } else {
      for (int n = 0; n < 20; ++n) EXPECT_TRUE(width_becomes(64, true));
    }
    loop.end();
    thread.join();
  }
}

TEST(UnitOperationLoopHand, StepsAreAtMostHalfOfOneEarly) {
  LiveOperation live(Table::parse(R"(
[operation]
step = 0.1
frames_per_second = 10
[[instrument]]
name = "needle"
kind = "needle"
way  = [{ time = 0, tip = [0, 0, 0], axis = [0, 0, 1] }]
[[view]]
size = [64, 48]
)",
                                  "needle.toml"));
  Listener listener;
  OperationLoop loop(live, listener);
  std::atomic<bool> ends{false};
  const auto begin = std::chrono::steady_clock::now();
  std::thread thread([&] { loop.run(); });
  std::thread hand([&] {
    while (!ends) {
      loop.post([&loop] { loop.tell_hand(); });
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  });
  const double step_s = live.scene().setup.step_s;
  while (listener.steps < 8) {
    const int steps = listener.steps;
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begin;
    EXPECT_LE(steps, passed.count() / step_s + 1.5);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  ends = true;
  hand.join();
  loop.end();
  thread.join();
}
