// A parser tried in a child process: what it does there, and what its caller is told.
#include <atomic>
#include <chrono>
#include <csignal>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "tests/support/sanitized.h"
#include "volumes/base/parallel.h"
#include "volumes/base/process.h"

namespace supple::test {
namespace {

const Problem kAbout{"a.h5", "structure", "", "an intact file"};
const ChildBounds kBounds{std::int64_t(256) << 20, 1};

/// All tests of this program open files as the command line does.
class ChildProcesses : public ::testing::Environment {
  void SetUp() override { allow_child_processes(true); }
};
[[maybe_unused]] const auto* const kEnvironment =
    ::testing::AddGlobalTestEnvironment(new ChildProcesses);

/// The problem that a trial ends with; the field is empty when it ends well.
Problem problem_of(const std::function<void()>& parse, const ChildBounds& bounds = kBounds) {
  try {
    run_in_child(kAbout, bounds, parse);
  } catch (const InputError& error) {
    return error.problem();
  }
  return {};
}

TEST(UnitRunInChild, IsSwitchedOffForHostsThatDoNotAskForIt) {
  allow_child_processes(false);
  bool is_parsed = false;
  run_in_child(kAbout, kBounds, [&] { is_parsed = true; });
  allow_child_processes(true);
  EXPECT_FALSE(is_parsed);
  EXPECT_NE(problem_of([] { std::raise(SIGSEGV); }).field, "");
}

TEST(UnitRunInChild, LeavesNothingBehindInTheCaller) {
  int value = 1;
  EXPECT_EQ(problem_of([&] { value = 2; }).field, "");
  EXPECT_EQ(value, 1);
}

TEST(UnitRunInChild, PassesOnTheProblemThatTheParserFinds) {
  const Problem found{"b.h5", "field", std::string(100000, 'f'), ""};
  const Problem told = problem_of([&] { throw InputError(found); });
  EXPECT_EQ(told.file, found.file);
  EXPECT_EQ(told.field, found.field);
  EXPECT_EQ(told.found, found.found);
  EXPECT_EQ(told.expected, found.expected);
}

TEST(UnitRunInChild, OtherErrorsAreMetByTheCallerOnRepeating) {
  EXPECT_EQ(problem_of([] { throw SystemError("no permission"); }).field, "");
}

TEST(FaultRunInChild, ACrashIsAProblemOfTheFile) {
  const Problem told = problem_of([] { std::raise(SIGSEGV); });
  EXPECT_EQ(told.file, kAbout.file);
  EXPECT_EQ(told.field, kAbout.field);
  EXPECT_EQ(told.found, "damage that the library does not survive");
  EXPECT_EQ(told.expected, kAbout.expected);
}

TEST(FaultRunInChild, AnEndlessLoopIsStopped) {
  const Problem told = problem_of([] {
    for (volatile unsigned n = 0;; n = n + 1) {
    }
  });
  EXPECT_EQ(told.found, "damage that takes more than 1 s to parse");
}

TEST(FaultRunInChild, WaitingForeverIsStopped) {
  ChildBounds bounds = kBounds;
  bounds.seconds = 1;
  const Problem told = problem_of(
      [] {
        for (;;) ::pause();
      },
      bounds);
  EXPECT_EQ(told.found, "damage that takes more than 1 s to parse");
}

/// Threads of the caller that are about to fall asleep hold locks, for a moment: without an arena
/// of its own about one child in 2,000 waits forever.
TEST(UnitRunInChild, RunsParallelLoopsAlone) {
  const ThreadLimit more(6);
  ChildBounds bounds = kBounds;
  bounds.seconds = 20;
  std::atomic<int> sum{0};
  const auto loop = [&] {
    parallel_for(64, [&](int n) {
      for (int k = 0; k < 200; ++k) sum += n & 1;
    });
  };
  for (int trial = 0; trial < cases(1000); ++trial) {
    loop();
    const auto now = std::chrono::steady_clock::now;
    for (const auto start = now(); now() < start + std::chrono::microseconds(trial * 7 % 400);) {
    }
    const Problem told = problem_of(
        [&] {
          sum = 0;
          loop();
          if (sum != 32 * 200) throw InputError({"", "sum", std::to_string(sum.load()), "6400"});
        },
        bounds);
    ASSERT_EQ(told.field, "") << trial << " " << told.found;
  }
}

TEST(FaultRunInChild, EndlessAllocationIsStopped) {
  const Problem told = problem_of([] {
    std::vector<std::vector<char>> blocks;
    for (;;) blocks.emplace_back(1 << 16, 'x');
  });
  // A sanitizer ends the child where memory is refused.
  EXPECT_EQ(told.field, kAbout.field) << told.found;
}

TEST(UnitRunInChild, ASignalToStopIsNoDamage) {
  EXPECT_EQ(problem_of([] { std::raise(SIGINT); }).field, "");
}

}  // namespace
}  // namespace supple::test
