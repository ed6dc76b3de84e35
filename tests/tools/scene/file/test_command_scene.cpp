// Options of a command do what the keys of a scene do, and the other way round.
#include <gtest/gtest.h>

#include "lib/state/state.h"
#include "tests/support/program.h"

using namespace supple;
using namespace supple::test;

namespace {

class CommandScene : public ::testing::Test {
 protected:
  void SetUp() override {
    write_ball(m_folder, "ball", 16);
    write_soft_material(m_folder / "soft.toml");
    write_text(m_folder / "pins.csv", "x,y,z\n8,2,8\n");
    write_text(m_folder / "more.csv", "x,y,z\n8,3,8\n");
    write_text(m_folder / "twist.toml", "[path]\nfunction = \"twist\"\nangle = 30\n");
    write_text(m_folder / "left.toml", "view = \"left\"\n");
  }

  void run_scene(const std::string& rest) {
    write_text(m_folder / "scene.toml", "[volume]\npath = \"ball.nhdr\"\n" + rest);
    const Outcome outcome =
        run_supple({"run", m_folder / "scene.toml", "-o", m_folder / "", "--force"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  void run_command(const std::string& name, std::vector<std::string> more) {
    more.insert(more.begin(), {name, m_folder / "ball.nhdr", "--force"});
    const Outcome outcome = run_supple(more);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  /// One step, as options and as keys: the same state, journal included.
  void expect_same_state(const std::vector<std::string>& options, const std::string& step) {
    std::vector<std::string> more = {"--material", m_folder / "soft.toml", "-o",
                                     m_folder / "command.vdb"};
    more.insert(more.end(), options.begin(), options.end());
    run_command("deform", more);
    run_scene("[material]\ntable = \"soft.toml\"\n[[step]]\n" + step +
              "[output]\nstate = \"scene.vdb\"\n");
    const State command = read_state(m_folder / "command.vdb");
    const State scene = read_state(m_folder / "scene.vdb");
    EXPECT_EQ(command.q, scene.q);
    EXPECT_EQ(command.configuration, scene.configuration);
    EXPECT_EQ(command.anchors, scene.anchors);
  }
  void expect_same_picture(const std::string& command, std::vector<std::string> options,
                           const std::string& keys) {
    options.insert(options.end(), {"-o", m_folder / "command.png"});
    run_command(command, options);
    run_scene("[[view]]\nimage = \"scene.png\"\n" + keys);
    EXPECT_EQ(read_text(m_folder / "command.png"), read_text(m_folder / "scene.png"));
  }

  TemporaryFolder m_folder;
};

using UnitCommandScene = CommandScene;
using FaultCommandScene = CommandScene;

}  // namespace

TEST_F(UnitCommandScene, DeformHasTheStepsOfAScene) {
  expect_same_state(
      {"--grab", "8,12,8:9,13,9", "--by", "0,1,-1", "--grab", "3,8,8", "--by", "-1,0,0", "--fix",
       m_folder / "pins.csv", "--fix", m_folder / "more.csv", "--limits", "tighten"},
      "handles = [{ grab_box = [8, 12, 8, 9, 13, 9], by = [0, 1, -1] },\n"
      "{ grab = [3, 8, 8], by = [-1, 0, 0] }]\n"
      "fix_points = [\"pins.csv\", \"more.csv\"]\nlimits = \"tighten\"\n");
  const std::string plane =
      "{ plane = { corner = [-9, 6.5, -9], edge1 = [60, 0, 0], edge2 = [0, 0, 60] } }";
  expect_same_state({"--grab", "8,13,8", "--by", "0,2,0", "--cut", plane, "--relax", "7",
                     "--relax-method", "red-black", "--bulk-modulus", "5"},
                    "grab = [8, 13, 8]\nby = [0, 2, 0]\ncut = [" + plane +
                        "]\nrelax = { passes = 7, method = \"red-black\", bulk_modulus = 5 }\n");
  const std::string contact = "{ sphere = { centre = [8, 18, 8], radius = 3 }, by = [0, -2, 0] }";
  expect_same_state({"--fix", "0,0,0:15,4,15", "--model", "springs", "--springs-time", "0.02",
                     "--springs-gravity", "0,0,-9.81", "--contact", contact},
                    "fix = [[0, 0, 0, 15, 4, 15]]\nmodel = \"springs\"\nsprings = { time = 0.02, "
                    "gravity = [0, 0, -9.81], contact = " +
                        contact + " }\n");
}

TEST_F(UnitCommandScene, RenderAndSliceHaveTheViewsOfAScene) {
  expect_same_picture(
      "render",
      {"--size", "90,60", "--quality", "draft", "--jitter", "--camera", m_folder / "left.toml",
       "--clip-plane", "8,8,8:0,0,1", "--clip-keep", "outside", "--light",
       "camera:1,1,2:0.8:#FF8040", "--shading", "phong", "--exposure", "-0.5", "--path",
       m_folder / "twist.toml"},
      "size = [90, 60]\nquality = \"draft\"\njitter = true\ncamera = \"left.toml\"\n"
      "clip = [{ plane = { point = [8, 8, 8], normal = [0, 0, 1] }, keep = \"outside\" }]\n"
      "light = [{ direction = [1, 1, 2], frame = \"camera\", intensity = 0.8, colour = \"#FF8040\" "
      "}]\n"
      "shading = \"phong\"\nexposure = -0.5\npath = \"twist.toml\"\n");
  expect_same_picture("slice", {}, "slice = {}\n");
  expect_same_picture("slice", {"--plane", "coronal", "--at", "8,9,8", "--scale", "3"},
                      "slice = { plane = \"coronal\", at = [8, 9, 8], scale = 3 }\n");
}

TEST_F(UnitCommandScene, AVolumeIsSeenThroughAWarpInAScene) {
  run_command("deform", {"--material", m_folder / "soft.toml", "--grab", "8,13,8", "--by", "0,3,0",
                         "-o", m_folder / "a.vdb"});
  ASSERT_EQ(run_supple({"export", m_folder / "a.vdb", "-o", m_folder / "warp.nrrd"}).exit_code, 0);
  run_command("render", {"--size", "80,80", "--offsets", m_folder / "warp.nrrd", "-o",
                         m_folder / "command.png"});
  run_scene("offsets = \"warp.nrrd\"\n[[view]]\nimage = \"scene.png\"\nsize = [80, 80]\n");
  EXPECT_EQ(read_text(m_folder / "command.png"), read_text(m_folder / "scene.png"));
  run_command("render", {"--size", "80,80", "-o", m_folder / "rest.png"});
  EXPECT_NE(read_text(m_folder / "command.png"), read_text(m_folder / "rest.png"));
}

TEST_F(UnitCommandScene, TheOldNameOfAPathIsReadWithAWarning) {
  write_text(m_folder / "old.toml", "[offset]\nfunction = \"twist\"\nangle = 30\n");
  run_command("render",
              {"--size", "60,60", "--path", m_folder / "twist.toml", "-o", m_folder / "new.png"});
  const Outcome old = run_supple({"render", m_folder / "ball.nhdr", "--size", "60,60", "--offset",
                                  m_folder / "old.toml", "-o", m_folder / "old.png"});
  ASSERT_EQ(old.exit_code, 0) << old.err;
  EXPECT_NE(old.err.find("--offset: this option is called --path now"), std::string::npos)
      << old.err;
  EXPECT_NE(old.err.find("old.toml:1: offset: found its former name, expected path"),
            std::string::npos)
      << old.err;
  EXPECT_EQ(read_text(m_folder / "new.png"), read_text(m_folder / "old.png"));
}

TEST_F(UnitCommandScene, NamesOfFilesAreAnyBytes) {
  for (const std::string name : {"a b'c\"d\\e#f", "caf\xe9", "\xef\x9c\x81x", "t\x7f\n{"}) {
    std::filesystem::copy_file(m_folder / "ball.raw", m_folder / (name + ".raw"));
    const Outcome outcome =
        run_supple({"slice", m_folder / (name + ".raw"), "--raw",
                    "dims=16,16,16,type=uint8,spacing=1,1,1", "-o", m_folder / (name + ".png")});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_TRUE(std::filesystem::exists(m_folder / (name + ".png")));
  }
}

TEST_F(UnitCommandScene, AStateAloneIsReadWithTheLabelsOfTheScene) {
  run_command("deform", {"--material", m_folder / "soft.toml", "--grab", "8,13,8", "--by", "0,1,0",
                         "-o", m_folder / "a.vdb"});
  write_text(m_folder / "scene.toml",
             "[volume]\npath = \"a.vdb\"\n[labels]\npath = \"none.nrrd\"\n[[view]]\nimage = "
             "\"x.png\"\n");
  const Outcome outcome = run_supple({"run", m_folder / "scene.toml", "-o", m_folder / ""});
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_NE(outcome.err.find("none.nrrd"), std::string::npos) << outcome.err;
}

TEST_F(FaultCommandScene, ErrorsNameTheOptionOrThePartOfATable) {
  const auto expect = [&](const std::string& command, std::vector<std::string> more, int code,
                          const std::string& words) {
    more.insert(more.begin(), {command, m_folder / "ball.nhdr", "-o",
                               m_folder / (command == "deform" ? "x.vdb" : "x.png")});
    const Outcome outcome = run_supple(more);
    EXPECT_EQ(outcome.exit_code, code) << outcome.err;
    EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
  };
  expect("deform", {"--springs-time", "1"}, 3, "--springs-time: found springs without its model");
  expect("deform", {"--model", "springs", "--springs-time", "0"}, 3,
         "--springs-time: found 0, expected a positive number of s");
  expect("deform", {"--model", "springs", "--contact", "{ sphere = { radius = 1 } }"}, 3,
         "--contact[1].sphere.centre: found nothing");
  expect("deform", {"--model", "springs", "--contact", "{ sphere"}, 2, "--contact");
  expect("deform", {"--cut", "{ plane = {} }"}, 3, "--cut[1].plane.corner: found nothing");
  expect("deform", {"--frame", "-1", "--release"}, 3, "--frame: found -1, expected 0 or more");
  expect("render", {"--size", "9"}, 2, "--size: found '9', expected 2 numbers");
  expect("render", {"--light", "1,2,3:200"}, 3,
         "--light[1].intensity: found 200, expected 0 to 100");
  expect("render", {"--light", ""}, 2, "--light: found ''");
  expect("render", {"--jitter=false"}, 2, "jitter");
  expect("render", {"--clip-box", "1,2:3,4,5,6"}, 2, "--clip-box: found '1,2', expected 3 numbers");
  expect("render", {"--view", "below"}, 2, "--view: found 'below'");
  expect("deform", {"--cut", "{ label = 1 }, { label = 2 }"}, 2, "--cut: found");
  expect("deform", {"--cut", "{ label = 1 }]\nlimits = \"ball\"\nfix = [[1, 1, 1]"}, 2,
         "--cut: found");
  expect("deform", {"--relax", "5", "--relax-volume", "5", "--bulk-modulus", "6"}, 2,
         "--bulk-modulus");
  expect("deform", {"--relax", "1000001"}, 3, "--relax: found 1000001, expected 1 to 1000000");
  expect("deform", {"--model", "springs", "--relax", "5"}, 3,
         "--relax: found relax beside springs");
  expect("deform", {"--limits", "box"}, 3, "deform: found a step that does nothing");
  EXPECT_EQ(run_supple({"deform", m_folder / "ball.nhdr", "--release", "-o", ""}).exit_code, 2);
  write_text(m_folder / "self.toml", "path = \"self.toml\"\n");
  expect("render", {"--path", m_folder / "self.toml"}, 3, "self.toml:1: path");
  EXPECT_FALSE(std::filesystem::exists(m_folder / "x.vdb"));
}
