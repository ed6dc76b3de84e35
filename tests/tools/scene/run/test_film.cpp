// Films: frames that depend on the scene and their time alone, and go on after an interruption.
#include <algorithm>
#include <cmath>
#include <sstream>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <gtest/gtest.h>

#include "tests/support/program.h"
#include "tests/support/sanitized.h"

using namespace supple::test;

namespace {

class PropertyFilm : public ::testing::Test {
 protected:
  void SetUp() override {
    write_ball(m_folder, "ball", 24);
    write_soft_material(m_folder / "soft.toml");
  }

  void write_scene(const std::string& name, const std::string& rest) {
    write_text(m_folder / name,
               "[volume]\npath = \"ball.nhdr\"\n[material]\ntable = \"soft.toml\"\n" + rest);
  }
  void write_film(const std::string& view = "") {
    write_scene("film.toml",
                "[film]\ntimes = \"frames\"\nframes = 6\n[[step]]\nfix = [[0, 0, 0, 3, 23, 23]]\n"
                "[[step]]\ngrab = [14, 12, 12]\n"
                "path = [{ time = 0, by = [0, 0, 0], easing = \"linear\" },\n"
                "        { time = 4, by = [4, 0, 0] }, { time = 5, by = [0, 2, 0] }]\n"
                "[output]\nstate = \"s_%02d.vdb\"\n[[view]]\nimage = \"f_%02d.png\"\n"
                "size = [48, 40]\n"
                "camera_path = [{ time = 0, turn = 0 }, { time = 5, turn = 100, zoom = 2 }]\n" +
                    view);
  }
  Outcome run(const std::string& folder, std::vector<std::string> options = {}) {
    options.insert(options.begin(), {"run", m_folder / "film.toml", "-o", m_folder / folder});
    return run_supple(options);
  }
  /// Frame 2 of a film with a mesh.
  std::string film_exr() {
    write_text(m_folder / "probe.obj", "v 8 -4 14\nv 13 -4 14\nv 8 -4 20\nf 1 2 3\n");
    write_film(
        "[[view]]\nimage = \"m_%02d.exr\"\nsize = [48, 40]\naux = [\"motion\", \"id\"]\n"
        "mesh = [{ path = \"probe.obj\" }]\n"
        "camera_path = [{ time = 0, turn = 0, zoom = 1 }, { time = 5, turn = 50, zoom = 1.5 }]\n");
    const Outcome outcome = run("out", {"--frames", "2"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return m_folder / "out/m_02.exr";
  }
  void expect_same(const std::string& a, const std::string& b, int frame) {
    for (const std::string& name :
         {"f_0" + std::to_string(frame) + ".png", "s_0" + std::to_string(frame) + ".vdb"}) {
      EXPECT_EQ(read_text(m_folder / (a + "/" + name)), read_text(m_folder / (b + "/" + name)))
          << name;
    }
  }
  void expect_refused(const Outcome& outcome, const std::vector<std::string>& words) {
    EXPECT_NE(outcome.exit_code, 0);
    for (const std::string& word : words) {
      EXPECT_NE(outcome.err.find(word), std::string::npos) << word << " in " << outcome.err;
    }
  }

  TemporaryFolder m_folder;
};

using InteropFilm = PropertyFilm;

/// Row by row from above.
std::vector<float> channel_of(const std::string& path, const char* name) {
  Imf::InputFile file(path.c_str());
  const Imath::Box2i box = file.header().dataWindow();
  const std::size_t width = std::size_t(box.max.x - box.min.x + 1);
  const std::size_t height = std::size_t(box.max.y - box.min.y + 1);
  std::vector<float> values(width * height);
  if (file.header().channels().findChannel(name) == nullptr) return {};
  Imf::FrameBuffer buffer;
  buffer.insert(name, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values.data()), sizeof(float),
                                 width * sizeof(float)));
  file.setFrameBuffer(buffer);
  file.readPixels(box.min.y, box.max.y);
  return values;
}

}  // namespace

