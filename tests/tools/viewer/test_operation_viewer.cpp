// Pages that lead an operation, without sockets: what they say and what they are told.
#include <condition_variable>
#include <filesystem>
#include <mutex>

#include <gtest/gtest.h>

#include "tests/tools/scene/operation/small_eye.h"
#include "tools/viewer/operation_viewer.h"
#include "volumes/base/files.h"
#include "volumes/base/json.h"

using namespace supple;
using namespace supple::tools;

namespace {

/// A page that acknowledges every picture.
class Watcher final : public PageOutlet {
 public:
  void send_text(std::shared_ptr<const std::string> text) override {
    const std::lock_guard lock(m_guard);
    m_texts.push_back(parse_json(*text));
    m_changed.notify_all();
  }
  void send_frame(std::vector<std::uint8_t>, std::shared_ptr<const FrameMessage> frame) override {
    const std::lock_guard lock(m_guard);
    m_frames.push_back(frame);
    m_changed.notify_all();
  }

  /// The first text from `from` on that the check holds for, within ten seconds.
  Value text(const std::function<bool(const Value&)>& check, std::size_t from = 0) {
    std::unique_lock lock(m_guard);
    Value found;
    const bool is_there = m_changed.wait_for(lock, std::chrono::seconds(10), [&] {
      for (std::size_t n = from; n < m_texts.size(); ++n) {
        if (check(m_texts[n])) return found = m_texts[n], true;
      }
      return false;
    });
    EXPECT_TRUE(is_there);
    return found;
  }
  Value answer(int n) {
    return text([n](const Value& one) { return one.contains("re") && one["re"].whole() == n; });
  }
  std::size_t count() {
    const std::lock_guard lock(m_guard);
    return m_texts.size();
  }
  bool has_frame() {
    std::unique_lock lock(m_guard);
    return m_changed.wait_for(lock, std::chrono::seconds(10), [&] { return !m_frames.empty(); });
  }

 private:
  std::mutex m_guard;
  std::condition_variable m_changed;
  std::vector<Value> m_texts;
  std::vector<std::shared_ptr<const FrameMessage>> m_frames;
};

class OperationPages : public ::testing::Test {
 protected:
  ScratchFolder m_folder;
  Folders m_folders{{m_folder.path()}};
  OperationViewer m_viewer{small_eye(), m_folders};
  std::shared_ptr<Watcher> m_page = std::make_shared<Watcher>();
  int m_id = m_viewer.join(m_page);

  Value ask(int n, const std::string& rest) {
    m_viewer.receive(m_id, "{\"n\": " + std::to_string(n) + ", " + rest + "}");
    return m_page->answer(n);
  }
  Value status(const std::function<bool(const Value&)>& check) {
    return m_page->text(
        [&](const Value& one) { return one.contains("status") && check(one["status"]); })["status"];
  }
};
using UnitOperationViewer = OperationPages;
using FaultOperationViewer = OperationPages;

}  // namespace

TEST_F(UnitOperationViewer, APageIsToldOfTheSceneAndSeesIt) {
  const Value scene = m_page->text([](const Value& one) { return one.contains("scene"); })["scene"];
  EXPECT_EQ(scene["instruments"][0]["name"].text(), "forceps");
  EXPECT_EQ(scene["instruments"][1]["kind"].text(), "lamp");
  EXPECT_TRUE(m_page->has_frame());
  status([](const Value& one) { return one["time_s"].number() > 0.05; });
}

TEST_F(UnitOperationViewer, AnInstrumentGoesWhereAMessageLeadsIt) {
  EXPECT_TRUE(ask(1, R"("instrument": {"name": "forceps", "tip": [0.5, 0.25, -9]})")["ok"].truth());
  const Value seen = status([](const Value& one) {
    const Value& tip = one["instruments"][0]["pose"]["tip"];
    return std::abs(tip[0].number() - 0.5) + std::abs(tip[1].number() - 0.25) +
               std::abs(tip[2].number() + 9) <
           0.01;
  });
  EXPECT_TRUE(seen["instruments"][0]["is_led"].truth());
  ask(2, R"("instrument": {"name": "forceps", "follow": true})");
  status([](const Value& one) { return !one["instruments"][0]["is_led"].truth(); });
}

