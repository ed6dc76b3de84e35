// Handles on the command line and in scenes: boxes, point files, pushing.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"
#include "tests/support/sanitized.h"

using namespace supple::test;

namespace {

/// A ball of 16^3 voxels of 1 x 1 x 1.5 mm at the origin, so that LPS mm are i, j, 1.5 k.
class UnitHandles : public ::testing::Test {
 protected:
  void SetUp() override {
    write_ball(m_folder, "ball", 16);
    write_soft_material(m_folder / "soft.toml");
  }

  Outcome deform(const std::string& output, const std::vector<std::string>& options) {
    std::vector<std::string> arguments = {"deform",     m_folder / "ball.nhdr",
                                          "--material", m_folder / "soft.toml",
                                          "-o",         m_folder / output};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return run_supple(arguments);
  }

  /// The deformed volume of a state, for comparison byte by byte.
  std::string resampled(const std::string& state) {
    const Outcome outcome =
        run_supple({"resample", m_folder / state, "-o", m_folder / (state + ".mha"), "--force"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return read_text(m_folder / (state + ".mha"));
  }

  Outcome run_scene(const std::string& steps) {
    write_text(m_folder / "scene.toml",
               "[volume]\npath = \"ball.nhdr\"\n[material]\ntable = \"soft.toml\"\n" + steps +
                   "[output]\nstate = \"scene.vdb\"\n");
    return run_supple({"run", m_folder / "scene.toml", "-o", m_folder.path(), "--force", "--json"});
  }

  void expect_refused(const Outcome& outcome, int code, const std::vector<std::string>& words) {
    EXPECT_EQ(outcome.exit_code, code) << outcome.err;
    for (const std::string& word : words) {
      EXPECT_NE(outcome.err.find(word), std::string::npos) << word << " in " << outcome.err;
    }
  }

  TemporaryFolder m_folder;
};

}  // namespace

TEST_F(UnitHandles, ABoxIsOneHandleAndPointsOfItsVoxelsAreTheSame) {
  ASSERT_EQ(deform("box.vdb", {"--grab", "7,8,8:8,8,9", "--by", "2,1,0"}).exit_code, 0);
  write_text(m_folder / "points.csv",
             "x,y,z,label\n7,8,12,a\n8.2,7.9,12,b\n7,8,13.5,c\n8,8,13.5,d\n7,8,12,again\n");
  const Outcome points = deform("points.vdb", {"--grab", m_folder / "points.csv", "--by", "2,1,0"});
  ASSERT_EQ(points.exit_code, 0) << points.err;
  EXPECT_EQ(resampled("points.vdb"), resampled("box.vdb"));
  ASSERT_EQ(deform("voxel.vdb", {"--grab", "7,8,8", "--by", "2,1,0"}).exit_code, 0);
  EXPECT_NE(resampled("voxel.vdb"), resampled("box.vdb"));
}

TEST_F(UnitHandles, PointsWithDisplacementsAreHandlesOfTheirOwnAndTakeNoBy) {
  write_text(m_folder / "moves.csv", "x,y,z,dx,dy,dz\n7,8,12,2,0,0\n9,8,12,2.2,0.2,0\n");
  ASSERT_EQ(deform("moves.vdb", {"--grab", m_folder / "moves.csv"}).exit_code, 0);
  ASSERT_EQ(deform("pairs.vdb",
                   {"--grab", "7,8,8", "--by", "2,0,0", "--grab", "9,8,8", "--by", "2.2,0.2,0"})
                .exit_code,
            0);
  EXPECT_EQ(resampled("moves.vdb"), resampled("pairs.vdb"));
  // The pairs go on in order beside others.
  ASSERT_EQ(deform("mixed.vdb", {"--grab", "8,5,8", "--grab", m_folder / "moves.csv", "--grab",
                                 "8,11,8", "--by", "2,0,0", "--by", "2,0,0"})
                .exit_code,
            0);
  expect_refused(deform("x.vdb", {"--grab", m_folder / "moves.csv", "--by", "1,0,0"}), 2,
                 {"--by", "dx,dy,dz"});
}

TEST_F(UnitHandles, PointsGoToThoseOfAnotherFilePairByPair) {
  write_text(m_folder / "moves.csv", "x,y,z,dx,dy,dz\n5,8,12,2,0,0\n10,8,12,1.5,0.25,0\n");
  write_text(m_folder / "from.csv", "x,y,z\n5,8,12\n10,8,12\n");
  write_text(m_folder / "to.csv", "x,y,z\n7,8,12\n11.5,8.25,12\n");
  const std::vector<std::string> grab = {"--grab", m_folder / "from.csv", "--to",
                                         m_folder / "to.csv"};
  ASSERT_EQ(deform("moves.vdb", {"--grab", m_folder / "moves.csv"}).exit_code, 0);
  ASSERT_EQ(deform("pairs.vdb", grab).exit_code, 0);
  EXPECT_EQ(resampled("pairs.vdb"), resampled("moves.vdb"));
  // Around each a ball, as one of its own.
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), grab.begin(), grab.end());
    return more;
  };
  ASSERT_EQ(deform("balls.vdb", with({"--radius", "1.2"})).exit_code, 0);
  ASSERT_EQ(deform("balls_by.vdb", {"--grab", "ball:5,8,8:1.2", "--by", "2,0,0", "--grab",
                                    "ball:10,8,8:1.2", "--by", "1.5,0.25,0"})
                .exit_code,
            0);
  EXPECT_EQ(resampled("balls.vdb"), resampled("balls_by.vdb"));
  EXPECT_NE(resampled("balls.vdb"), resampled("pairs.vdb"));

  write_text(m_folder / "one.csv", "x,y,z\n7,8,12\n");
  expect_refused(deform("x.vdb", {"--grab", m_folder / "from.csv", "--to", m_folder / "one.csv"}),
                 3, {"one.csv: points: found 1, expected 2 as in "});
  expect_refused(deform("x.vdb", {"--grab", "8,8,8", "--by", "1,0,0", "--to", m_folder / "to.csv"}),
                 2, {"--to: found 1 of them"});
  expect_refused(deform("x.vdb", {"--grab", "8,8,8", "--by", "1,0,0", "--radius", "2"}), 2,
                 {"--radius: found no --grab FILE"});
  const std::string step = "[[step]]\npoints = \"from.csv\"\nradius = 2.0\nby = [1.0, 0.0, 0.0]\n";
  expect_refused(run_scene(step), 3, {"step[1].radius", "go as one"});
  expect_refused(run_scene("[[step]]\ngrab = [8, 8, 8]\nto = \"to.csv\"\n"), 3,
                 {"step[1].to", "without points"});
}

