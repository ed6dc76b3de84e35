// Models in live sessions: finite elements after a release, what they hold, their accuracy and
// price.
#include <algorithm>
#include <cstdlib>

#include <gtest/gtest.h>

#include "lib/body/body.h"
#include "lib/body/slot_set.h"
#include "lib/state/state.h"
#include "tests/tools/scene/live/replay_fixture.h"

using namespace supple;
using namespace supple::test;

TEST_F(UnitReplay, ModelsWithoutSidesTakeASoftHandleAndRefuseATool) {
  const std::string held = event("anchor", "grab_box = [4, 4, 8, 20, 20, 9]");
  const auto grabbed = [](const std::string& kind) {
    return event(kind, "grab_ball = [12, 12, 16]\nradius = 2" +
                           std::string(kind == "grab" ? "\nsoft = 5" : "")) +
           event("drag", "to = [0.5, 1, 0.5]") + event("release");
  };
  const std::string by_fem = held + event("model", "model = \"fem\"");
  const std::string file = journal(by_fem + grabbed("grab") + grabbed("grab"));
  const std::string once = hash(file, "--threads 1 --scene " + (m_folder / "batch.toml") +
                                          " --state " + (m_folder / "end.vdb"));
  EXPECT_EQ(once.size(), 64u);
  EXPECT_EQ(hash(m_folder / "batch.toml", "--threads 2"), once);
  const State end = read_state(m_folder / "end.vdb");
  Slot middle;
  ASSERT_TRUE(slot_of(end.elements, {12, 12, 16}, middle));
  EXPECT_EQ(end.q[1].at(middle), 2 * kFixedOne);

  const Outcome tool = replay(journal(by_fem + grabbed("push")));
  EXPECT_EQ(tool.exit_code, 3);
  EXPECT_NE(tool.err.find("push handle of an earlier drag"), std::string::npos) << tool.err;

  const std::string soft = held + grabbed("grab");
  const std::string again =
      event("grab", "grab = [12, 16, 14]") + event("drag", "to = [0, 0.2, 0]");
  for (const char* other :
       {"model = \"springs\"\nsprings = { time = 0.01 }", "limits = \"ball\""}) {
    const std::string kind = std::string(other).substr(0, 6) == "limits" ? "limits" : "model";
    const Outcome run = replay(journal(soft + event(kind, other) + again));
    EXPECT_EQ(run.exit_code, 0) << other << run.err;
  }
}

TEST_F(UnitReplay, PicturesByFiniteElementsGoOnFromEachOtherAndUndoTakesThatBack) {
  const auto stroke = [](const std::string& to) {
    return event("grab", "grab = [12, 12, 16]") + event("drag", "to = " + to) + event("release");
  };
  const std::string begin = event("anchor", "grab_box = [4, 4, 2, 20, 20, 9]") +
                            event("model", "model = \"fem\"\nfem = { accuracy = \"picture\" }") +
                            stroke("[0, 1, 0]");
  const std::string file = journal(begin + stroke("[0, 0.5, 0.5]") + event("undo", "all = true") +
                                   stroke("[0.5, 0, 0]") + stroke("[0.1, 0, 0.2]"));
  const std::string end = hash(
      file, "--scene " + (m_folder / "batch.toml") + " --journal " + (m_folder / "carried.toml"));
  EXPECT_EQ(hash(m_folder / "carried.toml"), end);
  EXPECT_EQ(hash(m_folder / "batch.toml", "--threads 1"), end);
  EXPECT_EQ(hash(journal(begin + stroke("[0.5, 0, 0]") + stroke("[0.1, 0, 0.2]"))), end);
}

TEST_F(UnitReplay, TheModelOfASessionSaysItsPrice) {
  const std::string file =
      journal(event("model", "model = \"springs\"") + event("model", "model = \"fem\"") +
              event("model", "model = \"ecm\""));
  const Outcome run = run_line("replay " + file + " --size 96,96");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.err.find("supple: springs on 3184 elements: some "), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("supple: finite elements on 3184 elements: some "), std::string::npos)
      << run.err;
  EXPECT_NE(run.err.find(" GB for each drag"), std::string::npos) << run.err;
}

TEST_F(UnitReplay, FiniteElementsTakeOverAfterTheRelease) {
  const std::string model = "model = \"fem\"\nfem = { tolerance = 1e-9 }";
  const std::string drags =
      event("model", model) + event("anchor", "grab_box = [4, 4, 2, 20, 20, 9]") +
      event("grab", "grab = [12, 12, 16]") + event("drag", "to = [0.3, 0.5, 0.2]") +
      event("drag", "to = [0.5, 1.25, 0.75]");
  const std::string file = journal(drags + event("release"));
  const std::string end =
      hash(file, "--state " + (m_folder / "live.vdb") + " --scene " + (m_folder / "batch.toml") +
                     " --journal " + (m_folder / "carried.toml"));
  EXPECT_NE(hash(journal(drags)), end);
  EXPECT_EQ(hash(m_folder / "carried.toml"), end);
  EXPECT_EQ(hash(m_folder / "batch.toml"), end);
  EXPECT_EQ(hash(journal(drags + event("release", "all = true"))), end);
  // The equilibrium does not depend on the way there.
  journal("[[step]]\nfix = [[4, 4, 2, 20, 20, 9]]\ngrab = [12, 12, 16]\nby = [0.5, 1.25, 0.75]\n" +
              model + "\n[output]\nstate = \"whole.vdb\"\n",
          "whole.toml");
  ASSERT_EQ(
      run_line("run " + (m_folder / "whole.toml") + " --quiet --force -o " + (m_folder / "out"))
          .exit_code,
      0);
  const State live = read_state(m_folder / "live.vdb"),
              whole = read_state(m_folder / "out/whole.vdb");
  std::int32_t differs = 0, longest = 0;
  for_each_element(whole.elements, [&](Slot slot) {
    for (std::size_t c = 0; c < 3; ++c) {
      const std::int32_t q = whole.q[c].at(slot);
      differs = std::max(differs, std::abs(q - live.q[c].at(slot)));
      longest = std::max(longest, std::abs(q));
    }
  });
  EXPECT_LE(differs, 3);
  EXPECT_GT(longest, 65536);
  // It belongs to the stroke of the drags.
  const std::string rest = hash(journal(drags.substr(0, drags.find("[[event]]\nkind = \"grab\""))));
  EXPECT_EQ(hash(journal(drags + event("release") + event("undo", "all = true"))), rest);
}
