// Films: frames that depend on the scene and their time alone, and go on after an interruption.
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <gtest/gtest.h>

#include "tests/support/program.h"

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

}  // namespace

TEST_F(PropertyFilm, AFilmThatWasKilledGoesOnWithTheSameBytes) {
  write_film();
  const Outcome whole = run("whole");
  ASSERT_EQ(whole.exit_code, 0) << whole.err;
  ASSERT_EQ(run("part", {"--frames", "0:2"}).exit_code, 0);
  // As a process leaves it that was killed in frame 2 and had gone on elsewhere.
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
  for (const double seconds : {0.1, 0.25}) {
    RunOptions options;
    options.interrupt_after_s = seconds;
    options.interrupt_by = SIGKILL;
    run_supple({"run", m_folder / "film.toml", "-o", m_folder / "killed", "--force"}, options);
    ASSERT_EQ(run("killed", {"--resume"}).exit_code, 0);
    for (int frame = 0; frame < 6; ++frame) expect_same("whole", "killed", frame);
    std::filesystem::remove_all(m_folder / "killed");
  }
}

TEST_F(PropertyFilm, AFrameIsTheSceneWithTheHandleAtItsPose) {
  write_film();
  ASSERT_EQ(run("film", {"--frames", "3", "--threads", "1"}).exit_code, 0);
  write_scene("still.toml",
              "[[step]]\nfix = [[0, 0, 0, 3, 23, 23]]\n[[step]]\ngrab = [14, 12, 12]\n"
              "by = [3, 0, 0]\n[output]\nstate = \"s_03.vdb\"\n");
  ASSERT_EQ(run_supple({"run", m_folder / "still.toml", "-o", m_folder / "still"}).exit_code, 0);
  EXPECT_EQ(read_text(m_folder / "film/s_03.vdb"), read_text(m_folder / "still/s_03.vdb"));
  EXPECT_FALSE(std::filesystem::exists(m_folder / "film/s_02.vdb"));
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
  write_text(m_folder / "probe.obj", "v 0 -9 0\nv 5 -9 0\nv 0 -9 5\nf 1 2 3\n");
  write_film(
      "[[view]]\nimage = \"m_%02d.exr\"\nsize = [48, 40]\naux = [\"motion\", \"id\"]\n"
      "mesh = [{ path = \"probe.obj\" }]\n");
  const Outcome outcome = run("out", {"--frames", "2"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Imf::InputFile file((m_folder / "out/m_02.exr").c_str());
  for (const char* name : {"forward.u", "forward.v", "backward.u", "backward.v", "id", "Z"}) {
    EXPECT_NE(file.header().channels().findChannel(name), nullptr) << name;
  }
}