TEST_F(UnitOperationViewer, TheModelOfAMembraneIsExchangedByAMessage) {
  status([](const Value& one) { return one["membranes"][0]["model"].text() == "springs"; });
  EXPECT_TRUE(ask(1, R"("membrane": {"name": "membrane", "model": "ecm"})")["ok"].truth());
  status([](const Value& one) { return one["membranes"][0]["model"].text() == "ecm"; });
}

TEST_F(UnitOperationViewer, TimeStandsStillWithoutPages) {
  status([](const Value& one) { return one["time_s"].number() > 0.05; });
  m_viewer.leave(m_id);
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  const auto second = std::make_shared<Watcher>();
  m_viewer.join(second);
  const Value first = second->text([](const Value& one) { return one.contains("status"); });
  EXPECT_LT(first["status"]["time_s"].number(), 0.3);
}

TEST_F(UnitOperationViewer, ASessionIsSavedOnceAndReplacedOnlyByForce) {
  ask(1, R"("operation": {"do": "pause"})");
  const Value saved = ask(2, R"("operation": {"do": "save", "path": "own.toml"})");
  ASSERT_TRUE(saved.contains("ok")) << json_text(saved);
  EXPECT_EQ(saved["ok"]["files"].size(), 3u);
  EXPECT_TRUE(std::filesystem::exists(m_folder / "own_forceps.csv"));
  const Value again = ask(3, R"("operation": {"do": "save", "path": "own.toml"})");
  EXPECT_NE(again["error"].text().find("exists"), std::string::npos);
  EXPECT_TRUE(
      ask(4, R"("operation": {"do": "save", "path": "own.toml", "force": true})").contains("ok"));
}

TEST_F(FaultOperationViewer, AMessageThatCannotBeDoneGetsOneErrorAndChangesNothing) {
  ask(1, R"("operation": {"do": "pause"})");
  int n = 1;
  for (const char* message :
       {R"("instrument": {"name": "scalpel", "tip": [0, 0, 0]})",
        R"("instrument": {"tip": [0, 0, 0]})",
        R"("instrument": {"name": "forceps", "tip": [0, 0]})",
        R"("instrument": {"name": "forceps", "tip": [0, 0, 1e9]})",
        R"("instrument": {"name": "forceps", "axis": [0, 0, 0]})",
        R"("instrument": {"name": "forceps", "opening": "wide"})",
        R"("instrument": {"name": "forceps", "opning": 3})", R"("instrument": 7)",
        R"("membrane": {"name": "membrane"})", R"("membrane": {"name": "skin", "model": "ecm"})",
        R"("membrane": {"name": "membrane", "model": "fem"})", R"("view": {"stereo": "cinema"})",
        R"("view": {"zoom": 0})", R"("operation": {"do": "explode"})",
        R"("operation": {"do": "save"})", R"("operation": {"do": "save", "path": "../own.toml"})",
        R"("operation": {"do": "save", "path": "own.csv"})"}) {
    const Value answer = ask(++n, message);
    ASSERT_TRUE(answer.contains("error")) << message;
    EXPECT_EQ(answer["error"].text().find('\n'), std::string::npos);
  }
  const std::size_t from = m_page->count();
  m_viewer.receive(m_id, R"({"view": {"zoom": "far"}})");
  const Value log = m_page->text([](const Value& one) { return one.contains("log"); }, from);
  EXPECT_NE(log["log"]["text"].text().find("zoom"), std::string::npos);
  ask(++n, R"("view": {"zoom": 2})");
  const Value after = status([](const Value& one) { return one["view"]["zoom"].number() == 2; });
  EXPECT_FALSE(after["instruments"][0]["is_led"].truth());
}

TEST_F(FaultOperationViewer, WhatIsNoMessageOfAnOperationClosesTheConnection) {
  for (const char* text : {"", "[]", "{}", R"({"event": {"kind": "undo"}})", R"({"ack": -1})",
                           R"({"instrument": {}, "view": {}})"}) {
    EXPECT_THROW(m_viewer.receive(m_id, text), BadMessage) << text;
  }
}
