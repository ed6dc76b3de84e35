// Files of pictures: kinds, pictures beside the main one, stereo, cameras, series.
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <thread>

#include <gtest/gtest.h>

#include "lib/state/state.h"
#include "raycast/pictures/compare.h"
#include "raycast/render.h"
#include "tests/support/program.h"
#include "tests/support/sanitized.h"
#include "volumes/base/error.h"
#include "volumes/field/inversion/invert.h"

using namespace supple;
using namespace supple::test;

namespace {

/// A ball, soft, with a dent; half of it is clipped away where a test needs to tell sides apart.
class PictureFiles : public testing::Test {
 protected:
  PictureFiles() {
    write_ball(m_folder, "ball", 24);
    write_soft_material(m_folder / "soft.toml");
    EXPECT_EQ(run_supple({"deform", m_folder / "ball.nhdr", "--material", m_folder / "soft.toml",
                          "--grab", "12,4,12", "--by", "2,6,-3", "-o", m_folder / "drag.vdb"})
                  .exit_code,
              0);
    m_before = m_folder.entries();
  }

  Outcome render(const std::string& input, const std::string& image, std::vector<std::string> more,
                 const RunOptions& options = {}) {
    std::vector<std::string> arguments = {"render", m_folder / input, "-o", m_folder / image};
    if (std::find(more.begin(), more.end(), "--size") == more.end()) {
      arguments.insert(arguments.end(), {"--size", "64,64"});
    }
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_supple(arguments, options);
  }
  Image picture(const std::string& input, std::vector<std::string> more) {
    more.emplace_back("--force");
    const Outcome outcome = render(input, "picture.png", more);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return read_png(m_folder / "picture.png");
  }
  Image file(const std::string& name) const { return read_png(m_folder / name); }