TEST_F(UnitHandles, OneCommandLeadsFromAVolumeToAWarpAndAMovedVolume) {
  const std::vector<std::string> drag = {"--grab", "8,8,8", "--by", "1,0.5,0"};
  ASSERT_EQ(deform("state.vdb", drag).exit_code, 0);
  std::vector<std::string> both = drag;
  both.insert(both.end(), {"--moved", m_folder / "moved.mha"});
  ASSERT_EQ(deform("warp.nrrd", both).exit_code, 0);
  ASSERT_EQ(run_supple({"export", m_folder / "state.vdb", "-o", m_folder / "same.nrrd"}).exit_code,
            0);
  EXPECT_EQ(read_text(m_folder / "warp.nrrd"), read_text(m_folder / "same.nrrd"));
  EXPECT_EQ(read_text(m_folder / "moved.mha"), resampled("state.vdb"));
  expect_refused(deform("warp.txt", drag), 3, {"warp.txt", ".nrrd", ".vdb"});
}

TEST_F(UnitHandles, FixedPointsHoldWhatAFixedVoxelHolds) {
  RUN_WHEN_SANITIZED();
  write_text(m_folder / "pins.csv", "x,y,z\n5,8,12\n5,9,12\n");
  const std::vector<std::string> grab = {"--grab", "8,8,8", "--by", "30,0,0", "--json", "--fix"};
  auto with = [&](std::vector<std::string> fixes) {
    fixes.insert(fixes.begin(), grab.begin(), grab.end());
    return fixes;
  };
  const Outcome points = deform("points.vdb", with({m_folder / "pins.csv"}));
  const Outcome box = deform("box.vdb", with({"5,8,8:5,9,8"}));
  ASSERT_EQ(points.exit_code, 0) << points.err;
  const auto part = [](const Outcome& outcome) {
    return nlohmann::json::parse(outcome.out)["fraction_exact"];
  };
  EXPECT_EQ(part(points), part(box));
  EXPECT_NE(part(points), "1/1");
}

