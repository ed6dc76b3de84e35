// Wishes of users for a picture beside what it shows: framing, background, annotations, and kinds
// of slices.
#include <cmath>
#include <cstdlib>

#include <gtest/gtest.h>

#include "raycast/pictures/compare.h"
#include "raycast/pictures/image.h"
#include "tests/support/program.h"
#include "tests/support/sanitized.h"

using namespace supple;
using namespace supple::test;

namespace {

class UnitStaging : public testing::Test {
 protected:
  UnitStaging() { write_ball(m_folder, "ball", 24); }

  Image picture(const std::string& command, std::vector<std::string> more) {
    std::vector<std::string> arguments = {command, m_folder / "ball.nhdr", "-o", m_folder / "a.png",
                                          "--force"};
    const bool is_sized = std::find(more.begin(), more.end(), "--size") != more.end();
    if (command == "render" && !is_sized) {
      arguments.insert(arguments.end(), {"--size", "80,80"});
    }
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = run_supple(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome.exit_code == 0 ? read_png(m_folder / "a.png") : Image(1, 1);
  }
  int code(const std::string& command, std::vector<std::string> more) {
    std::vector<std::string> arguments = {command, m_folder / "ball.nhdr", "-o", m_folder / "a.png",
                                          "--force"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_supple(arguments).exit_code;
  }

  const TemporaryFolder m_folder;
};

/// Free pixels at the left, right, top and bottom.
std::array<int, 4> free_margins(const Image& image) {
  std::array<int, 4> margins = {image.width, image.width, image.height, image.height};
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      if (image.rgba[4 * (std::size_t(y) * image.width + x) + 3] < 26) continue;
      margins = {std::min(margins[0], x), std::min(margins[1], image.width - 1 - x),
                 std::min(margins[2], y), std::min(margins[3], image.height - 1 - y)};
    }
  }
  return margins;
}

int least(const std::array<int, 4>& margins) {
  return *std::min_element(margins.begin(), margins.end());
}

TEST_F(UnitStaging, WhatIsVisibleFillsThePicture) {
  // An eighth of the ball, far from the middle of its box.
  const std::vector<std::string> clip = {"--clip-box", "12,12,12:24,24,24"};
  for (const char* view : {"anterior", "left", "superior"}) {
    for (const bool is_orthographic : {false, true}) {
      std::vector<std::string> options = clip;
      options.insert(options.end(), {"--view", view});
      if (is_orthographic) options.emplace_back("--orthographic");
      EXPECT_GE(least(free_margins(picture("render", options))), 7) << view;
      options.insert(options.end(), {"--fit", "visible"});
      const auto margins = free_margins(picture("render", options));
      EXPECT_NEAR(least(margins), 4, 1) << view;
      // The margin is as wide on the other side.
      const bool fits_width = std::min(margins[0], margins[1]) <= 5;
      EXPECT_NEAR(fits_width ? margins[0] : margins[2], fits_width ? margins[1] : margins[3], 1.5);
    }
  }
}

TEST_F(UnitStaging, TheBodyFillsThePictureWhereItHasGone) {
  write_soft_material(m_folder / "soft.toml");
  ASSERT_EQ(run_supple({"deform", m_folder / "ball.nhdr", "--material", m_folder / "soft.toml",
                        "--grab", "12,12,12", "--by", "20,0,0", "-o", m_folder / "drag.vdb"})
                .exit_code,
            0);
  const auto margins_of = [&](std::vector<std::string> more) {
    std::vector<std::string> arguments = {"render", m_folder / "drag.vdb", "--size", "80,80",
                                          "-o",     m_folder / "b.png",    "--force"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    EXPECT_EQ(run_supple(arguments).exit_code, 0);
    return free_margins(read_png(m_folder / "b.png"));
  };
  const auto body = margins_of({"--fit", "body"}), visible = margins_of({"--fit", "visible"});
  EXPECT_GE(least(body), 3);
  // Elements beyond the volume's box are not drawn; the body counts them.
  EXPECT_LE(std::abs(least(visible) - 4), 1);
}

TEST_F(UnitStaging, AZoomIsACropOfALargerPicture) {
  const Image large = picture("render", {"--size", "160,160"}),
              near = picture("render", {"--zoom", "2"});
  Image crop(80, 80);
  for (int y = 0; y < 80; ++y) {
    std::copy_n(&large.rgba[4 * (std::size_t(y + 40) * 160 + 40)], 4 * 80, &crop.rgba[4 * 80 * y]);
  }
  EXPECT_GT(compare(near, crop, true).ssim, 0.999);
}

/// A sheet that is first seen from its edge.
TEST_F(UnitStaging, ATurntableOfTheVisibleStaysInEveryPicture) {
  const Outcome outcome = run_supple({"render", m_folder / "ball.nhdr", "--clip-box",
                                      "11,0,8:13,24,16", "--fit", "visible", "--turntable", "4",
                                      "--size", "80,80", "-o", m_folder / "turn_%d.png"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  int fullest = 80;
  for (const char* name : {"turn_0.png", "turn_1.png", "turn_2.png", "turn_3.png"}) {
    const int margin = least(free_margins(read_png(m_folder / name)));
    EXPECT_GE(margin, 3) << name;
    fullest = std::min(fullest, margin);
  }
  EXPECT_LE(fullest, 6);
}

/// The background is seen as far as the picture alone is transparent, whatever the blend.
TEST_F(UnitStaging, BackgroundsAreCompositedUnderEveryBlend) {
  for (const char* preset : {"MR-Default", "CT-X-ray", "MR-MIP"}) {
    const Image alone = picture("render", {"--preset", preset, "--background", "transparent"});
    const Image over = picture("render", {"--preset", preset, "--background", "#4080C0"});
    EXPECT_FALSE(over.has_alpha);
    const double behind[] = {0x40, 0x80, 0xC0};
    for (std::size_t n = 0; n < alone.rgba.size(); n += 4) {
      const double alpha = alone.rgba[n + 3] / 255.0;
      for (std::size_t c = 0; c < 3; ++c) {
        const double expected = alpha * alone.rgba[n + c] + (1 - alpha) * behind[c];
        ASSERT_NEAR(over.rgba[n + c], expected, 1.6) << preset << " pixel " << n / 4;
      }
    }
  }
}

TEST_F(UnitStaging, AnnotationsOfASceneAreThoseOfTheCommandLineAndLeaveTheRest) {
  write_text(m_folder / "scene.toml",
             "[volume]\npath = \"ball.nhdr\"\n"
             "[[view]]\nimage = \"space.png\"\nsize = [240, 240]\nzoom = 0.8\n"
             "background = \"checker\"\nannotate = [\"letters\", \"cube\", \"scale\"]\n"
             "[[view]]\nimage = \"slice.png\"\nannotate = [\"all\"]\nbackground = \"white\"\n"
             "slice = { lightbox = [2, 1], thickness = 3, slab = \"mip\", plane = \"coronal\" }\n");
  const Outcome scene =
      run_supple({"run", m_folder / "scene.toml", "-o", m_folder / "", "--force"});
  ASSERT_EQ(scene.exit_code, 0) << scene.err;
  const std::vector<std::string> framing = {"--zoom",  "0.8",    "--background",
                                            "checker", "--size", "240,240"};
  std::vector<std::string> annotated = framing;
  annotated.insert(annotated.end(), {"--annotate", "letters,cube,scale"});
  const Image plain = picture("render", framing), written = picture("render", annotated);
  EXPECT_EQ(read_png(m_folder / "space.png").rgba, written.rgba);
  int changed = 0, centre = 0;
  for (int n = 0; n < 240 * 240; ++n) {
    const bool differs =
        !std::equal(&plain.rgba[4 * n], &plain.rgba[4 * n] + 4, &written.rgba[4 * n]);
    changed += differs;
    centre += differs && std::abs(n % 240 - 120) < 60 && std::abs(n / 240 - 120) < 60;
  }
  EXPECT_GT(changed, 200);
  EXPECT_EQ(centre, 0);
  EXPECT_EQ(read_png(m_folder / "slice.png").rgba,
            picture("slice", {"--lightbox", "2x1", "--thickness", "3", "--slab", "mip", "--plane",
                              "coronal", "--annotate", "all", "--background", "white"})
                .rgba);
}

TEST_F(UnitStaging, ALightboxHoldsTheSlicesThatItsPlacesName) {
  const Image box =
      picture("slice", {"--lightbox", "2,2", "--every", "6", "--plane", "axial", "--scale", "1"});
  // Slices lie about the middle, voxel 11 of 24, 1.5 mm a slice: 9, 3, -3 and -9 mm from it.
  const int width = 24, cell = width + 8;
  ASSERT_EQ(box.width, 2 * cell - 8);
  for (int n = 0; n < 4; ++n) {
    const std::string at = "11,11," + std::to_string(11 - 6 + 4 * n);
    const Image one = picture("slice", {"--plane", "axial", "--scale", "1", "--at", at});
    ASSERT_EQ(one.width, width);
    for (int y = 0; y < one.height; ++y) {
      const std::uint8_t* row =
          &box.rgba[4 * (std::size_t(n / 2 * cell + y) * box.width + n % 2 * cell)];
      ASSERT_TRUE(std::equal(row, row + 4 * width, &one.rgba[4 * std::size_t(y) * width])) << n;
    }
  }
}

TEST_F(UnitStaging, LabelsAndTheirTissueAreOutlinedTogether) {
  RUN_WHEN_SANITIZED();
  std::string voxels;
  for (int n = 0; n < 24 * 24 * 24; ++n) voxels += char(n % 24 >= 8 && n % 24 < 16 ? 2 : 0);
  write_text(m_folder / "labels.raw", voxels);
  write_text(m_folder / "labels.nhdr",
             "NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\n"
             "sizes: 24 24 24\nspace directions: (1,0,0) (0,1,0) (0,0,1.5)\n"
             "space origin: (0,0,0)\nencoding: raw\ndata file: labels.raw\n");
  const std::vector<std::string> options = {"--plane", "axial", "--scale", "1"};
  std::vector<std::string> labelled = options;
  labelled.insert(labelled.end(), {"--labels", m_folder / "labels.nhdr"});
  const Image plain = picture("slice", options), outlined = picture("slice", labelled);
  for (int y = 0; y < 24; ++y) {
    for (int x = 0; x < 24; ++x) {
      const std::size_t n = 4 * (std::size_t(y) * 24 + x);
      const bool differs = !std::equal(&plain.rgba[n], &plain.rgba[n] + 3, &outlined.rgba[n]);
      const bool is_rim = x == 8 || x == 15 || ((y == 0 || y == 23) && x > 8 && x < 15);
      ASSERT_EQ(differs, is_rim) << x << " " << y;
    }
  }
}

/// Arrows and bent lines are where tissue has moved, straight lines everywhere.
TEST_F(UnitStaging, ArrowsAndTheGridShowWhereTissueHasGone) {
  RUN_WHEN_SANITIZED();
  write_soft_material(m_folder / "soft.toml");
  ASSERT_EQ(run_supple({"deform", m_folder / "ball.nhdr", "--material", m_folder / "soft.toml",
                        "--grab", "12,12,12", "--by", "6,0,0", "-o", m_folder / "drag.vdb"})
                .exit_code,
            0);
  const auto slice = [&](std::vector<std::string> more) {
    std::vector<std::string> arguments = {"slice",    m_folder / "drag.vdb",
                                          "-o",       m_folder / "a.png",
                                          "--force",  "--plane",
                                          "axial",    "--at",
                                          "12,12,12", "--scale",
                                          "8",        "--no-outline"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = run_supple(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return read_png(m_folder / "a.png");
  };
  const Image plain = slice({}), arrows = slice({"--arrows", "8"});
  const Image bent = slice({"--grid", "4"}), straight = slice({"--grid", "4", "--undeformed"});
  const auto is_orange = [](const std::uint8_t* rgba) {
    return rgba[0] == 255 && rgba[1] > 90 && rgba[1] < 140 && rgba[2] < 60;
  };
  int shafts = 0, moved_lines = 0;
  for (int y = 0; y < arrows.height; ++y) {
    for (int x = 0; x < arrows.width; ++x) {
      const std::size_t n = 4 * (std::size_t(y) * arrows.width + x);
      ASSERT_FALSE(is_orange(&plain.rgba[n]));
      shafts += is_orange(&arrows.rgba[n]);
      moved_lines += bent.rgba[n + 2] != straight.rgba[n + 2];
      // Columns of voxels 8 and 12 are lines at rest; the centre of voxel 0 is in column 3.
      if (x == 3 + 8 * 8 || x == 3 + 12 * 8) {
        EXPECT_GT(int(straight.rgba[n + 2]), 240) << x << " " << y;
      }
    }
  }
  EXPECT_GT(shafts, 30);
  EXPECT_GT(moved_lines, 500);
  // One arrow ends in the middle of the picture, where its tissue is now; it came from the left.
  const auto is_arrow = [&](int x) {
    bool is_there = false;
    for (int y = 92; y < 99; ++y) {
      const std::uint8_t* rgba = &arrows.rgba[4 * (std::size_t(y) * arrows.width + x)];
      is_there = is_there || (rgba[0] > rgba[2] + 60);  // smooth edges are not pure
    }
    return is_there;
  };
  for (int x = 80; x < 94; ++x) EXPECT_TRUE(is_arrow(x)) << x;
  for (int x = 98; x < 106; ++x) EXPECT_FALSE(is_arrow(x)) << x;
}

/// Arrows are seen in space where tissue has moved, lines of the grid bend there, and surfaces of
/// labels go along.
TEST_F(UnitStaging, ArrowsGridAndLabelsShowInSpaceWhereTissueHasGone) {
  write_soft_material(m_folder / "soft.toml");
  ASSERT_EQ(run_supple({"deform", m_folder / "ball.nhdr", "--material", m_folder / "soft.toml",
                        "--grab", "12,12,12", "--by", "6,0,0", "-o", m_folder / "drag.vdb"})
                .exit_code,
            0);
  ASSERT_EQ(run_supple({"threshold", m_folder / "ball.nhdr", "--keep", "150,255", "--mask", "-o",
                        m_folder / "mask.nrrd"})
                .exit_code,
            0);
  const auto render = [&](std::vector<std::string> more) {
    std::vector<std::string> arguments = {
        "render", m_folder / "drag.vdb", "-o", m_folder / "a.png", "--force", "--size", "120,120"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = run_supple(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return read_png(m_folder / "a.png");
  };
  const auto differing = [](const Image& a, const Image& b, bool of_alpha) {
    int count = 0;
    for (std::size_t n = 0; n < a.rgba.size(); n += 4) {
      const std::size_t first = of_alpha ? 3 : 0;
      count += !std::equal(&a.rgba[n + first], &a.rgba[n + 4], &b.rgba[n + first]);
    }
    return count;
  };
  const Image plain = render({}), grid = render({"--grid", "4"});
  const Image still = render({"--undeformed"}), straight = render({"--undeformed", "--grid", "4"});
  EXPECT_GT(differing(plain, grid, false), 300);
  EXPECT_EQ(differing(plain, grid, true), 0);  // on what is seen alone
  EXPECT_GT(differing(still, straight, false), 300);
  EXPECT_GT(differing(grid, straight, false), 300);
  // The same lines where samples solve for themselves.
  EXPECT_GT(compare(grid, render({"--grid", "4", "--no-inverse"}), true).ssim, 0.98);

  // Half of the ball is cut away: arrows of what is left stick out of the face.
  const std::vector<std::string> half = {"--clip-box", "0,12,0:24,24,24"};
  std::vector<std::string> with_arrows = half;
  with_arrows.insert(with_arrows.end(), {"--arrows", "3"});
  EXPECT_GT(differing(render(half), render(with_arrows), false), 100);
  const auto left_of = [](const Image& image) { return free_margins(image)[1]; };
  const std::vector<std::string> nothing = {"--clip-box", "0,0,0:1,1,1", "--labels",
                                            m_folder / "mask.nrrd"};
  std::vector<std::string> rest = nothing;
  rest.emplace_back("--undeformed");
  EXPECT_LT(left_of(render(nothing)), left_of(render(rest)) - 4);  // it has moved to the left

  EXPECT_EQ(code("render", {"--arrows", "5"}), 3);  // a volume at rest
  EXPECT_EQ(code("render", {"--grid", "0.1"}), 3);
  EXPECT_EQ(code("render", {"--labels", m_folder / "none.nrrd"}), 3);
}

/// The right margin is wide enough for a legend.
TEST_F(UnitStaging, AnnotationsStandBesideWhatIsFitted) {
  const Outcome outcome = run_supple(
      {"render", m_folder / "ball.nhdr", "-o", m_folder / "b.png", "--force", "--fit", "visible",
       "--size", "400,400", "--annotate", "legend", "--aux", "depth", "--view", "superior"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Image depth = read_png(m_folder / "b_depth.png");
  int right_most = 0;
  for (int y = 0; y < 400; ++y) {
    for (int x = 0; x < 400; ++x) {
      if (depth.rgba[4 * (std::size_t(y) * std::size_t(depth.width) + std::size_t(x))] > 20) {
        right_most = std::max(right_most, x);
      }
    }
  }
  // Depths are known where half of the light is stopped, a few pixels inside of what is visible.
  EXPECT_LE(right_most, 400 - 8.25 * 400 / 32 + 1);
  EXPECT_GT(right_most, 400 - 8.25 * 400 / 32 - 12);
}

/// Projections have a black background, unless told.
TEST_F(UnitStaging, ProjectionsLieOnBlackUnlessTold) {
  const Image on_black = picture("render", {"--preset", "MR-MIP"});
  EXPECT_FALSE(on_black.has_alpha);
  EXPECT_EQ(on_black.rgba[0], 0);
  EXPECT_TRUE(picture("render", {"--preset", "MR-MIP", "--background", "transparent"}).has_alpha);
  EXPECT_TRUE(picture("render", {"--preset", "MR-Default"}).has_alpha);
}

TEST_F(UnitStaging, WhatCannotBeStagedIsRefused) {
  EXPECT_EQ(code("render", {"--fit", "tight"}), 2);
  EXPECT_EQ(code("render", {"--zoom", "0"}), 3);
  EXPECT_EQ(code("render", {"--background", "mauve"}), 3);
  EXPECT_EQ(code("render", {"--annotate", "letters,frame"}), 2);
  EXPECT_EQ(code("render", {"--annotate", "crosshair"}), 3);
  EXPECT_EQ(code("render", {"--fit", "visible", "--print-camera"}), 2);
  EXPECT_EQ(code("slice", {"--annotate", "cube"}), 3);
  EXPECT_EQ(code("slice", {"--normal", "0,0,0"}), 3);
  EXPECT_EQ(code("slice", {"--normal", "0,0,1", "--plane", "axial"}), 3);
  EXPECT_EQ(code("slice", {"--up", "0,0,1"}), 3);
  EXPECT_EQ(code("slice", {"--slab", "mip"}), 3);
  EXPECT_EQ(code("slice", {"--every", "3"}), 3);
  EXPECT_EQ(code("slice", {"--lightbox", "0x3"}), 3);
  EXPECT_EQ(code("slice", {"--lightbox", "2x1", "--every", "1000"}), 3);
  EXPECT_EQ(code("slice", {"--lightbox", "3"}), 2);
  EXPECT_EQ(code("slice", {"--arrows", "5"}), 3);
  EXPECT_EQ(code("slice", {"--grid", "0.1"}), 3);
  EXPECT_EQ(code("slice", {"--labels", m_folder / "none.nrrd"}), 3);
}

}  // namespace
