// The matrix of extremes: verdicts on rows by themselves, children that do not end well, and rows
// of the program.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"
#include "tests/support/sanitized.h"
#include "tools/lab/stress/stress_verdict.h"

using namespace supple;
using namespace supple::test;
using namespace supple::tools;

namespace {

ChildEnd ended_with(int exit_code, const std::string& out, const std::string& complaint) {
  ChildEnd end;
  end.exit_code = exit_code;
  end.out = out;
  end.complaint = complaint;
  return end;
}

ChildEnd run_shell(const std::string& script, const ProgramLimits& limits) {
  return run_child("/bin/sh", {"-c", script}, limits, [] { return false; });
}

const ExpectedRefusal kRefusal{3, "16383"};

TEST(UnitStressVerdict, ARowAgreesIfAllThatItMeasuredHolds) {
  const auto row = [](double value) {
    return ended_with(0, to_json(MeasuredValues{{"way", value, 0, 1}, {"b", 2, 2, 2}}).dump(), "");
  };
  const StressVerdict inside = verdict_of(nullptr, row(1));
  EXPECT_TRUE(inside.agrees);
  EXPECT_EQ(inside.found, "way 1, b 2");
  ASSERT_EQ(inside.measured.size(), 2u);
  const StressVerdict outside = verdict_of(nullptr, row(1.5));
  EXPECT_FALSE(outside.agrees);
  EXPECT_EQ(outside.found, "way 1.5 (not 0 to 1), b 2");
  EXPECT_FALSE(verdict_of(nullptr, row(std::nan(""))).agrees);
  EXPECT_FALSE(verdict_of(nullptr, row(std::numeric_limits<double>::infinity())).agrees);
}

TEST(UnitStressVerdict, ARowThatMeasuredNothingDoesNotAgree) {
  EXPECT_FALSE(verdict_of(nullptr, ended_with(0, "[]", "")).agrees);
  EXPECT_EQ(verdict_of(nullptr, ended_with(0, "", "")).found, "no results on stdout");
}

TEST(UnitStressVerdict, ARefusalNeedsItsExitCodeAndItsText) {
  const std::string text = "by: found 20000 voxels, expected at most 16383";
  EXPECT_TRUE(verdict_of(&kRefusal, ended_with(3, "", text)).agrees);
  EXPECT_FALSE(verdict_of(&kRefusal, ended_with(1, "", text)).agrees);
  EXPECT_FALSE(verdict_of(&kRefusal, ended_with(3, "", "by: bad")).agrees);
  EXPECT_FALSE(verdict_of(nullptr, ended_with(3, "", text)).agrees);
  const StressVerdict kept =
      verdict_of(&kRefusal, ended_with(0, to_json(MeasuredValues{{"way", 1, 0, 1}}).dump(), ""));
  EXPECT_FALSE(kept.agrees);
  EXPECT_EQ(kept.found, "not refused: way 1");
}

TEST(UnitChildProcess, ACrashAHangAndTooMuchMemoryAreToldApart) {
  EXPECT_EQ(run_program("supple-is-not-called-so", {}, "", {}, [] { return false; }).exit_code,
            kNoSuchProgram);
  EXPECT_EQ(run_program("pwd", {}, "/usr", {}, [] { return false; }).out, "/usr\n");
  const ChildEnd crash = run_shell("kill -SEGV $$", {});
  EXPECT_EQ(crash.exit_code, -1);
  EXPECT_EQ(crash.complaint, "ended by signal 11");
  EXPECT_FALSE(verdict_of(&kRefusal, crash).agrees);
  const ChildEnd hang = run_shell("exec sleep 30", {0.2});
  EXPECT_TRUE(hang.timed_out);
  EXPECT_EQ(hang.complaint, "no result after 0.2 s");
  EXPECT_LT(hang.wall_s, 20);
  const ChildEnd large = run_shell(
      "exec python3 -c 'x = bytearray(300000000); import time; time.sleep(30)'", {20, 100});
  EXPECT_TRUE(large.over_memory);
  EXPECT_FALSE(large.timed_out);
  EXPECT_EQ(large.complaint, "more than 100 MB");
}

TEST(UnitChildProcess, TheReportOfASanitizerIsTheComplaint) {
  const ChildEnd end = run_shell(
      "echo 'a.cpp:1:2: runtime error: division by zero' >&2; echo '    #0 main' >&2; exit 1", {});
  EXPECT_EQ(end.complaint, "a.cpp:1:2: runtime error: division by zero");
  EXPECT_EQ(run_shell("echo one >&2; echo 'supple: error: two' >&2; echo three >&2", {}).complaint,
            "two");
}

/// Rows as the program tells them, all of which must agree.
void expect_agreeing(const std::vector<std::string>& options, std::size_t least_rows) {
  std::vector<std::string> arguments = {"stress", "--json", "--patience", "10"};
  arguments.insert(arguments.end(), options.begin(), options.end());
  const Outcome outcome = run_supple(arguments);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto rows = nlohmann::json::parse(outcome.out).at("rows");
  EXPECT_GE(rows.size(), least_rows);
  for (const auto& row : rows) {
    EXPECT_TRUE(row.at("agrees").get<bool>())
        << row.at("extreme") << " " << row.at("model") << ": " << row.at("found");
  }
}

TEST(ExtremesStress, OneModelUnderEveryExtremeKeepsItsPromiseOrRefuses) {
  RUN_WHEN_SANITIZED();
  expect_agreeing({"--quick"}, 35);
}

}  // namespace
