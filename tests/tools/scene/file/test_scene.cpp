#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"
#include "tests/support/sanitized.h"

using namespace supple::test;

namespace {

class UnitScene : public ::testing::Test {
 protected:
  void SetUp() override {
    write_ball(m_folder, "ball", 16);
    write_soft_material(m_folder / "soft.toml");
  }

  Outcome run_scene(const std::string& text, const std::vector<std::string>& more = {}) {
    write_text(m_folder / "scene.toml", text);
    std::vector<std::string> arguments = {"run", m_folder / "scene.toml", "-o", m_folder / "out"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_supple(arguments);
  }

  void expect_refused(const std::string& text, const std::vector<std::string>& words) {
    const Outcome outcome = run_scene(text);
    EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
    for (const std::string& word : words) {
      EXPECT_NE(outcome.err.find(word), std::string::npos) << word << " in " << outcome.err;
    }
  }

  const std::string m_head = "[volume]\npath = \"ball.nhdr\"\n[material]\ntable = \"soft.toml\"\n";
  TemporaryFolder m_folder;
};

}  // namespace

TEST_F(UnitScene, TheSmallestSceneWritesWhatItNames) {
  const Outcome outcome =
      run_scene(m_head +
                "[[step]]\ngrab = [8, 8, 8]\nby = [2.0, 0.0, 0.0]\n"
                "[[view]]\nimage = \"a.png\"\nsize = [64, 48]\n"
                "[output]\nstate = \"a.vdb\"\noffsets = [\"a.nrrd\", \"a.mha\"]\n"
                "displacements = [\"u.nrrd\"]\nvolumes = [\"v.nrrd\"]\n");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  for (const char* name : {"a.png", "a.vdb", "a.nrrd", "a.mha", "u.nrrd", "v.nrrd"}) {
    EXPECT_TRUE(std::filesystem::exists(m_folder / ("out/" + std::string(name)))) << name;
  }
}

TEST_F(UnitScene, ADryRunWritesNothing) {
  RUN_WHEN_SANITIZED();
  const Outcome outcome = run_scene(m_head + "[[view]]\nimage = \"a.png\"\n", {"--dry-run"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("a.png"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(m_folder / "out"));
}

TEST_F(UnitScene, OutputsLeaveTheFolderOnlyWhereThatIsAllowed) {
  const std::string step = "[[step]]\ngrab = [8, 8, 8]\nby = [2.0, 0.0, 0.0]\n";
  expect_refused(m_head + step + "[output]\nstate = \"../a.vdb\"\n",
                 {"../a.vdb", "--allow-outside"});
  expect_refused(m_head + step + "[output]\noffsets = [\"" + m_folder / "w.nrrd" + "\"]\n",
                 {"w.nrrd", "--allow-outside"});
  expect_refused(m_head + "[[view]]\nimage = \"b/../../a.png\"\n", {"a.png", "--allow-outside"});
  EXPECT_EQ(m_folder.entries(),
            (std::vector<std::string>{"ball.nhdr", "ball.raw", "scene.toml", "soft.toml"}));
  const std::string volumes = m_head + step + "[output]\nvolumes = [\"b/../v.nrrd\", \"" +
                              m_folder / "out/w.nrrd" + "\"]\n";
  EXPECT_EQ(run_scene(volumes).exit_code, 0) << "names that stay inside";
  const Outcome allowed =
      run_scene(m_head + step + "[output]\nstate = \"../a.vdb\"\n", {"--allow-outside"});
  EXPECT_EQ(allowed.exit_code, 0) << allowed.err;
  EXPECT_TRUE(std::filesystem::exists(m_folder / "a.vdb"));
}

TEST_F(UnitScene, UnknownKeysNameLineAndSuggestion) {
  expect_refused(m_head + "[[step]]\ngrap = [8, 8, 8]\nby = [2.0, 0.0, 0.0]\n",
                 {"scene.toml:6", "grap", "'grab'"});
  expect_refused(m_head + "[[view]]\nimage = \"a.png\"\npresett = \"Bone\"\n",
                 {"scene.toml:7", "presett", "'preset'"});
  expect_refused(m_head + "[[view]]\nimge = \"a.png\"\n", {"scene.toml:6", "imge", "'image'"});
  expect_refused("[volume]\npth = \"ball.nhdr\"\n", {"scene.toml:2", "pth", "'path'"});
  expect_refused(m_head + "[[step]]\nhandles = [{ grap = [8, 8, 8], by = [1.0, 0.0, 0.0] }]\n",
                 {"scene.toml:6", "grap", "'grab'"});
  expect_refused(m_head + "[outputs]\nstate = \"a.vdb\"\n", {"outputs", "'output'"});
}

TEST_F(UnitScene, WrongValuesNameTheKeyAndWhatIsExpected) {
  expect_refused("[[view]]\nimage = \"a.png\"\n", {"volume"});
  expect_refused(m_head + "[[view]]\nimage = 3\n", {"view[1].image", "a string"});
  expect_refused(m_head + "[[view]]\nimage = \"a.png\"\npreset = \"CT-Wood\"\n", {"CT-Wood"});
  expect_refused(m_head + "[[view]]\nimage = \"a.png\"\nsize = [0, 9]\n", {"scene.toml:7", "size"});
  expect_refused(m_head + "[[view]]\nimage = \"a.png\"\nstep = 0.0\n", {"scene.toml:7", "step"});
  expect_refused(m_head + "[[view]]\nimage = \"a.png\"\ncamera = { view = \"lft\" }\n",
                 {"scene.toml:7", "view[1].camera.view", "left"});
  expect_refused(m_head + "[[view]]\nimage = \"a.jpg\"\n", {"a.jpg", ".png"});
  expect_refused(m_head + "[[step]]\ngrab = [8, 8]\nby = [1.0, 0.0, 0.0]\n", {"grab", "three"});
  expect_refused(m_head + "[[step]]\ngrab = [8, 8, 8]\n", {"by"});
  expect_refused(m_head + "[[step]]\nat_mm = [900.0, 0.0, 0.0]\nby = [1.0, 0.0, 0.0]\n",
                 {"at_mm", "900"});
  expect_refused(m_head + "[output]\noffsets = [\"a.nrrd\", \"a.nrrd\"]\n", {"another output"});
  expect_refused(m_head + "[output\n", {"scene.toml:5"});
}

TEST_F(UnitScene, PositionsAndVectorsInLpsMeanTheSameAsVoxels) {
  RUN_WHEN_SANITIZED();
  // Index j runs to anterior, so that LPS and grid axes differ in sign: voxel (8, 8, 8) lies at
  // (8, 7, 12) mm.
  write_text(m_folder / "flipped.nhdr",
             "NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\n"
             "sizes: 16 16 16\nspace directions: (1,0,0) (0,-1,0) (0,0,1.5)\n"
             "space origin: (0,15,0)\nencoding: raw\ndata file: ball.raw\n");
  const std::string head = "[volume]\npath = \"flipped.nhdr\"\n[material]\ntable = \"soft.toml\"\n";
  const std::string voxels = "[[step]]\ngrab = [8, 8, 8]\nby = [2.0, 1.0, 3.0]\n";
  const std::string lps = "[[step]]\nat_mm = [8.2, 6.9, 12.1]\nby_mm_lps = [2.0, -1.0, 3.0]\n";
  const std::string output = "[output]\nvolumes = [\"v.nrrd\"]\n";
  ASSERT_EQ(run_scene(head + voxels + output).exit_code, 0);
  const std::string expected = read_text(m_folder / "out/v.nrrd");
  ASSERT_EQ(run_scene(head + lps + output, {"--force"}).exit_code, 0);
  EXPECT_EQ(read_text(m_folder / "out/v.nrrd"), expected);
}

TEST_F(UnitScene, ViewsShowTheStepTheyName) {
  RUN_WHEN_SANITIZED();
  const std::string step = "[[step]]\ngrab = [8, 8, 8]\nby = [3.0, 0.0, 0.0]\n";
  const std::string look = "preset = \"MR-Default\"\nsize = [64, 64]\n";
  const Outcome outcome =
      run_scene(m_head + step + "[[view]]\nimage = \"rest.png\"\ndeformed = false\n" + look +
                "[[view]]\nimage = \"before.png\"\nafter_step = 0\n" + look +
                "[[view]]\nimage = \"after.png\"\n" + look);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto differ = [&](const std::string& a, const std::string& b) {
    return run_supple({"compare", m_folder / ("out/" + a), m_folder / ("out/" + b), "--max-diff",
                       "0", "--quiet"})
        .exit_code;
  };
  EXPECT_EQ(differ("rest.png", "before.png"), 0);
  EXPECT_EQ(differ("rest.png", "after.png"), 1);
}

TEST_F(UnitScene, HandlesStayHeldUntilReleased) {
  RUN_WHEN_SANITIZED();
  // The second step drags the other side of the ball; the first handle must not follow.
  const std::string steps =
      "[[step]]\ngrab = [8, 8, 8]\nby = [2.0, 0.0, 0.0]\n"
      "[[step]]\ngrab = [9, 8, 8]\nby = [20.0, 0.0, 0.0]\n";
  const Outcome held = run_scene(m_head + steps + "[output]\nstate = \"a.vdb\"\n", {"--json"});
  ASSERT_EQ(held.exit_code, 0) << held.err;
  EXPECT_NE(held.err.find("anchors stopped the drag"), std::string::npos) << held.err;
  std::string released = steps;
  released.insert(released.rfind("grab"), "release = true\n");
  const Outcome free = run_scene(m_head + released + "[output]\nstate = \"b.vdb\"\n", {"--json"});
  ASSERT_EQ(free.exit_code, 0) << free.err;
  EXPECT_EQ(free.err.find("anchors stopped the drag"), std::string::npos) << free.err;
}

TEST_F(UnitScene, AStepUnderBallLimitsSaysSoInReportAndConfiguration) {
  RUN_WHEN_SANITIZED();
  const std::string step = "[[step]]\ngrab = [8, 8, 8]\nby = [2.0, 0.0, 0.0]\n";
  const Outcome outcome = run_scene(
      m_head + step + "limits = \"ball\"\n" + step + "[output]\nstate = \"a.vdb\"\n", {"--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto steps = nlohmann::json::parse(outcome.out)["steps"];
  EXPECT_EQ(steps[0]["limits"], "ball");
  EXPECT_GT(steps[0]["moved"], 0);
  EXPECT_GT(steps[0]["moves"], 0);
  EXPECT_EQ(steps[0]["violated"], 0);
  EXPECT_EQ(steps[1]["limits"], "box");
  EXPECT_NE(read_text(m_folder / "out/a.vdb").find("\"limits\":\"ball\""), std::string::npos);
  expect_refused(m_head + step + "limits = \"cube\"\n", {"limits", "cube", "ball"});
}

TEST_F(UnitScene, AStepUnderTightenedLimitsTightensAfterItsRelaxation) {
  RUN_WHEN_SANITIZED();
  const std::string step = "[[step]]\ngrab = [8, 8, 8]\nby = [2.0, 0.0, 0.0]\n";
  const std::string tighten = "limits = \"tighten\"\n";
  const Outcome outcome = run_scene(
      m_head + step + tighten + "relax = { passes = 5 }\n" + "[output]\nstate = \"a.vdb\"\n",
      {"--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto both = nlohmann::json::parse(outcome.out)["steps"][0];
  EXPECT_EQ(both["limits"], "tighten");
  EXPECT_EQ(both["fraction"], 1);
  EXPECT_EQ(both["relax"]["passes"], 5);
  EXPECT_GT(both["tighten"]["links"], 0);
  EXPECT_GT(both["tighten"]["iterations"], 0);
  EXPECT_LT(both["tighten"]["excess_voxels"], both["tighten"]["excess_before_voxels"]);
  EXPECT_NE(read_text(m_folder / "out/a.vdb").find("\"limits\":\"tighten\""), std::string::npos);
  // The same in three steps, the last of which does nothing else.
  const Outcome apart = run_scene(m_head + step + "[[step]]\nrelax = { passes = 5 }\n[[step]]\n" +
                                      tighten + "[output]\nstate = \"b.vdb\"\n",
                                  {"--json"});
  ASSERT_EQ(apart.exit_code, 0) << apart.err;
  auto alone = nlohmann::json::parse(apart.out)["steps"][2]["tighten"], after = both["tighten"];
  alone.erase("tighten_ms");
  after.erase("tighten_ms");
  EXPECT_EQ(alone, after);
}

TEST_F(UnitScene, DeformKnowsBallAndTightenedLimits) {
  const std::vector<std::string> deform = {"deform",     m_folder / "ball.nhdr",
                                           "--material", m_folder / "soft.toml",
                                           "--grab",     "8,8,8",
                                           "--by",       "2,0,0",
                                           "--json",     "-o"};
  const auto with = [&](const std::string& limits, const std::string& name) {
    std::vector<std::string> arguments = deform;
    arguments.insert(arguments.end(), {m_folder / name, "--limits", limits});
    return run_supple(arguments);
  };
  const Outcome ball = with("ball", "ball.vdb"), box = with("box", "box.vdb");
  ASSERT_EQ(ball.exit_code, 0) << ball.err;
  ASSERT_EQ(box.exit_code, 0) << box.err;
  EXPECT_EQ(nlohmann::json::parse(ball.out)["limits"], "ball");
  EXPECT_EQ(nlohmann::json::parse(box.out)["limits"], "box");
  EXPECT_EQ(with("cube", "cube.vdb").exit_code, 2);
  const Outcome tighten = with("tighten", "tighten.vdb");
  ASSERT_EQ(tighten.exit_code, 0) << tighten.err;
  EXPECT_EQ(nlohmann::json::parse(tighten.out)["limits"], "tighten");
  EXPECT_GT(nlohmann::json::parse(tighten.out)["tighten"]["moved"], 0);
}