TEST_F(PropertyFilm, ADryRunFindsWhatTheFilmWouldRefuseAndNothingIsLeftBehind) {
  const auto expect_refused = [&](const std::string& view, const std::string& found) {
    write_film("[[view]]\nimage = \"a_%02d.exr\"\nsize = [48, 40]\n" + view);
    for (const bool is_dry : {true, false}) {
      const Outcome outcome =
          run("out", is_dry ? std::vector<std::string>{"--dry-run"} : std::vector<std::string>{});
      EXPECT_EQ(outcome.exit_code, 3) << view;
      EXPECT_NE(outcome.err.find(found), std::string::npos) << outcome.err;
    }
    EXPECT_FALSE(std::filesystem::exists(m_folder / "out"));
  };
  expect_refused("aux = [\"motion\", \"offset\"]\n", "offset_max: found none beside offsets");
  expect_refused("aux = [\"motion\", \"id\"]\n", "aux: found id without labels or meshes");
  expect_refused("overlay = \"displacement\"\n", "overlay_range: found none beside displacements");
}

TEST_F(PropertyFilm, AFilmThatWasKilledGoesOnWithTheSameBytes) {
  write_film();
  const Outcome whole = run("whole");
  ASSERT_EQ(whole.exit_code, 0) << whole.err;
  ASSERT_EQ(run("part", {"--frames", "0:2"}).exit_code, 0);
  // The folder is as a process left it that was killed in frame 2 and had gone on elsewhere.
  std::filesystem::remove(m_folder / "part/s_02.vdb");
  write_text(m_folder / "part/.supple-1-f_03.png", "half");
  expect_refused(run("part"), {"f_00.png", "--force", "--resume"});
  const Outcome resumed = run("part", {"--resume", "--json"});
  ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
  EXPECT_EQ(resumed.out.find("f_01.png"), std::string::npos) << resumed.out;
  for (int frame = 0; frame < 6; ++frame) expect_same("whole", "part", frame);
  const Outcome again = run("part", {"--resume"});
  EXPECT_NE(again.err.find("all frames are there"), std::string::npos) << again.err;
}

TEST_F(PropertyFilm, KillInTheMiddleLeavesWholeFramesAndThoseThatAreMissing) {
  write_film();
  ASSERT_EQ(run("whole").exit_code, 0);
  for (const char* last : {"f_00.png", "s_02.vdb", "f_04.png"}) {
    RunOptions options;
    options.interrupt_at_file = m_folder / (std::string("killed/") + last);
    options.interrupt_by = SIGKILL;
    const Outcome killed =
        run_supple({"run", m_folder / "film.toml", "-o", m_folder / "killed"}, options);
    EXPECT_EQ(killed.exit_code, 128 + SIGKILL);
    const Outcome resumed = run("killed", {"--resume"});
    ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
    for (int frame = 0; frame < 6; ++frame) expect_same("whole", "killed", frame);
    std::filesystem::remove_all(m_folder / "killed");
  }
}

TEST_F(PropertyFilm, AFrameIsTheSceneWithTheHandleAtItsPose) {
  RUN_WHEN_SANITIZED();
  write_film();
  ASSERT_EQ(run("film", {"--frames", "3", "--threads", "1"}).exit_code, 0);
  write_scene("still.toml",
              "[[step]]\nfix = [[0, 0, 0, 3, 23, 23]]\n[[step]]\ngrab = [14, 12, 12]\n"
              "by = [3, 0, 0]\n[output]\nstate = \"s_03.vdb\"\n");
  ASSERT_EQ(run_supple({"run", m_folder / "still.toml", "-o", m_folder / "still"}).exit_code, 0);
  EXPECT_EQ(read_text(m_folder / "film/s_03.vdb"), read_text(m_folder / "still/s_03.vdb"));
  EXPECT_FALSE(std::filesystem::exists(m_folder / "film/s_02.vdb"));
}

