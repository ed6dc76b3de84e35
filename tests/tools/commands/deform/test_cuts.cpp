// Cuts as scenes and the command line ask for them.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"
#include "tests/support/sanitized.h"

using namespace supple::test;

namespace {

/// A ball of 16 voxels in diameter at most, in millimetres 1 x 1 x 1.5, whose index j runs to
/// anterior: voxel (i, j, k) lies at (i, 15 - j, 1.5 k).
class UnitCutting : public ::testing::Test {
 protected:
  void SetUp() override {
    write_ball(m_folder, "ball", 16);
    write_text(m_folder / "flipped.nhdr",
               "NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\n"
               "sizes: 16 16 16\nspace directions: (1,0,0) (0,-1,0) (0,0,1.5)\n"
               "space origin: (0,15,0)\nencoding: raw\ndata file: ball.raw\n");
    write_soft_material(m_folder / "soft.toml");
    // The plane between j = 8 and j = 9, y = 6.5 mm, as two triangles.
    write_text(m_folder / "knife.obj",
               "v -9 6.5 -9\nv 40 6.5 -9\nv 40 6.5 60\nv -9 6.5 60\nf 1 2 3 4\n");
    write_text(m_folder / "far.obj", "v 90 0 0\nv 91 0 0\nv 90 1 0\nf 1 2 3\n");
  }

  Outcome run_scene(const std::string& steps, const std::string& name) {
    write_text(m_folder / "scene.toml",
               "[volume]\npath = \"flipped.nhdr\"\n[material]\ntable = \"soft.toml\"\n" + steps +
                   "[output]\nvolumes = [\"" + name + ".nrrd\"]\nstate = \"" + name + ".vdb\"\n");
    return run_supple({"run", m_folder / "scene.toml", "-o", m_folder / "out", "--json"});
  }
  void expect_refused(const std::string& cut, const std::vector<std::string>& words) {
    const Outcome outcome = run_scene("[[step]]\ncut = [" + cut + "]\n", "refused");
    EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
    for (const std::string& word : words) {
      EXPECT_NE(outcome.err.find(word), std::string::npos) << word << " in " << outcome.err;
    }
  }
  Outcome deform(const std::string& input, const std::string& output,
                 std::vector<std::string> more) {
    const std::vector<std::string> head = {"deform", m_folder / input, "--json", "-o",
                                           m_folder / output};
    more.insert(more.begin(), head.begin(), head.end());
    return run_supple(more);
  }
  static nlohmann::json parse(const Outcome& outcome) {
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return nlohmann::json::parse(outcome.out, nullptr, false);
  }

  TemporaryFolder m_folder;
};

}  // namespace

TEST_F(UnitCutting, AMeshInMillimetresAndAPlaneInEitherFrameCutTheSame) {
  const auto steps = [](const std::string& cut) {
    return "[[step]]\ncut = [{ " + cut + " }]\n[[step]]\ngrab = [8, 11, 8]\nby = [0.0, 3.0, 0.0]\n";
  };
  const auto mesh = parse(run_scene(steps("mesh = \"knife.obj\""), "mesh"));
  const auto lps = parse(run_scene(
      steps("plane = { corner = [-9, 6.5, -9], edge1 = [60, 0, 0], edge2 = [0, 0, 60] }"), "lps"));
  const auto voxels =
      parse(run_scene(steps("plane = { corner = [-9, 8.5, -9], edge1 = [60, 0, 0], edge2 = [0, 0, "
                            "60], frame = \"voxel\" }"),
                      "voxels"));
  EXPECT_GT(mesh["steps"][0]["cut_links"], 50);
  EXPECT_EQ(mesh["steps"][0]["moved"], 0);
  EXPECT_EQ(mesh["steps"][1]["cut_links"], 0);
  EXPECT_GT(mesh["steps"][1]["moved"], 100);
  EXPECT_EQ(mesh["steps"][0]["cut_links"], lps["steps"][0]["cut_links"]);
  EXPECT_EQ(mesh["steps"][0]["cut_links"], voxels["steps"][0]["cut_links"]);
  const std::string expected = read_text(m_folder / "out/mesh.nrrd");
  EXPECT_EQ(read_text(m_folder / "out/lps.nrrd"), expected);
  EXPECT_EQ(read_text(m_folder / "out/voxels.nrrd"), expected);
  const auto info = parse(run_supple({"info", "--json", m_folder / "out/voxels.vdb"}));
  EXPECT_EQ(info["cut_links"], mesh["steps"][0]["cut_links"]);
  const auto& step = info["configuration"]["steps"][0];
  EXPECT_EQ(step["cut_links"], info["cut_links"]);
  EXPECT_EQ(step["cut"][0]["plane"]["corner"], nlohmann::json({-9, 8.5, -9}));
  EXPECT_EQ(step["cut"][0]["plane"]["frame"], "voxel");
}