TEST_F(UnitHandles, PointFilesThatDoNotFitTheBodyAreNamedWithTheirLine) {
  write_text(m_folder / "void.csv", "x,y,z\n8,8,12\n0,0,0\n");
  expect_refused(deform("x.vdb", {"--grab", m_folder / "void.csv", "--by", "1,0,0"}), 3,
                 {"void.csv:3", "x,y,z", "nearest", "mm away"});
  expect_refused(deform("x.vdb", {"--fix", m_folder / "void.csv"}), 3, {"void.csv:3", "nearest"});
  write_text(m_folder / "outside.csv", "x,y,z\n8,1e300,12\n");
  expect_refused(deform("x.vdb", {"--grab", m_folder / "outside.csv", "--by", "1,0,0"}), 3,
                 {"outside.csv:2", "inside the volume"});
  write_text(m_folder / "twice.csv", "x,y,z,dx,dy,dz\n8,8,12,1,0,0\n8.1,8,12,1,0,0\n");
  expect_refused(deform("x.vdb", {"--grab", m_folder / "twice.csv"}), 3,
                 {"twice.csv:2", "twice.csv:3", "8,8,8"});
}

TEST_F(UnitHandles, ScenesTakeBoxesPointsAndPushingHandles) {
  write_text(m_folder / "pins.csv", "x,y,z\n4,8,12\n");
  write_text(m_folder / "moves.csv", "x,y,z,dx,dy,dz\n7,8,12,2,0,0\n9,8,12,2.2,0.2,0\n");
  const Outcome scene = run_scene(
      "[[step]]\ngrab_box = [7, 8, 8, 8, 8, 9]\nby = [1.0, 0.0, 0.0]\nfix_points = \"pins.csv\"\n"
      "[[step]]\nhandles = [{ points = \"moves.csv\", push = true }]\nrelease = true\n"
      "[[step]]\npoints = \"pins.csv\"\nby_mm_lps = [0.0, 0.5, 0.0]\n");
  ASSERT_EQ(scene.exit_code, 0) << scene.err;
  EXPECT_EQ(nlohmann::json::parse(scene.out)["steps"].size(), 3u);
}

TEST_F(UnitHandles, ScenesRefuseHandlesThatAreNotOneThing) {
  write_text(m_folder / "pins.csv", "x,y,z\n4,8,12\n");
  write_text(m_folder / "moves.csv", "x,y,z,dx,dy,dz\n7,8,12,2,0,0\n");
  const std::string by = "by = [1.0, 0.0, 0.0]\n";
  expect_refused(run_scene("[[step]]\ngrab = [8, 8, 8]\ngrab_box = [7, 8, 8, 8, 8, 9]\n" + by), 3,
                 {"scene.toml:7", "grab_box"});
  expect_refused(run_scene("[[step]]\ngrab = [8, 8, 8]\npoints = \"pins.csv\"\n" + by), 3,
                 {"scene.toml:6", "points"});
  expect_refused(run_scene("[[step]]\ngrab_box = [7, 8, 8]\n" + by), 3, {"scene.toml:6", "six"});
  expect_refused(run_scene("[[step]]\npoints = \"pins.csv\"\n"), 3, {"by"});
  expect_refused(run_scene("[[step]]\npoints = \"moves.csv\"\n" + by), 3,
                 {"scene.toml:7", "displacement"});
  expect_refused(run_scene("[[step]]\npoints = \"none.csv\"\n" + by), 3, {"none.csv"});
}

