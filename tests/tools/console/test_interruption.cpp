// Signals leave nothing behind, whether the program looks at them in time or not.
#include <chrono>
#include <csignal>
#include <set>

#include <gtest/gtest.h>

#include "tests/support/program.h"
#include "tests/support/sanitized.h"
#include "volumes/base/atomic_file.h"
#include "volumes/base/files.h"

using namespace supple;
using namespace supple::test;

TEST(FaultInterruption, CtrlCLeavesNoPartialFile) {
  RUN_WHEN_SANITIZED();
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

TEST(FaultInterruption, SigtermDoesNotWaitForALibrary) {
  RUN_WHEN_SANITIZED();
  const TemporaryFolder folder;
  write_ball(folder, "ball", 64);
  write_soft_material(folder / "soft.toml");
  write_text(folder / "scene.toml",
             "[volume]\npath = \"ball.nhdr\"\n[material]\ntable = \"soft.toml\"\n[[step]]\n"
             "model = \"springs\"\nsprings = { integrator = \"projective\" }\n"
             "[output]\nstate = \"new/out.vdb\"\n");
  const auto before = folder.entries();
  RunOptions options;
  options.interrupt_at_file = folder / "out";
  options.interrupt_after_s = 1;  // inside a factorisation of minutes
  options.interrupt_by = SIGTERM;
  const auto start = std::chrono::steady_clock::now();
  const Outcome outcome = run_supple({"run", folder / "scene.toml", "-o", folder / "out"}, options);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  EXPECT_EQ(outcome.exit_code, 128 + SIGTERM) << outcome.err;
  EXPECT_NE(outcome.err.find("no output was left incomplete"), std::string::npos) << outcome.err;
  EXPECT_LT(seconds.count(), 10);  // 0.5 s after the signal on an idle machine
  EXPECT_EQ(folder.entries(), before);
}

TEST(FaultInterruption, WhatRemainsOfAnOutputIsAllThatWasMadeForIt) {
  RUN_WHEN_SANITIZED();
  const TemporaryFolder folder;
  ReservedNames names;
  const std::vector<Remains> remains = names.add(folder / "new/deep/out.vdb");
  const AtomicFile file(folder / "new/deep/out.vdb");
  std::set<std::string> made;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.path())) {
    made.insert(entry.path());
  }
  EXPECT_EQ(made.size(), 4u);
  EXPECT_EQ(remains.size(), made.size());
  for (auto left = remains.rbegin(); left != remains.rend(); ++left) {
    EXPECT_EQ(made.erase(left->path), 1u) << left->path;
    left->remove();
  }
  EXPECT_EQ(folder.entries(), std::vector<std::string>{});
}
