// Procedural sampling paths in scenes and on the command line.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "raycast/pictures/compare.h"
#include "tests/support/program.h"
#include "tests/support/sanitized.h"
#include "volumes/io/format/volume_file.h"

using namespace supple;
using namespace supple::test;

namespace {

class OffsetFunctions : public testing::Test {
 protected:
  OffsetFunctions() {
    write_ball(m_folder, "ball", 24);
    write_soft_material(m_folder / "soft.toml");
  }

  Outcome run_scene(const std::string& text, const std::vector<std::string>& more = {}) {
    write_text(m_folder / "scene.toml", m_head + text);
    std::vector<std::string> arguments = {"run", m_folder / "scene.toml", "-o", m_folder / "out",
                                          "--force"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_supple(arguments);
  }
  Outcome render(const std::string& input, const std::string& image,
                 std::vector<std::string> more = {}) {
    std::vector<std::string> arguments = {"render",     input,     "--size",
                                          "64,64",      "--force", "--preset",
                                          "MR-Default", "-o",      m_folder / image};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_supple(arguments);
  }
  Image image(const std::string& name) const { return read_png(m_folder / name); }

  const std::string m_head = "[volume]\npath = \"ball.nhdr\"\n[material]\ntable = \"soft.toml\"\n";
  const std::string m_step = "[[step]]\ngrab = [12, 12, 12]\nby = [3.0, 1.0, 0.0]\n";
  const std::string m_twist = "{ function = \"twist\", axis = [0, 0.3, 1], angle = 50 }";
  const std::string m_open = "{ function = \"cut-open\", normal = [1, 0.2, 0], gap = 5 }";
  const std::string m_view = "[[view]]\npreset = \"MR-Default\"\nsize = [64, 64]\nimage = ";
  TemporaryFolder m_folder;
};

using UnitOffsetFunctions = OffsetFunctions;
using FaultOffsetFunctions = OffsetFunctions;

TEST_F(UnitOffsetFunctions, ASceneAViewAndTheCommandLineShowTheSamePicture) {
  const std::string both = "path = [" + m_open + ", " + m_twist + "]\n";
  write_text(m_folder / "both.toml", both);
  ASSERT_EQ(run_scene(m_step + m_view + "\"view.png\"\n" + both + m_view + "\"plain.png\"\n" +
                      "[output]\nstate = \"drag.vdb\"\n")
                .exit_code,
            0);
  write_text(m_folder / "scene.toml", both + m_head + m_step + m_view + "\"scene.png\"\n");
  ASSERT_EQ(run_supple({"run", m_folder / "scene.toml", "-o", m_folder / "out"}).exit_code, 0);
  const std::string state = m_folder / "out/drag.vdb";
  ASSERT_EQ(render(state, "out/line.png", {"--path", m_folder / "both.toml"}).exit_code, 0);
  EXPECT_EQ(image("out/view.png").rgba, image("out/scene.png").rgba);
  EXPECT_EQ(image("out/view.png").rgba, image("out/line.png").rgba);
  EXPECT_LT(compare(image("out/view.png"), image("out/plain.png"), true).ssim, 0.98);
}

TEST_F(UnitOffsetFunctions, FunctionsOfASceneComeBeforeThoseOfAView) {
  write_text(m_folder / "scene.toml", "path = " + m_open + "\n" + m_head + m_view +
                                          "\"split.png\"\npath = " + m_twist + "\n");
  ASSERT_EQ(run_supple({"run", m_folder / "scene.toml", "-o", m_folder / "out"}).exit_code, 0);
  ASSERT_EQ(run_scene(m_view + "\"both.png\"\npath = [" + m_open + ", " + m_twist + "]\n" + m_view +
                      "\"turned.png\"\npath = [" + m_twist + ", " + m_open + "]\n")
                .exit_code,
            0);
  EXPECT_EQ(image("out/split.png").rgba, image("out/both.png").rgba);
  EXPECT_NE(image("out/split.png").rgba, image("out/turned.png").rgba);
}

TEST_F(UnitOffsetFunctions, FunctionsThatMoveNothingChangeNoBit) {
  write_text(m_folder / "none.toml",
             "path = [{ function = \"twist\", angle = 0 },\n"
             "{ function = \"cut-open\", normal = [1, 0, 0], gap = 0 },\n"
             "{ function = \"bend\", towards = [0, 1, 0], angle = 40, range = [500, 600] },\n"
             "{ function = \"explode\", grid = [2, 2, 2], gap = 0 }]\n");
  ASSERT_EQ(render(m_folder / "ball.nhdr", "plain.png").exit_code, 0);
  ASSERT_EQ(
      render(m_folder / "ball.nhdr", "none.png", {"--path", m_folder / "none.toml"}).exit_code, 0);
  EXPECT_EQ(image("plain.png").rgba, image("none.png").rgba);
}

TEST_F(UnitOffsetFunctions, OutputsFollowTheFunctionsAndTheStateDoesNot) {
  const std::string output =
      "[output]\nstate = \"a.vdb\"\noffsets = [\"a.nrrd\"]\nvolumes = [\"v.nrrd\"]\n";
  write_text(m_folder / "open.toml", "path = " + m_open + "\n");
  ASSERT_EQ(run_scene(m_step + output).exit_code, 0);
  const std::string state = read_text(m_folder / "out/a.vdb");
  const std::string plain = read_text(m_folder / "out/v.nrrd");
  write_text(m_folder / "scene.toml", "path = " + m_open + "\n" + m_head + m_step + output);
  ASSERT_EQ(
      run_supple({"run", m_folder / "scene.toml", "-o", m_folder / "out", "--force"}).exit_code, 0);
  EXPECT_EQ(read_text(m_folder / "out/a.vdb"), state);
  EXPECT_NE(read_text(m_folder / "out/v.nrrd"), plain);
  // The commands make the same of the state.
  const std::vector<std::string> along = {"--path", m_folder / "open.toml", "-o"};
  ASSERT_EQ(run_supple(
                {"resample", m_folder / "out/a.vdb", along[0], along[1], "-o", m_folder / "v.nrrd"})
                .exit_code,
            0);
  ASSERT_EQ(
      run_supple({"export", m_folder / "out/a.vdb", along[0], along[1], "-o", m_folder / "a.nrrd"})
          .exit_code,
      0);
  EXPECT_EQ(read_text(m_folder / "v.nrrd"), read_text(m_folder / "out/v.nrrd"));
  EXPECT_EQ(read_text(m_folder / "a.nrrd"), read_text(m_folder / "out/a.nrrd"));
}

TEST_F(UnitOffsetFunctions, ASliceOfAnOpenedBodyIsASliceOfTheResampledVolume) {
  write_text(m_folder / "open.toml", "path = " + m_open + "\n");
  ASSERT_EQ(run_supple({"deform", m_folder / "ball.nhdr", "--material", m_folder / "soft.toml",
                        "--grab", "12,12,12", "--by", "2,0,0", "-o", m_folder / "a.vdb"})
                .exit_code,
            0);
  ASSERT_EQ(run_supple({"resample", m_folder / "a.vdb", "--path", m_folder / "open.toml", "-o",
                        m_folder / "v.nrrd"})
                .exit_code,
            0);
  const std::vector<std::string> slice = {"--at", "12,12,12", "--window", "0,255",       "--scale",
                                          "1",    "--plane",  "axial",    "--no-outline"};
  const auto draw = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "slice");
    arguments.insert(arguments.end(), slice.begin(), slice.end());
    const Outcome outcome = run_supple(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  };
  draw({m_folder / "a.vdb", "--path", m_folder / "open.toml", "-o", m_folder / "s.png"});
  draw({m_folder / "v.nrrd", "-o", m_folder / "v.png"});
  draw({m_folder / "a.vdb", "-o", m_folder / "plain.png"});
  EXPECT_LT(compare(image("s.png"), image("v.png"), false).max_diff, 1.5 / 255);
  EXPECT_GT(compare(image("s.png"), image("plain.png"), false).max_diff, 0.2);
}

TEST_F(UnitOffsetFunctions, ALatticeMovesByPointsOfAFileAsByItsIndices) {
  RUN_WHEN_SANITIZED();
  // Control point (1, 1, 1) of 3^3 over the box -0.5 … 23.5 is its centre.
  write_text(m_folder / "points.csv", "x,y,z,dx,dy,dz\n11.4,11.6,17.3,4,-2,3\n");
  write_text(m_folder / "file.toml",
             "path = { function = \"lattice\", lattice = [3, 3, 3], points = \"points.csv\" }\n");
  write_text(m_folder / "inline.toml",
             "path = { function = \"lattice\", lattice = [3, 3, 3], "
             "move = [[1, 1, 1, 4, -2, 3]] }\n");
  for (const std::string name : {"file", "inline"}) {
    const Outcome outcome =
        render(m_folder / "ball.nhdr", name + ".png", {"--path", m_folder / (name + ".toml")});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  ASSERT_EQ(render(m_folder / "ball.nhdr", "plain.png").exit_code, 0);
  EXPECT_EQ(image("file.png").rgba, image("inline.png").rgba);
  EXPECT_NE(image("plain.png").rgba, image("inline.png").rgba);
}

TEST_F(FaultOffsetFunctions, BadFunctionsAreOneLineWithFileLineAndKey) {
  const auto error_of = [&](const std::string& text) {
    write_text(m_folder / "bad.toml", text);
    const Outcome outcome =
        render(m_folder / "ball.nhdr", "bad.png", {"--path", m_folder / "bad.toml"});
    EXPECT_EQ(outcome.exit_code, 3) << text << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_NE(outcome.err.find("bad.toml"), std::string::npos) << outcome.err;
    return outcome.err;
  };
  const auto expect_error = [&](const std::string& text, const std::vector<std::string>& words) {
    const std::string found = error_of(text);
    for (const std::string& word : words) {
      EXPECT_NE(found.find(word), std::string::npos) << word << " in " << found;
    }
  };
  const auto function = [](const std::string& keys) {
    return "path = { function = " + keys + " }\n";
  };
  expect_error("paht = 1\n", {"bad.toml:1", "paht", "'path'"});
  expect_error("path = []\n", {"path"});
  expect_error("path = 3\n", {"path"});
  expect_error(function("\"bendd\""), {"bad.toml:1", "path.function", "bendd", "twist"});
  expect_error("path = [" + m_open + ",\n{ function = \"twist\", angel = 3 }]\n",
               {"bad.toml:2", "path[2].angel", "'angle'"});
  expect_error(function("\"twist\""), {"path.angle"});
  expect_error(function("\"twist\", angle = 9, axis = [0, 0, 0]"), {"bad.toml:1", "path.axis"});
  expect_error(function("\"twist\", angle = 9, range = [3]"), {"path.range"});
  expect_error(function("\"twist\", angle = 9, range = [3, 2]"), {"path.range", "3,2"});
  expect_error(function("\"bend\", angle = 9"), {"path.towards"});
  expect_error(function("\"bend\", angle = 170, towards = [0, 1, 0], range = [0, 1]"),
               {"bad.toml:1", "bend", "longer range"});
  expect_error(function("\"taper\", factor = -1"), {"path.factor", "-1"});
  expect_error(function("\"cut-open\", normal = [1, 0, 0]"), {"gap", "angle"});
  expect_error(function("\"cut-open\", normal = [1, 0, 0], gap = 3, angle = 4"),
               {"gap", "one of both"});
  expect_error(function("\"cut-open\", normal = [1, 0, 0], angle = 4"), {"path.hinge"});
  expect_error(function("\"cut-open\", normal = [1, 0, 0], gap = 4, hinge = [0, 0, 0]"), {"hinge"});
  expect_error(function("\"explode\", gap = 3"), {"path.grid"});
  expect_error(function("\"explode\", grid = [2, 0, 2], gap = 3"), {"path.grid", "0 pieces"});
  expect_error(function("\"explode\", grid = [2, 2, 2], gap = 3, box = [1, 2]"), {"path.box"});
  expect_error(function("\"lattice\", lattice = [3, 3, 3]"), {"path.move"});
  expect_error(function("\"lattice\", lattice = [3, 3, 3], move = [[3, 0, 0, 1, 1, 1]]"),
               {"bad.toml:1", "control point 3,0,0"});
  expect_error(function("\"lattice\", lattice = [3, 3, 3], move = [[1, 1, 1, 0, 99, 0]]"),
               {"path.move", "folds"});
  write_text(m_folder / "far.csv", "x,y,z,dx,dy,dz\n900,0,0,1,1,1\n");
  EXPECT_NE(error_of(function("\"explode\", grid = [9999, 2, 2], gap = 3")).find("9999"),
            std::string::npos);
  write_text(m_folder / "bad.toml",
             function("\"lattice\", lattice = [3, 3, 3], points = \"far.csv\""));
  const Outcome outcome =
      render(m_folder / "ball.nhdr", "bad.png", {"--path", m_folder / "bad.toml"});
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_NE(outcome.err.find("far.csv:2"), std::string::npos) << outcome.err;
}

}  // namespace
