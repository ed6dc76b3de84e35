// Operations on scanned volumes, by the program: films, events and sizes.
#include <filesystem>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "raycast/pictures/image.h"
#include "tests/support/program.h"

using namespace supple;
using namespace supple::test;

namespace {

/// A bone of 8 · 8 · 3 voxels in layers of soft tissue of 16 · 16 · 12, and a needle that is
/// pressed onto it.
class UnitOperatedVolume : public ::testing::Test {
 protected:
  UnitOperatedVolume() {
    std::string voxels;
    for (int n = 0; n < 16 * 16 * 12; ++n) {
      const int i = n % 16, j = n / 16 % 16, k = n / 256;
      const bool is_bone = i >= 4 && i < 12 && j >= 4 && j < 12 && k >= 3 && k < 6;
      voxels += char(static_cast<unsigned char>(n == 0 ? 0 : is_bone ? 200 : 40 + 40 * (i % 3)));
    }
    write_text(m_folder / "bone.raw", voxels);
    write_text(m_folder / "bone.nhdr",
               "NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\n"
               "sizes: 16 16 12\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n"
               "space origin: (0,0,0)\nencoding: raw\ndata file: bone.raw\n");
    write_text(m_folder / "scene.toml",
               "[operation]\nstep = 0.1\nframes_per_second = 5\n[volume]\npath = \"bone.nhdr\"\n"
               "[material]\ndomain = [0, 255]\nactive = [1, 255]\nmax_length = [[0, 1.5]]\n"
               "min_length = [[0, 0.6]]\nshear = [[0, 0.28]]\nrigid = [180, 255]\n"
               "[[step]]\nfix = [[8, 8, 4]]\n"
               "[[instrument]]\nname = \"probe\"\nkind = \"parts\"\n"
               "parts = [{ a = [0, 0, 2], b = [0, 0, 30], radii = [2, 2] }]\nway = [\n"
               "{ time = 0, tip = [8, 8, 16], axis = [0, 0, 1] },\n"
               "{ time = 1, tip = [8, 8, 2], axis = [0, 0, 1] },\n]\n"
               "[[view]]\nimage = \"seen_%03d.png\"\nsize = [40, 30]\n"
               "[output]\nlog = \"log.jsonl\"\n");
  }

  TemporaryFolder m_folder;
};

}  // namespace

TEST_F(UnitOperatedVolume, ARunFilmsTheVolumeAndTellsWhereBoneStopsTheTool) {
  const std::string out = m_folder / "out";
  const Outcome outcome = run_supple({"run", m_folder / "scene.toml", "-o", out, "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json.at("elements"), 16 * 16 * 12 - 1);
  EXPECT_EQ(json.at("steps"), 10);
  EXPECT_TRUE(json.at("times").contains("volume"));
  for (const char* name : {"seen_000.png", "seen_004.png", "log.jsonl"}) {
    EXPECT_TRUE(std::filesystem::exists(out + "/" + name)) << name;
  }
  EXPECT_FALSE(std::filesystem::exists(out + "/seen_005.png"));
  const std::string log = read_text(out + "/log.jsonl");
  EXPECT_NE(log.find("\"bone\""), std::string::npos) << log.substr(0, 400);
}

TEST_F(UnitOperatedVolume, AReplayEndsInTheStateOfARun) {
  const auto digest_of = [&](const std::vector<std::string>& arguments) {
    const Outcome outcome = run_supple(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return nlohmann::json::parse(outcome.out).at("digest").get<std::string>();
  };
  const std::string scene = m_folder / "scene.toml";
  EXPECT_EQ(digest_of({"run", scene, "-o", m_folder / "out", "--json"}),
            digest_of({"replay", scene, "--json"}));
}

TEST_F(UnitOperatedVolume, AReplayDrawsEachFrameAsARunDoesAndKeepsNoneButTheLast) {
  const std::string scene = m_folder / "scene.toml", end = m_folder / "end.png";
  ASSERT_EQ(run_supple({"run", scene, "-o", m_folder / "out"}).exit_code, 0);
  const Outcome outcome = run_supple({"replay", scene, "--image", end, "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_GT(json.at("pictures_per_s"), 0);
  EXPECT_EQ(json.at("outputs").size(), 1u);
  const Image run = read_png(m_folder / "out/seen_004.png"), replayed = read_png(end);
  EXPECT_EQ(replayed.width, 40);
  EXPECT_EQ(replayed.rgba, run.rgba);
  const Outcome nowhere = run_supple({"replay", scene, "--image", m_folder / "none/end.png"});
  EXPECT_EQ(nowhere.exit_code, 3);
  EXPECT_NE(nowhere.err.find("found no such folder"), std::string::npos) << nowhere.err;
  EXPECT_FALSE(std::filesystem::exists(m_folder / "none"));
  const Outcome wide = run_supple({"replay", scene, "--image", end, "--size", "60,40", "--force"});
  ASSERT_EQ(wide.exit_code, 0) << wide.err;
  EXPECT_EQ(read_png(end).width, 60);
  EXPECT_FALSE(std::filesystem::exists("seen_000.png"));
}
