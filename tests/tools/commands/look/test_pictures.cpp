// Looks of pictures on the command line and in scenes: transfer functions as files, clips.
#include <gtest/gtest.h>

#include "raycast/pictures/compare.h"
#include "tests/support/program.h"
#include "tests/support/sanitized.h"

using namespace supple;
using namespace supple::test;

namespace {

class UnitPictures : public testing::Test {
 protected:
  UnitPictures() { write_ball(m_folder, "ball", 24); }

  Outcome render(const std::string& image, std::vector<std::string> more) {
    std::vector<std::string> arguments = {"render", m_folder / "ball.nhdr", "--size", "64,64",
                                          "-o",     m_folder / image,       "--force"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_supple(arguments);
  }

  const TemporaryFolder m_folder;
};

TEST_F(UnitPictures, APrintedPresetGivesThePictureOfThePreset) {
  const Outcome list = run_supple({"presets"});
  ASSERT_EQ(list.exit_code, 0);
  std::istringstream names(list.out);
  int count = 0;
  for (std::string name; std::getline(names, name); ++count) {
    const Outcome printed = run_supple({"presets", name});
    ASSERT_EQ(printed.exit_code, 0) << name;
    write_text(m_folder / "look.toml", printed.out);
    ASSERT_EQ(render("preset.png", {"--preset", name}).exit_code, 0);
    const Outcome outcome = render("file.png", {"--preset", m_folder / "look.toml"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(read_png(m_folder / "preset.png").rgba, read_png(m_folder / "file.png").rgba) << name;
  }
  EXPECT_EQ(count, 29);
}

TEST_F(UnitPictures, ABadTransferFunctionNamesFileLineAndKey) {
  const auto error_of = [&](const std::string& text) {
    write_text(m_folder / "look.toml", text);
    const Outcome outcome = render("a.png", {"--preset", m_folder / "look.toml"});
    EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
    return outcome.err;
  };
  const std::string good = "opacity = [[0, 0], [9, 1]]\ncolour = [[0, 1, 1, 1]]\n";
  EXPECT_NE(error_of(good + "opacty = 1\n").find("look.toml:3"), std::string::npos);
  EXPECT_NE(error_of(good + "blend = \"mip\"\n").find("\"maximum\""), std::string::npos);
  EXPECT_NE(error_of("colour = [[0, 1, 1, 1]]\n").find("opacity"), std::string::npos);
  EXPECT_NE(error_of(good + "unit_distance = 0\n").find("unit_distance"), std::string::npos);
  EXPECT_NE(error_of("opacity = [[0, 2]]\ncolour = [[0, 1, 1, 1]]\n").find("opacity[0]"),
            std::string::npos);
  EXPECT_EQ(run_supple({"presets", "CT-Wood"}).exit_code, 2);
}

TEST_F(UnitPictures, AClipInASceneIsTheClipOfTheCommandLine) {
  write_text(m_folder / "scene.toml",
             "[volume]\npath = \"ball.nhdr\"\n"
             "[[view]]\nimage = \"scene.png\"\nsize = [64, 64]\n"
             "[[view.clip]]\nbox = [0, 0, 0, 12, 12, 40]\nkeep = \"outside\"\n");
  const Outcome scene =
      run_supple({"run", m_folder / "scene.toml", "-o", m_folder / "", "--force"});
  ASSERT_EQ(scene.exit_code, 0) << scene.err;
  ASSERT_EQ(render("whole.png", {}).exit_code, 0);
  ASSERT_EQ(render("a.png", {"--clip-box", "0,0,0:12,12,40", "--clip-keep", "outside"}).exit_code,
            0);
  ASSERT_EQ(render("b.png", {"--clip-plane", "12,0,0:1,0,0"}).exit_code, 0);
  const Image whole = read_png(m_folder / "whole.png"), clipped = read_png(m_folder / "a.png");
  EXPECT_LT(compare(whole, clipped, true).ssim, 0.95);
  EXPECT_LT(compare(whole, read_png(m_folder / "b.png"), true).ssim, 0.95);
  EXPECT_GT(compare(read_png(m_folder / "scene.png"), clipped, true).ssim, 0.98);
}

/// A slice of the state is a slice of the volume that `supple resample` makes of it.
TEST_F(UnitPictures, ASliceOfAStateIsASliceOfTheResampledVolume) {
  write_soft_material(m_folder / "soft.toml");
  const std::string state = m_folder / "drag.vdb", volume = m_folder / "drag.nrrd";
  ASSERT_EQ(run_supple({"deform", m_folder / "ball.nhdr", "--material", m_folder / "soft.toml",
                        "--grab", "12,12,12", "--by", "4,2,-3", "-o", state})
                .exit_code,
            0);
  ASSERT_EQ(run_supple({"resample", state, "-o", volume}).exit_code, 0);
  // Pixels of axial slices are voxels; across slices the resampled volume has been rounded twice.
  const auto slice = [&](const std::string& input, std::vector<std::string> more) {
    std::vector<std::string> arguments = {
        "slice",   input,     "--at", "12,13,11", "--window", "0,255", "-o", m_folder / "slice.png",
        "--force", "--scale", "1",    "--plane",  "axial"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = run_supple(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return read_png(m_folder / "slice.png");
  };
  const Image resampled = slice(volume, {});
  EXPECT_LT(compare(slice(state, {"--no-outline"}), resampled, false).max_diff, 1.5 / 255);
  EXPECT_GT(compare(slice(state, {"--no-outline", "--undeformed"}), resampled, false).max_diff,
            0.2);
  const Image outlined = slice(state, {});
  int yellow = 0;
  for (std::size_t n = 0; n < outlined.rgba.size(); n += 4) {
    yellow += outlined.rgba[n] == 255 && outlined.rgba[n + 1] == 200 && outlined.rgba[n + 2] == 0;
  }
  EXPECT_GT(yellow, 30);
}

TEST_F(UnitPictures, SlicesShowVolumesOfOneDensityAndOfASmallRange) {
  const auto brightest = [&](const std::function<float(int)>& density) {
    std::string bytes =
        "NRRD0004\ntype: float\ndimension: 3\nsizes: 6 6 6\nendian: little\n"
        "encoding: raw\n\n";
    for (int n = 0; n < 216; ++n) {
      const float value = density(n);
      bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
    }
    write_text(m_folder / "small.nrrd", bytes);
    EXPECT_EQ(
        run_supple({"slice", m_folder / "small.nrrd", "-o", m_folder / "slice.png", "--force"})
            .exit_code,
        0);
    const Image image = read_png(m_folder / "slice.png");
    int most = 0;
    for (std::size_t n = 0; n < image.rgba.size(); n += 4)
      most = std::max(most, int(image.rgba[n]));
    return most;
  };
  EXPECT_NEAR(brightest([](int) { return 7.0f; }), 128, 3);
  EXPECT_GT(brightest([](int n) { return float(n % 6) / 1000; }), 250);
}

TEST_F(UnitPictures, WhatIsNoSliceIsRefused) {
  const auto code = [&](std::vector<std::string> more) {
    std::vector<std::string> arguments = {"slice", m_folder / "ball.nhdr", "-o",
                                          m_folder / "slice.png"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_supple(arguments).exit_code;
  };
  EXPECT_EQ(code({"--plane", "oblique"}), 2);
  EXPECT_EQ(code({"--window", "5"}), 2);
  EXPECT_EQ(code({"--window", "5,5"}), 3);
  EXPECT_EQ(code({"--at", "1,2"}), 2);
  EXPECT_EQ(code({"--at", "1,2,300"}), 3);
  EXPECT_EQ(code({"--scale", "0"}), 3);
  EXPECT_EQ(code({"--undeformed"}), 2);
  EXPECT_EQ(m_folder.entries(), (std::vector<std::string>{"ball.nhdr", "ball.raw"}));
}

TEST_F(UnitPictures, WhatIsNoClipIsRefused) {
  EXPECT_EQ(render("a.png", {"--clip-plane", "1,2,3"}).exit_code, 2);
  EXPECT_EQ(render("a.png", {"--clip-box", "1,2,3"}).exit_code, 2);
  EXPECT_EQ(render("a.png", {"--clip-plane", "1,2,3:0,0,0"}).exit_code, 3);
  EXPECT_EQ(render("a.png", {"--clip-keep", "left"}).exit_code, 2);
  EXPECT_EQ(render("a.png", {"--lattice", "--clip-plane", "0,0,0:1,0,0"}).exit_code, 3);
}

/// A square of 8 mm before the ball, towards anterior.
const char* const kSquarePly =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
    "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
    "8 -4 8\n16 -4 8\n16 -4 16\n8 -4 16\n4 0 1 2 3\n";

TEST_F(UnitPictures, LightsAndMeshesOfASceneAreThoseOfTheCommandLine) {
  write_text(m_folder / "square.ply", kSquarePly);
  write_text(m_folder / "scene.toml",
             "[volume]\npath = \"ball.nhdr\"\n"
             "[[view]]\nimage = \"scene.png\"\nsize = [64, 64]\nshadows = true\n"
             "ambient_occlusion = 4\nshading = \"phong\"\n"
             "[[view.light]]\ndirection = [1, -1, 1]\nintensity = 0.8\ncolour = \"#FFE0C0\"\n"
             "[[view.light]]\ndirection = [0, 0, 1]\nframe = \"camera\"\nintensity = 0.2\n"
             "[[view.mesh]]\npath = \"square.ply\"\ncolour = \"#2040FF\"\nopacity = 0.5\n");
  const Outcome scene =
      run_supple({"run", m_folder / "scene.toml", "-o", m_folder / "", "--force"});
  ASSERT_EQ(scene.exit_code, 0) << scene.err;
  const std::string mesh = m_folder / "square.ply:#2040FF:0.5";
  const std::vector<std::string> all = {
      "--light", "1,-1,1:0.8:#FFE0C0", "--light", "camera:0,0,1:0.2",    "--shadows", "--mesh",
      mesh,      "--shading",          "phong",   "--ambient-occlusion", "4"};
  ASSERT_EQ(render("a.png", all).exit_code, 0);
  const Image expected = read_png(m_folder / "a.png");
  EXPECT_GT(compare(read_png(m_folder / "scene.png"), expected, true).ssim, 0.98);
  // Each of them matters.
  for (std::size_t n = 0; n < all.size();) {
    const std::size_t count = all[n] == "--shadows" ? 1 : 2;
    std::vector<std::string> fewer = all;
    fewer.erase(fewer.begin() + n, fewer.begin() + n + count);
    ASSERT_EQ(render("b.png", fewer).exit_code, 0);
    EXPECT_GT(compare(read_png(m_folder / "b.png"), expected, true).max_diff, 0.01) << all[n];
    n += count;
  }
}

TEST_F(UnitPictures, AMeshMovesAlongWithTheTissueWhenAsked) {
  RUN_WHEN_SANITIZED();
  write_soft_material(m_folder / "soft.toml");
  write_text(m_folder / "square.ply", kSquarePly);
  const std::string state = m_folder / "drag.vdb";
  ASSERT_EQ(run_supple({"deform", m_folder / "ball.nhdr", "--material", m_folder / "soft.toml",
                        "--grab", "12,12,12", "--by", "5,0,0", "-o", state})
                .exit_code,
            0);
  const auto picture = [&](std::vector<std::string> more) {
    std::vector<std::string> arguments = {
        "render",  state,       "--mesh", m_folder / "square.ply:#FF0000",
        "--size",  "64,64",     "-o",     m_folder / "mesh.png",
        "--force", "--shading", "none"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    EXPECT_EQ(run_supple(arguments).exit_code, 0);
    return read_png(m_folder / "mesh.png");
  };
  const auto mean_column_of_red = [](const Image& image) {
    double sum = 0, count = 0;
    for (int n = 0; n < image.width * image.height; ++n) {
      if (image.rgba[4 * n] < 255 || image.rgba[4 * n + 1] > 0) continue;
      sum += n % image.width;
      ++count;
    }
    EXPECT_GT(count, 20);
    return sum / count;
  };
  const double still = mean_column_of_red(picture({}));
  EXPECT_GT(std::abs(mean_column_of_red(picture({"--deform-meshes"})) - still), 0.5);
  EXPECT_NEAR(mean_column_of_red(picture({"--deform-meshes", "--undeformed"})), still, 0.1);
}

TEST_F(UnitPictures, WhatIsNoLightOrMeshIsRefused) {
  write_text(m_folder / "square.ply", kSquarePly);
  write_text(m_folder / "empty.obj", "v 0 0 0\nv 1 0 0\nf 1 2 2\n");
  const std::string square = m_folder / "square.ply";
  const auto code = [&](const std::string& option, const std::string& value) {
    return render("a.png", {option, value}).exit_code;
  };
  EXPECT_EQ(code("--light", "1,2"), 2);
  EXPECT_EQ(code("--light", "1,2,3:x"), 2);
  EXPECT_EQ(code("--light", "1,2,3:1:red"), 2);
  EXPECT_EQ(code("--light", "0,0,0"), 3);
  EXPECT_EQ(code("--light", "1,2,3:-1"), 3);
  EXPECT_EQ(code("--shading", "flat"), 2);
  EXPECT_EQ(code("--ambient-occlusion", "-3"), 3);
  EXPECT_EQ(code("--exposure", "21"), 3);
  EXPECT_EQ(code("--mesh", m_folder / "none.ply"), 3);
  EXPECT_EQ(code("--mesh", m_folder / "empty.obj"), 3);
  EXPECT_EQ(code("--mesh", square + ":#12"), 2);
  EXPECT_EQ(code("--mesh", square + ":#123456:2"), 3);
  EXPECT_EQ(render("a.png", {"--lattice", "--mesh", square}).exit_code, 3);
  EXPECT_EQ(render("a.png", {"--ambient-occlusion"}).exit_code, 0);
}

}  // namespace
