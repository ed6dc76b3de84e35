// A session's kept journal comes to the disk within a second, and nobody waits for that.
#include <atomic>
#include <chrono>
#include <filesystem>
#include <string>
#include <thread>

#include <gtest/gtest.h>
#include <unistd.h>

#include "tests/support/temporary_folder.h"
#include "tools/viewer/kept_sessions.h"
#include "volumes/base/json.h"
#include "volumes/base/toml.h"

using namespace supple;
using namespace supple::tools;
using namespace supple::test;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

namespace {

std::atomic<int> g_syncs{0};
std::atomic<int> g_slow_ms{0};

const char* const kJournal =
    "[volume]\npath = \"a.nrrd\"\n[[event]]\nkind = \"anchor\"\ngrab = [1, 2, 3]\n";

void wait_until_syncs(int count) {
  const auto end = Clock::now() + 20s;
  while (g_syncs < count && Clock::now() < end) std::this_thread::sleep_for(5ms);
}

}  // namespace

/// Stands in place of the system's, which this program calls by name.
extern "C" int fdatasync(int) {
  if (g_slow_ms > 0) std::this_thread::sleep_for(std::chrono::milliseconds(g_slow_ms));
  ++g_syncs;
  return 0;
}

TEST(UnitKeptJournal, EventsReachTheDiskWithinASecondAndDoNotWaitForIt) {
  TemporaryFolder folder;
  g_syncs = 0;
  KeptJournal kept(folder / "sessions", "a.nrrd", "",
                   [](const std::string& line) { FAIL() << line; });
  const auto journal = [] { return parse_toml(kJournal, "journal"); };
  kept.add(parse_json(R"({"kind": "anchor", "grab": [1, 2, 3]})"), false, journal);
  EXPECT_EQ(g_syncs, 1) << "on the disk before it has its name";
  g_slow_ms = 200;
  const auto begun = Clock::now();
  for (int n = 0; n < 100; ++n) {
    kept.add(parse_json(R"({"kind": "drag", "to": [0, 0, 1]})"), n % 2 == 1, journal);
  }
  EXPECT_LT(Clock::now() - begun, 4s) << "a hundred waits would be 20 s";
  wait_until_syncs(2);
  kept.add(parse_json(R"({"kind": "drag", "to": [0, 0, 2]})"), false, journal);
  wait_until_syncs(3);
  EXPECT_GE(g_syncs, 3) << "what was written since is brought by the next";
  std::this_thread::sleep_for(1200ms);
  EXPECT_LE(g_syncs, 3) << "nothing is left to be brought";
  g_slow_ms = 0;
}

TEST(UnitKeptJournal, WhatWasWrittenLastIsOnTheDiskWhenItEnds) {
  TemporaryFolder folder;
  g_syncs = 0;
  {
    KeptJournal kept(folder / "sessions", "a.nrrd", "", [](const std::string&) {});
    const auto journal = [] { return parse_toml(kJournal, "journal"); };
    kept.add(parse_json(R"({"kind": "anchor", "grab": [1, 2, 3]})"), false, journal);
    kept.add(parse_json(R"({"kind": "drag", "to": [0, 0, 1]})"), false, journal);
    wait_until_syncs(2);
    kept.add(parse_json(R"({"kind": "drag", "to": [0, 0, 2]})"), false, journal);
  }
  EXPECT_EQ(g_syncs, 3);
}