TEST_F(PropertyFilm, AMeshBodyIsWhereItsPathHasItInEachFrame) {
  write_text(m_folder / "probe.obj", "v 8 -4 14\nv 13 -4 14\nv 8 -4 20\nf 1 2 3\n");
  const auto write_path = [&](const std::string& last) {
    write_scene("film.toml",
                "[film]\ntimes = \"frames\"\nframes = 2\n[[body]]\nname = \"probe\"\n"
                "path = \"probe.obj\"\n[[step]]\nbody = \"probe\"\nframe = \"lps\"\n"
                "grab_ball = [8, -4, 14]\nradius = 20\n"
                "path = [{ time = 0, by = [0, 0, 0] }, { time = 1, by = [" +
                    last +
                    "] }]\n[[view]]\n"
                    "image = \"f_%02d.png\"\nsize = [48, 40]\n");
  };
  const auto looks_as = [&](const std::string& a, const std::string& b) {
    const Outcome outcome = run_supple({"compare", m_folder / a, m_folder / b, "--max-diff", "0"});
    EXPECT_LE(outcome.exit_code, 1) << outcome.err;
    return outcome.exit_code == 0;
  };
  write_path("5, 0, 6");
  const Outcome film = run("film");
  ASSERT_EQ(film.exit_code, 0) << film.err;
  ASSERT_EQ(run("alone", {"--frames", "1"}).exit_code, 0);
  EXPECT_FALSE(looks_as("film/f_01.png", "film/f_00.png"));
  EXPECT_TRUE(looks_as("film/f_01.png", "alone/f_01.png"));
  write_path("0, 0, 0");
  ASSERT_EQ(run("still").exit_code, 0);
  EXPECT_TRUE(looks_as("still/f_01.png", "film/f_00.png"));
}

TEST_F(PropertyFilm, FramesOfAnotherSceneAreNotContinued) {
  write_film();
  ASSERT_EQ(run("out", {"--frames", "0:1"}).exit_code, 0);
  write_film("shading = \"phong\"\n");
  expect_refused(run("out", {"--resume"}), {"film.film.json", "another scene", "--force"});
  EXPECT_EQ(run("out", {"--resume", "--force", "--frames", "0"}).exit_code, 0);
}

TEST_F(PropertyFilm, AWarningIsToldOnceWithItsFrames) {
  write_scene("film.toml",
              "[film]\ntimes = \"frames\"\n[[step]]\nfix = [[0, 0, 0, 12, 23, 23]]\n"
              "grab = [14, 12, 12]\npath = [{ time = 0, by = [0, 0, 0], easing = \"linear\" },\n"
              "        { time = 4, by = [20, 0, 0] }]\n[output]\nstate = \"s_%02d.vdb\"\n");
  const Outcome outcome = run("out");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  std::size_t count = 0;
  for (std::size_t at = 0; (at = outcome.err.find("anchors stopped", at)) != std::string::npos;) {
    ++count, ++at;
  }
  EXPECT_EQ(count, 2u) << outcome.err;
  for (const char* words : {"warning: frame 1: anchors stopped the drag at", "frames 2 to 4: as"}) {
    EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
  }
}

TEST_F(PropertyFilm, WhatCannotBeFilmedIsRefused) {
  write_film("turntable = 4\n");
  expect_refused(run("out"), {"turntable", "turn in camera_path"});
  write_film("aux = [\"motion\"]\n");
  expect_refused(run("out"), {"aux", "motion", ".exr"});
  write_film();
  expect_refused(run("out", {"--frames", "4:6"}), {"--frames", "'4:6'", "0 to 5"});
  write_scene("film.toml",
              "[film]\n[[step]]\ngrab = [14, 12, 12]\n"
              "path = [{ time = 2, by = [0, 0, 0] }, { time = 1, by = [1, 0, 0] }]\n");
  expect_refused(run("out"), {"film.toml:8", "time", "found 1", "after", "2"});
  write_scene("film.toml", "[[view]]\nimage = \"a.png\"\ncamera_path = [{ time = 0, turn = 0 }]\n");
  expect_refused(run("out"), {"camera_path", "[film]"});
  EXPECT_FALSE(std::filesystem::exists(m_folder / "out/f_00.png"));
}