  const TemporaryFolder m_folder;
  std::vector<std::string> m_before;
};

using UnitPictureFiles = PictureFiles;
using FaultPictureFiles = PictureFiles;

TEST_F(UnitPictureFiles, APrintedCameraGivesThePictureOfItsView) {
  const std::vector<std::vector<std::string>> choices = {
      {"--view", "left"}, {"--view", "superior", "--orthographic"}, {"--size", "90,40"}};
  for (std::vector<std::string> choice : choices) {
    const Image expected = picture("ball.nhdr", choice);
    choice.emplace_back("--print-camera");
    const Outcome printed = render("ball.nhdr", "no.png", choice);
    ASSERT_EQ(printed.exit_code, 0) << printed.err;
    write_text(m_folder / "camera.toml", printed.out);
    std::vector<std::string> again = {"--camera", m_folder / "camera.toml"};
    if (choice.front() == "--size") again.insert(again.end(), {"--size", "90,40"});
    EXPECT_EQ(picture("ball.nhdr", again).rgba, expected.rgba);
    again.emplace_back("--print-camera");
    EXPECT_EQ(render("drag.vdb", "no.png", again).out, printed.out);
  }
  EXPECT_FALSE(std::filesystem::exists(m_folder / "no.png"));
}

TEST_F(UnitPictureFiles, APrintedCameraIsExact) {
  const std::string text = render("drag.vdb", "no.png", {"--view", "left", "--print-camera"}).out;
  const Geometry geometry = read_state(m_folder / "drag.vdb").geometry;
  const double x = default_camera(geometry, 1, "left").position_lps_mm.x;
  const std::string key = "position = [";
  const std::size_t place = text.find(key);
  ASSERT_NE(place, std::string::npos) << text;
  EXPECT_EQ(std::strtod(text.c_str() + place + key.size(), nullptr), x);
  EXPECT_NE(std::strtod(number_text(x).c_str(), nullptr), x);  // six digits would not do
}

TEST_F(UnitPictureFiles, TheExtensionAndTheBitsChooseTheFileAndEachHasItsConfiguration) {
  RUN_WHEN_SANITIZED();
  const Image expected = picture("drag.vdb", {});
  ASSERT_EQ(render("drag.vdb", "deep.png", {"--bits", "16"}).exit_code, 0);
  ASSERT_EQ(render("drag.vdb", "floats.exr", {}).exit_code, 0);
  EXPECT_EQ(read_text(m_folder / "picture.png")[24], 8);
  EXPECT_EQ(read_text(m_folder / "deep.png")[24], 16);
  EXPECT_LE(compare(file("deep.png"), expected, false).max_diff, 1.01 / 255);
  EXPECT_EQ(read_text(m_folder / "floats.exr").substr(0, 4), "\x76\x2f\x31\x01");
  for (const char* name : {"picture.png", "deep.png", "floats.exr"}) {
    EXPECT_NE(read_text(m_folder / name).find("\"position\":["), std::string::npos) << name;
  }
}

TEST_F(UnitPictureFiles, AuxiliaryPicturesLieBesideTheirPicture) {
  ASSERT_EQ(render("drag.vdb", "a.png", {"--aux", "depth,normal,offset"}).exit_code, 0);
  EXPECT_EQ(file("a.png").rgba, picture("drag.vdb", {}).rgba);
  for (const char* name : {"a_depth.png", "a_normal.png", "a_offset.png"}) {
    EXPECT_EQ(file(name).height, 64) << name;
  }
  // The dent has moved by more than the rest: it is darker, in the middle.
  const Image offset = file("a_offset.png");
  const auto brightness = [&](int x, int y) {
    const std::uint8_t* rgba = &offset.rgba[4 * (y * offset.width + x)];
    return rgba[0] + rgba[1] + rgba[2];
  };
  EXPECT_LT(brightness(32, 34), brightness(20, 50));
  // The picture has its legend once it is large enough.
  ASSERT_EQ(render("drag.vdb", "b.png", {"--aux", "offset", "--size", "200,200"}).exit_code, 0);
  EXPECT_GT(file("b_offset.png").width, 220);
}

TEST_F(UnitPictureFiles, WhatDoesNotGoTogetherIsRefusedInOneLineAndLeavesNothing) {
  struct Case {
    const char* input;
    const char* image;
    std::vector<std::string> more;
    int exit_code;
    const char* named;
  };
  const Case cases[] = {
      {"ball.nhdr", "a.png", {"--aux", "offset"}, 3, "aux"},
      {"drag.vdb", "a.png", {"--aux", "offset", "--undeformed"}, 3, "aux"},
      {"ball.nhdr", "a.png", {"--aux", "colour"}, 2, "depth, normal, offset, motion or id"},
      {"ball.nhdr", "a.png", {"--aux", "depth", "--lattice"}, 3, "aux"},
      {"ball.nhdr", "a.png", {"--aux", "depth", "--stereo", "anaglyph"}, 3, "aux"},
      {"ball.nhdr", "a_%d.png", {"--sequence", "3"}, 3, "sequence"},
      {"drag.vdb", "a_%d.png", {"--sequence", "1"}, 3, "sequence"},
      {"drag.vdb", "a_%d.png", {"--sequence", "3", "--turntable", "3"}, 3, "one of both"},
      {"ball.nhdr", "a.png", {"--turntable", "3"}, 3, "a_%03d.png"},
      {"ball.nhdr", "a_%d.png", {"--turntable", "99999"}, 3, "turntable"},
      {"ball.nhdr", "a.mp4", {}, 3, "video"},
      {"ball.nhdr", "a.jpg", {}, 3, ".jpg"},
      {"ball.nhdr", "a.mp4", {"--bits", "16", "--turntable", "3"}, 3, "bits"},
      {"ball.nhdr", "a.png", {"--bits", "12"}, 3, "bits"},
      {"ball.nhdr", "a.png", {"--stereo", "anaglyph", "--orthographic"}, 3, "perspective"},
      {"ball.nhdr", "a.png", {"--stereo", "crossed"}, 2, "--stereo"},
      {"ball.nhdr", "a.png", {"--stereo", "anaglyph", "--eye-separation", "-3"}, 3, "eye"}};
  for (const Case& c : cases) {
    const Outcome outcome = render(c.input, c.image, c.more);
    EXPECT_EQ(outcome.exit_code, c.exit_code) << c.more.front() << outcome.err;
    EXPECT_NE(outcome.err.find(c.named), std::string::npos) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  }
  EXPECT_EQ(m_folder.entries(), m_before);
}

TEST_F(UnitPictureFiles, AStereoPairIsTwiceAsWideAndAnAnaglyphIsOpaque) {
  ASSERT_EQ(render("drag.vdb", "pair.png", {"--stereo", "side-by-side"}).exit_code, 0);
  ASSERT_EQ(render("drag.vdb", "red.png", {"--stereo", "anaglyph"}).exit_code, 0);
  const Image pair = file("pair.png"), red = file("red.png");
  EXPECT_EQ(pair.width, 128);
  EXPECT_EQ(pair.height, 64);
  EXPECT_EQ(red.width, 64);
  EXPECT_FALSE(red.has_alpha);
  Image eyes[2] = {Image(64, 64), Image(64, 64)};
  for (std::size_t y = 0; y < 64; ++y) {
    for (std::size_t e = 0; e < 2; ++e) {
      std::copy_n(&pair.rgba[4 * (y * 128 + 64 * e)], 256, &eyes[e].rgba[256 * y]);
    }
  }
  const double difference = compare(eyes[0], eyes[1], true).rmse;
  EXPECT_GT(difference, 0.004);
  ASSERT_EQ(render("drag.vdb", "wide.png", {"--stereo", "side-by-side", "--eye-separation", "0.01"})
                .exit_code,
            0);
  const Image wide = file("wide.png"), plain = picture("drag.vdb", {});
  Image left(64, 64);
  for (std::size_t y = 0; y < 64; ++y) std::copy_n(&wide.rgba[512 * y], 256, &left.rgba[256 * y]);
  EXPECT_LT(compare(left, plain, true).rmse, difference / 10);
}

TEST_F(UnitPictureFiles, ATurntableGoesFromTheViewRoundByTheLeft) {
  // Half a ball, so that every side looks different.
  const std::vector<std::string> half = {"--clip-plane", "14,9,20:1,1,-0.5"};
  std::vector<std::string> turn = {"--turntable", "4"};
  turn.insert(turn.end(), half.begin(), half.end());
  ASSERT_EQ(render("ball.nhdr", "turn_%02d.png", turn).exit_code, 0);
  const char* sides[] = {"anterior", "left", "posterior", "right"};
  for (int n = 0; n < 4; ++n) {
    std::vector<std::string> side = {"--view", sides[n]};
    side.insert(side.end(), half.begin(), half.end());
    const Image frame = file("turn_0" + std::to_string(n) + ".png");
    EXPECT_GT(compare(frame, picture("ball.nhdr", side), true).ssim, 0.999) << sides[n];
  }
  EXPECT_FALSE(std::filesystem::exists(m_folder / "turn_04.png"));
  EXPECT_EQ(render("ball.nhdr", "turn_%02d.png", turn).exit_code, 2);  // there already
}

TEST_F(UnitPictureFiles, ASequenceScalesTheDisplacementFromRestToTheState) {
  ASSERT_EQ(render("drag.vdb", "s_%d.png", {"--sequence", "3"}).exit_code, 0);
  EXPECT_EQ(file("s_0.png").rgba, picture("drag.vdb", {"--undeformed"}).rgba);
  EXPECT_EQ(file("s_2.png").rgba, picture("drag.vdb", {}).rgba);
  // Halfway: where half of u leads, which is not half of the offsets.
  const State state = read_state(m_folder / "drag.vdb");
  Displacement half = extended_displacement_of(state);
  for_each_stored(half.u.vectors, [](Vec3f& u) { u *= 0.5f; });
  const OffsetField offsets = invert(half);
  Renderer renderer(state.geometry, state.density);
  renderer.set_offsets(&offsets);
  RenderSettings settings;
  settings.width = settings.height = 64;
  const Image expected =
      renderer.render(default_camera(state.geometry, 1), preset("MR-Default"), settings);
  EXPECT_LT(compare(file("s_1.png"), expected, true).max_diff, 1.01 / 255);
  EXPECT_LT(compare(file("s_1.png"), file("s_0.png"), true).ssim, 0.99);
}

TEST_F(UnitPictureFiles, AVideoHasAllPicturesAndItsConfiguration) {
  if (!runs("command -v ffprobe")) GTEST_SKIP() << "ffmpeg is not installed";
  for (const std::string name : {"turn.mp4", "turn.webm", "turn.avi"}) {
    const Outcome outcome =
        render("ball.nhdr", name, {"--turntable", "5", "--size", "65,48", "--fps", "10"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const Outcome probe = run_program({"/usr/bin/env", "ffprobe", "-v", "error", "-count_frames",
                                       "-show_streams", "-show_format", m_folder / name});
    for (const char* part : {"nb_read_frames=5", "width=66", "height=48", "r_frame_rate=10/1",
                             "\"program\":\"supple"}) {
      EXPECT_NE(probe.out.find(part), std::string::npos) << name << " " << part << probe.out;
    }
  }
}

TEST_F(UnitPictureFiles, AVideoWithoutItsEncoderIsASystemError) {
  const Outcome outcome =
      run_program({"/usr/bin/env", "PATH=/nowhere", std::getenv("SUPPLE_BINARY"), "render",
                   m_folder / "ball.nhdr", "--turntable", "3", "-o", m_folder / "a.mp4"});
  EXPECT_EQ(outcome.exit_code, 4);
  EXPECT_NE(outcome.err.find("a.mp4: the program ffmpeg"), std::string::npos) << outcome.err;
  EXPECT_EQ(m_folder.entries(), m_before);
}

TEST_F(UnitPictureFiles, AViewOfASceneMakesTheFilesOfTheCommandLine) {
  write_text(m_folder / "scene.toml",
             "[volume]\npath = \"drag.vdb\"\n"
             "[[view]]\nimage = \"cuts.png\"\nslice = { plane = \"axial\", at = [12, 9, 11] }\n"
             "[[view]]\nimage = \"new/s_%d.png\"\nsize = [64, 64]\nsequence = 3\nbits = 16\n"
             "aux = [\"offset\"]\n");
  const Outcome plan = run_supple({"run", m_folder / "scene.toml", "--dry-run"});
  EXPECT_NE(plan.out.find("s_2_offset.png"), std::string::npos) << plan.out;
  const Outcome outcome = run_supple({"run", m_folder / "scene.toml", "-o", m_folder.path()});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  ASSERT_EQ(run_supple({"slice", m_folder / "drag.vdb", "--plane", "axial", "--at", "12,9,11", "-o",
                        m_folder / "cut.png"})
                .exit_code,
            0);
  EXPECT_EQ(file("cuts.png").rgba, file("cut.png").rgba);
  EXPECT_LE(compare(file("new/s_2.png"), picture("drag.vdb", {}), false).max_diff, 1.01 / 255);
  EXPECT_EQ(file("new/s_0_offset.png").height, 64);
}

TEST_F(UnitPictureFiles, ABadViewIsNamedByFileAndLine) {
  const auto error_of = [&](const std::string& keys) {
    write_text(m_folder / "scene.toml",
               "[volume]\npath = \"drag.vdb\"\n[[view]]\nimage = \"a.png\"\n" + keys + "\n");
    const Outcome outcome = run_supple({"run", m_folder / "scene.toml", "-o", m_folder.path()});
    EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
    return outcome.err;
  };
  for (const char* keys :
       {"bits = 9", "stereo = \"crossed\"", "slice = { plane = \"oblique\" }",
        "slice = { scale = 0 }", "slice = { window = [1] }", "slice = { at = [99, 0, 0] }",
        "slice = { window = [5, 5] }", "slice = {}\npreset = \"Bone\"", "turntable = 3",
        "turntable = 0", "aux = [\"deep\"]"}) {
    EXPECT_NE(error_of(keys).find("scene.toml:"), std::string::npos) << keys;
  }
  std::filesystem::remove(m_folder / "scene.toml");
  EXPECT_EQ(m_folder.entries(), m_before);
}

TEST_F(FaultPictureFiles, AFullDiskLeavesNoPictureOfASeriesAndNoFolder) {
  RunOptions full;
  full.max_file_bytes = 700;
  for (const char* name : {"a_%d.png", "a.exr"}) {
    std::vector<std::string> more;
    if (std::string(name) != "a.exr") more = {"--turntable", "3"};
    const Outcome outcome = render("ball.nhdr", name, more, full);
    EXPECT_EQ(outcome.exit_code, 4) << outcome.err;
    EXPECT_NE(outcome.err.find("cannot write"), std::string::npos) << outcome.err;
    EXPECT_EQ(outcome.err.find(".supple-"), std::string::npos) << outcome.err;
  }
  write_text(m_folder / "scene.toml",
             "[volume]\npath = \"ball.nhdr\"\n[[view]]\nimage = \"in/new/a_%d.png\"\n"
             "turntable = 3\nsize = [64, 64]\n");
  EXPECT_EQ(run_supple({"run", m_folder / "scene.toml", "-o", m_folder.path()}, full).exit_code, 4);
  std::filesystem::remove(m_folder / "scene.toml");
  EXPECT_EQ(m_folder.entries(), m_before);
}

TEST_F(FaultPictureFiles, CtrlCWhileAnEncoderStartsLeavesNothing) {
  // Begins to write when the program that it works for is gone.
  const supple::test::TemporaryFolder programs;
  write_text(
      programs / "ffmpeg",
      "#!/bin/sh\n: > \"$0.started\"\nsleep 1\nfor name; do :; done\necho late > \"$name\"\n");
  std::filesystem::permissions(programs / "ffmpeg", std::filesystem::perms::owner_all);
  RunOptions options;
  options.interrupt_at_file = programs / "ffmpeg.started";
  const Outcome outcome = run_program(
      {"/usr/bin/env", "PATH=" + (programs / "") + ":/usr/bin:/bin", std::getenv("SUPPLE_BINARY"),
       "render", m_folder / "ball.nhdr", "--turntable", "5000", "-o", m_folder / "a.mp4"},
      options);
  EXPECT_EQ(outcome.exit_code, 128 + SIGINT) << outcome.err;
  std::this_thread::sleep_for(std::chrono::milliseconds(1200));
  EXPECT_EQ(m_folder.entries(), m_before);
}

TEST_F(FaultPictureFiles, CtrlCLeavesNothingOfASeriesOrAVideo) {
  std::vector<std::string> names = {"a_%04d.png"};
  if (runs("command -v ffmpeg")) names.emplace_back("a.mp4");
  for (const std::string& name : names) {
    RunOptions options;
    options.interrupt_after_s = 0.4;
    const Outcome outcome = render("ball.nhdr", name, {"--turntable", "5000"}, options);
    EXPECT_EQ(outcome.exit_code, 128 + SIGINT) << outcome.err;
    EXPECT_EQ(m_folder.entries(), m_before);
  }
}

}  // namespace