TEST_F(UnitCutting, ADrawnCurveCutsAsThePlaneThatItSweeps) {
  const auto cut_and_move = [&](const std::string& cut, const std::string& name) {
    return parse(run_scene(
        "[[step]]\ncut = [{ " + cut + " }]\n[[step]]\ngrab = [8, 11, 8]\nby = [0.0, 3.0, 0.0]\n",
        name));
  };
  write_text(m_folder / "drawn.mrk.json",
             R"({"markups": [{"type": "Curve", "coordinateSystem": "LPS", "controlPoints": [
                {"position": [-9, 6.5, 2]}, {"position": [20, 6.5, 2]},
                {"position": [40, 6.5, 2]}]}]})");
  const std::string rest = ", direction = [0, 0, 2], depth = 58, above = 11 }";
  const auto plane = cut_and_move(
      "plane = { corner = [-9, 6.5, -9], edge1 = [49, 0, 0], edge2 = [0, 0, 69] }", "plane");
  const auto points = cut_and_move(
      "curve = { points = [[-9, 6.5, 2], [20, 6.5, 2], [40, 6.5, 2]]" + rest, "points");
  const auto file = cut_and_move("curve = { points = \"drawn.mrk.json\"" + rest, "file");
  const auto voxels = cut_and_move(
      "curve = { points = [[-9, 8.5, 2], [40, 8.5, 2]], direction = [0, 0, 2], depth = 58, above = "
      "11, frame = \"voxel\" }",
      "voxels");
  EXPECT_GT(plane["steps"][0]["cut_links"], 50);
  const std::string expected = read_text(m_folder / "out/plane.nrrd");
  for (const auto& [json, name] :
       {std::pair(points, "points"), std::pair(file, "file"), std::pair(voxels, "voxels")}) {
    EXPECT_EQ(json["steps"][0]["cut_links"], plane["steps"][0]["cut_links"]) << name;
    EXPECT_EQ(read_text(m_folder / ("out/" + std::string(name) + ".nrrd")), expected) << name;
  }
  const auto info = parse(run_supple({"info", "--json", m_folder / "out/file.vdb"}));
  const auto& curve = info["configuration"]["steps"][0]["cut"][0]["curve"];
  EXPECT_EQ(curve["file"], "drawn.mrk.json");
  EXPECT_EQ(curve["points"][1], nlohmann::json({20, 6.5, 2}));
  EXPECT_EQ(curve["depth_mm"], 58);
}

TEST_F(UnitCutting, AContinuedStateIsStillCut) {
  RUN_WHEN_SANITIZED();
  const std::vector<std::string> soft = {"--material", m_folder / "soft.toml"};
  const auto cut =
      parse(deform("flipped.nhdr", "cut.vdb", {soft[0], soft[1], "--cut", m_folder / "knife.obj"}));
  EXPECT_EQ(cut["moved"], 0);
  EXPECT_EQ(cut["fold_free_material"], false);
  EXPECT_GT(cut["cut_links"], 50);
  // The handle would move the whole ball; now the half beyond the cut stays.
  const std::vector<std::string> drag = {"--grab", "8,11,8", "--by", "0,90,0"};
  const auto stopped = parse(deform("cut.vdb", "half.vdb", drag));
  auto with_material = drag;
  with_material.insert(with_material.end(), soft.begin(), soft.end());
  const auto whole = parse(deform("flipped.nhdr", "whole.vdb", with_material));
  EXPECT_EQ(whole["moved"], whole["elements"]);
  EXPECT_GT(stopped["moved"], 100);
  EXPECT_LT(stopped["moved"], whole["moved"]);
  const auto again = parse(deform("half.vdb", "again.vdb", {"--cut", m_folder / "knife.obj"}));
  EXPECT_EQ(again["cut_links"], 0);
  EXPECT_EQ(parse(run_supple({"info", "--json", m_folder / "again.vdb"}))["cut_links"],
            cut["cut_links"]);
}