TEST_F(UnitHandles, ToolsThatWithdrawLeaveTheTissueAndHeldHandlesTakeItBack) {
  RUN_WHEN_SANITIZED();
  const auto moved_back = [&](const std::string& push) {
    const Outcome outcome = run_scene("[[step]]\ngrab = [8, 8, 8]\nby = [3.0, 0.0, 0.0]\n" + push +
                                      "[[step]]\ngrab = [8, 8, 8]\nby = [-3.0, 0.0, 0.0]\n" + push);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return nlohmann::json::parse(outcome.out)["steps"][1]["moved"].get<int>();
  };
  EXPECT_EQ(moved_back("push = true\n"), 0);
  EXPECT_GT(moved_back(""), 0);
}

TEST_F(UnitHandles, APushOnTheCommandLineLeavesWhatAHandleWouldTakeAlong) {
  // Pushed apart by 3 and 1, the inner one is taken further by its neighbour; held, it would not
  // be.
  const std::vector<std::string> handles = {"--grab", "8,8,8", "--by", "1,0,0",
                                            "--grab", "9,8,8", "--by", "8,0,0"};
  expect_refused(deform("x.vdb", handles), 3, {"9,8,8", "8,8,8", "mm"});
  auto pushing = handles;
  pushing.push_back("--push");
  EXPECT_EQ(deform("push.vdb", pushing).exit_code, 0);
}

TEST_F(UnitHandles, TextsOfTheCommandLineAreTheTablesOfAScene) {
  const auto expect_same = [&](const std::vector<std::string>& options, const std::string& step) {
    const Outcome command = deform("command.vdb", options);
    ASSERT_EQ(command.exit_code, 0) << command.err;
    const Outcome scene = run_scene("[[step]]\n" + step);
    ASSERT_EQ(scene.exit_code, 0) << scene.err;
    EXPECT_EQ(resampled("command.vdb"), resampled("scene.vdb")) << step;
  };
  const std::vector<std::string> by = {"--by", "1.5,0,0", "--force", "--grab"};
  const auto grab = [&](const std::string& text) {
    std::vector<std::string> options = by;
    options.push_back(text);
    return options;
  };
  expect_same(grab("ball:8,8,8:2"), "grab_ball = [8, 8, 8]\nradius = 2\nby = [1.5, 0, 0]\n");
  expect_same(grab("density:150:200"), "grab_density = [150, 200]\nby = [1.5, 0, 0]\n");
  expect_same(grab("piece:8,8,8"), "piece_at = [8, 8, 8]\nby = [1.5, 0, 0]\n");
  expect_same(grab("lps:8.2,7.9,12"), "grab = [8, 8, 8]\nby = [1.5, 0, 0]\n");
  // Directions are of the frame of the place.
  expect_same(grab("ball:ras:-8,-8,12:2"),
              "grab_ball = [8, 8, 8]\nradius = 2\nby = [-1.5, 0, 0]\n");
  expect_same({"--force", "--grab", "{grab = [8, 8, 8], soft = 4, rotate = 20, axis = [0, 0, 1]}"},
              "handles = [{ grab = [8, 8, 8], soft = 4, rotate = 20, axis = [0, 0, 1] }]\n");
  expect_same({"--force", "--grab", "8,8,8", "--by", "2,0,0", "--fix",
               "{grab_box = [4, 0, 0, 5, 15, 15], grab_density = [1, 255]}"},
              "grab = [8, 8, 8]\nby = [2, 0, 0]\nfix = [[4, 0, 0, 5, 15, 15]]\n");
}