TEST_F(PropertyFilm, AnExrOfAFilmHasMotionAndNumbers) {
  RUN_WHEN_SANITIZED();
  const std::string path = film_exr();
  EXPECT_EQ(channel_of(path, "Z").size(), 48u * 40);
  // Twice as large and seen further from the left in each frame: what is in front, the middle of
  // the picture, goes to the patient's right, and back to where it was before.
  const std::size_t middle = 20 * 48 + 24;
  EXPECT_LT(channel_of(path, "forward.u")[middle], -0.5f);
  EXPECT_GT(channel_of(path, "backward.u")[middle], 0.5f);
  // The picture grows: what lies above its middle goes up, what lies below goes down.
  const std::vector<float> up = channel_of(path, "forward.v"), alpha = channel_of(path, "A");
  const std::vector<float> down = channel_of(path, "backward.v");
  const std::size_t above = 14 * 48 + 24, below = 26 * 48 + 24;
  ASSERT_TRUE(alpha[above] > 0.5f && alpha[below] > 0.5f);
  EXPECT_TRUE(up[above] > 0 && up[below] < 0) << up[above] << " " << up[below];
  EXPECT_TRUE(down[above] < 0 && down[below] > 0);
  int of_mesh = 0;
  const std::vector<float> ids = channel_of(path, "id");
  for (const float id : ids) {
    EXPECT_TRUE(id == 0 || id == 65536) << id;
    of_mesh += id == 65536;
  }
  EXPECT_GT(of_mesh, 2);
  EXPECT_EQ(ids[middle], 0);
}

TEST_F(InteropFilm, OpenImageIoReadsTheSameMotionAndNumbers) {
  if (!runs("command -v oiiotool && command -v exrheader")) {
    GTEST_SKIP() << "openexr and openimageio-tools are not installed";
  }
  const std::string path = film_exr();
  const std::string header = run_program({"/usr/bin/exrheader", path}).out;
  for (const char* channel :
       {"forward.u, 32-bit floating-point", "backward.v, 32-bit", "id, 32-"}) {
    EXPECT_NE(header.find(channel), std::string::npos) << header;
  }
  const std::string list = "channel list: ";
  const std::string info = run_program({"/usr/bin/oiiotool", "--info", "-v", path}).out;
  const std::size_t at = info.find(list);
  ASSERT_NE(at, std::string::npos) << info;
  std::istringstream named(info.substr(at + list.size(), info.find('\n', at) - at - list.size()));
  std::vector<std::string> names;
  for (std::string name; named >> name;) names.push_back(name.substr(0, name.find(',')));
  const Outcome dump = run_program({"/usr/bin/oiiotool", "--dumpdata", path});
  ASSERT_EQ(dump.exit_code, 0) << dump.err;
  std::vector<std::vector<float>> pixels;
  std::istringstream lines(dump.out);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t end = line.find("): ");
    if (end == std::string::npos) continue;
    std::istringstream words(line.substr(end + 3));
    std::vector<float>& pixel = pixels.emplace_back();
    for (std::string word; words >> word;) pixel.push_back(std::stof(word));
  }
  for (const char* name : {"forward.u", "forward.v", "backward.u", "backward.v", "id", "Z"}) {
    const auto column = std::find(names.begin(), names.end(), name) - names.begin();
    std::vector<float> values;
    for (const std::vector<float>& pixel : pixels) {
      ASSERT_LT(std::size_t(column), pixel.size()) << name;
      values.push_back(pixel[std::size_t(column)]);
    }
    const std::vector<float> expected = channel_of(path, name);
    ASSERT_EQ(values.size(), expected.size()) << name << dump.out.substr(0, 300);
    for (std::size_t n = 0; n < values.size(); ++n) {
      if (!std::isfinite(expected[n])) continue;
      EXPECT_NEAR(values[n], expected[n], 1e-5 * (1 + std::abs(expected[n]))) << name << " " << n;
    }
  }
}