TEST_F(UnitCutting, ASequenceShowsTheGapInEveryPicture) {
  // Rigid halves: halfway through a drag is where a drag of half the length ends.
  write_text(m_folder / "rigid.toml",
             "domain = [0, 255]\nactive = [100, 255]\nmax_length = [[0, 1.0]]\n"
             "min_length = [[0, 1.0]]\nshear = [[0, 0.0]]\n");
  const std::string plane =
      "{ plane = { corner = [-9, 6.5, -9], edge1 = [60, 0, 0], edge2 = [0, 0, 60] } }";
  for (const auto& [by, state] : {std::pair("0,8,0", "open.vdb"), std::pair("0,4,0", "half.vdb")}) {
    EXPECT_EQ(deform("flipped.nhdr", state,
                     {"--material", m_folder / "rigid.toml", "--cut", plane, "--grab", "8,11,8",
                      "--by", by})
                  .exit_code,
              0);
  }
  const auto render = [&](const std::string& state, const std::string& picture,
                          std::vector<std::string> more) {
    more.insert(more.begin(), {"render", m_folder / state, "-o", m_folder / picture, "--size",
                               "96,96", "--view", "left", "--preset", "MR-Default"});
    EXPECT_EQ(run_supple(more).exit_code, 0);
  };
  render("open.vdb", "s_%d.png", {"--sequence", "3"});
  render("half.vdb", "half.png", {});
  const auto compare = [&](const std::string& picture) {
    return run_supple({"compare", m_folder / picture, m_folder / "half.png", "--max-rmse", "0.001"})
        .exit_code;
  };
  EXPECT_EQ(compare("s_1.png"), 0);
  EXPECT_EQ(compare("s_0.png"), 1) << "the gap is to be seen";
}

TEST_F(UnitCutting, ACutThatCrossesNoLinkWarns) {
  const Outcome outcome = deform("flipped.nhdr", "a.vdb",
                                 {"--cut", m_folder / "far.obj", "--cut", m_folder / "knife.obj"});
  EXPECT_GT(parse(outcome)["cut_links"], 50);
  EXPECT_NE(outcome.err.find("far.obj: the cut crosses no link"), std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.err.find("knife.obj: the cut crosses no link"), std::string::npos);
}

TEST_F(UnitCutting, UnusableCutsAreRefusedWithTheirPlace) {
  const std::string plane = "plane = { corner = [0, 0, 0], edge1 = [1, 0, 0], edge2 = ";
  expect_refused("{ mesh = \"none.stl\" }", {"none.stl", "no such file"});
  expect_refused("{ mesh = \"soft.toml\" }",
                 {"soft.toml", "extension", ".stl, .ply, .obj or .vtk"});
  expect_refused("{ mesh = \"knife.obj\", " + plane + "[0, 1, 0] } }", {"scene.toml:6", "either"});
  expect_refused("{ }", {"scene.toml:6", "either mesh, plane, curve or label"});
  const std::string curve = "{ curve = { points = ", two = "[[0, 0, 0], [9, 0, 0]]";
  expect_refused(curve + two + ", direction = [0, 0, 1] } }", {"scene.toml:6", "depth"});
  expect_refused(curve + two + ", direction = [0, 0, 0], depth = 3 } }",
                 {"scene.toml:6", "direction", "found [0, 0, 0]"});
  expect_refused(curve + two + ", direction = [1, 0, 0], depth = 3 } }",
                 {"scene.toml:6", "direction", "one across it"});
  expect_refused(curve + "[[0, 0, 0]], direction = [0, 0, 1], depth = 3 } }",
                 {"scene.toml:6", "points", "two points"});
  expect_refused("{ label = 3 }", {"scene.toml:6", "label"});
  expect_refused("{ " + plane + "[2, 0, 0] } }", {"scene.toml:6", "edge2", "span no area"});
  expect_refused("{ " + plane + "[0, 1, 0], frame = \"ras\" } }", {"frame", "lps or voxel"});
  expect_refused("{ " + plane + "[0, 1e9, 0] } }", {"scene.toml:6", "cut surface", "131071"});
  expect_refused("{ " + plane + "[0, 1, 0], egde3 = 1 } }", {"egde3"});
  const Outcome outcome =
      run_supple({"deform", m_folder / "flipped.nhdr", "--cut", m_folder / "knife.obj", "-o",
                  m_folder / "knife.obj", "--force"});
  EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
}
