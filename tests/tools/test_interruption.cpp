#include <csignal>

#include <gtest/gtest.h>

#include "tests/support/program.h"

using namespace supple::test;

TEST(FaultInterruption, CtrlCLeavesNoPartialFile) {
  const TemporaryFolder folder;
  write_ball(folder, "ball", 128);
  write_soft_material(folder / "soft.toml");
  const auto before = folder.entries();
  int interrupted = 0;
  for (const double seconds : {0.05, 0.15, 0.3, 0.5}) {
    RunOptions options;
    options.interrupt_after_s = seconds;
    const Outcome outcome =
        run_supple({"deform", folder / "ball.nhdr", "--material", folder / "soft.toml", "--grab",
                    "64,64,64", "--by", "30,10,5", "-o", folder / "out.vdb", "--force"},
                   options);
    if (outcome.exit_code != 0) {
      EXPECT_EQ(outcome.exit_code, 128 + SIGINT) << outcome.err;
      ++interrupted;
    }
    // The signal may come after the rename; what lies under the final name is whole then too.
    if (std::filesystem::exists(folder / "out.vdb")) {
      EXPECT_EQ(run_supple({"info", folder / "out.vdb"}).exit_code, 0);
      std::filesystem::remove(folder / "out.vdb");
    }
    EXPECT_EQ(folder.entries(), before);
  }
  EXPECT_GT(interrupted, 0);
}
