// The laboratory is a program of its own, started by `supple` with the same command line.
#include <filesystem>

#include <gtest/gtest.h>

#include "tests/support/program.h"

namespace fs = std::filesystem;
using namespace supple::test;

namespace {

/// A folder with a copy of `supple` and, below its name, a script in place of the laboratory.
class UnitLabProgram : public ::testing::Test {
 protected:
  UnitLabProgram() {
    std::error_code other_disk;
    fs::create_hard_link(std::getenv("SUPPLE_BINARY"), m_supple, other_disk);
    if (other_disk) fs::copy_file(std::getenv("SUPPLE_BINARY"), m_supple);
  }
  void write_lab(const std::string& script) {
    write_text(m_folder / "supple-lab", "#!/bin/sh\n" + script);
    fs::permissions(m_folder / "supple-lab", fs::perms::owner_all);
  }
  Outcome run(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), m_supple);
    return run_program(arguments);
  }

  TemporaryFolder m_folder;
  std::string m_supple = m_folder / "supple";
};

TEST_F(UnitLabProgram, TakesTheWholeCommandLineAndGivesItsExitCode) {
  write_lab("for word; do echo \"[$word]\"; done; exit 7\n");
  const Outcome outcome = run({"--threads", "2", "stress", "--list", "--only", "two words"});
  EXPECT_EQ(outcome.exit_code, 7);
  EXPECT_EQ(outcome.out, "[--threads]\n[2]\n[stress]\n[--list]\n[--only]\n[two words]\n");
  EXPECT_EQ(run({"bench", "ecm"}).out, "[bench]\n[ecm]\n");
}

TEST_F(UnitLabProgram, IsNotStartedForAWrongCommandLineOrForHelp) {
  write_lab("exit 7\n");
  EXPECT_EQ(run({"stress", "--frobnicate"}).exit_code, 2);
  EXPECT_EQ(run({"bench"}).exit_code, 2);
  EXPECT_EQ(run({"tradeoff", "--help"}).exit_code, 0);
}

TEST_F(UnitLabProgram, IsNamedWhereItIsMissing) {
  const Outcome outcome = run({"stress", "--list"});
  EXPECT_EQ(outcome.exit_code, 4);
  EXPECT_EQ(outcome.err, "supple: error: " + (m_folder / "supple-lab") +
                             ": found no such program, expected the one of bench, stress and "
                             "tradeoff (target supple-lab)\n");
}

}  // namespace