TEST_F(UnitHandles, AFrameHoldsForPlacesAndDirections) {
  ASSERT_EQ(run_scene("[[step]]\ngrab_box = [7, 8, 8, 8, 9, 8]\nabout = [8, 8, 8]\nrotate = 9\n"
                      "axis = [0, 0, 2]\nby = [1, 0.5, 0]\n")
                .exit_code,
            0);
  const std::string voxels = resampled("scene.vdb");
  const Outcome ras = run_scene(
      "[[step]]\nframe = \"ras\"\ngrab_box = [-7, -8, 12, -8, -9, 12]\nabout = [-8, -8, 12]\n"
      "rotate = 9\naxis = [0, 0, 1]\nby = [-1, -0.5, 0]\n");
  ASSERT_EQ(ras.exit_code, 0) << ras.err;
  EXPECT_EQ(resampled("scene.vdb"), voxels);
}

TEST_F(UnitHandles, HandlesThatSayTooLittleOrTooMuchAreNamedByKey) {
  const auto refused = [&](const std::string& keys, const std::vector<std::string>& words) {
    expect_refused(run_scene("[[step]]\n" + keys), 3, words);
  };
  const std::string by = "by = [1.0, 0.0, 0.0]\n";
  refused("grab_ball = [8, 8, 8]\n" + by, {"radius"});
  refused("grab = [8, 8, 8]\nradius = 3\n" + by, {"radius", "grab_ball"});
  refused("grab = [8, 8, 8]\ngrab_ball = [8, 8, 8]\nradius = 3\n" + by, {"grab", "several"});
  refused("grab_density = [200, 100]\n" + by, {"grab_density", "LEAST"});
  refused("grab = [8, 8, 8]\nrotate = 10\n", {"axis"});
  refused("grab = [8, 8, 8]\nrotate = 10\naxis = [0, 0, 0]\n", {"axis", "direction"});
  refused("grab = [8, 8, 8]\nrotate = 200\naxis = [0, 0, 1]\n", {"rotate", "180"});
  refused("grab = [8, 8, 8]\nscale = 1.1\nscale_axes = [1, 1, 1]\n", {"scale", "one of both"});
  refused("grab = [8, 8, 8]\nscale = 0\n", {"scale", "positive"});
  refused("grab = [8, 8, 8]\nabout = [8, 8, 8]\n" + by, {"about", "rotate"});
  refused("grab_density = [1, 255]\nsoft = 3\n" + by, {"soft", "edge"});
  refused("grab_density = [230, 255]\n" + by, {"density:230:255", "no element", "1 to 255"});
  refused("piece_at = [0, 0, 0]\n" + by, {"piece:0,0,0", "void", "nearest"});
  refused("piece_at = [99, 0, 0]\n" + by, {"piece_at", "inside the volume"});
  refused("anchors = [{ points = \"none.csv\" }]\n", {"none.csv"});
  expect_refused(deform("x.vdb", {"--grab", "ball:8,8,8", "--by", "1,0,0"}), 2, {"--grab", "8"});
  expect_refused(deform("x.vdb", {"--grab", "density:1", "--by", "1,0,0"}), 2,
                 {"--grab", "density:LEAST:LARGEST"});
  expect_refused(deform("x.vdb", {"--grab", "lps:8,8", "--by", "1,0,0"}), 2, {"--grab", "8,8"});
}

TEST_F(UnitHandles, ATurnTooFarForTheLinksNamesThePairInsideTheHandle) {
  expect_refused(run_scene("[[step]]\ngrab_box = [6, 6, 8, 9, 9, 8]\nrotate = 60\n"
                           "axis = [0, 0, 1]\n"),
                 3, {"grab 6,6,8:9,9,8", "mm further apart", "inside the handle"});
}
