// States whose volume is gone, or another by now.
#include <algorithm>
#include <filesystem>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/io_fixtures.h"
#include "tests/support/program.h"

using namespace supple;
using namespace supple::test;

namespace {

namespace fs = std::filesystem;

class LostSource : public testing::Test {
 protected:
  /// A drag at the end of a bar of 16 x 16 x 96 voxels, most of which stays where it is.
  void SetUp() override {
    write_soft_material(m_folder / "soft.toml");
    write_bar("1 1 1.5", 200);
    const Outcome outcome =
        run_supple({"deform", m_folder / "bar.nhdr", "--material", m_folder / "soft.toml", "--grab",
                    "8,8,4", "--by", "0.6,0,0", "--no-relax", "--refer", "-o", m_folder / "d.vdb"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  void write_bar(const std::string& spacings, int density) {
    m_folder.write("bar.nhdr", "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 24 24 96\nspacings: " +
                                   spacings + "\nencoding: raw\ndata file: bar.raw\n");
    std::string values;
    for (int n = 0; n < 24 * 24 * 96; ++n) {
      const int i = n % 24, j = n / 24 % 24;
      values += char(i >= 4 && i < 20 && j >= 4 && j < 20 ? density + i % 3 : 0);
    }
    m_folder.write("bar.raw", values);
  }
  void lose() {
    for (const char* name : {"bar.nhdr", "bar.raw"}) fs::rename(m_folder / name, gone(name));
  }
  void find() {
    for (const char* name : {"bar.nhdr", "bar.raw"}) fs::rename(gone(name), m_folder / name);
  }
  std::string gone(const std::string& name) const { return m_folder / ("gone_" + name); }
  /// The line with which everything that needs densities ends.
  std::string refusal(const std::vector<std::string>& words) {
    const Outcome outcome = run_supple(words);
    EXPECT_EQ(outcome.exit_code, 3) << words.front();
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    return outcome.err;
  }
  /// Text behind the header, whose certificate counts cells.
  std::string values_of(const std::string& name) const {
    const std::string file = read_text(m_folder / name);
    return file.substr(file.find("\n\n"));
  }
  nlohmann::json info() {
    const Outcome outcome = run_supple({"info", m_folder / "d.vdb", "--json"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return nlohmann::json::parse(outcome.out, nullptr, false);
  }

  TemporaryFolder m_folder;
};

using UnitLostSource = LostSource;

TEST_F(UnitLostSource, DensitiesAreRefusedInOneLineAndLeaveNothing) {
  lose();
  const std::string state = m_folder / "d.vdb", out = m_folder / "out.png";
  const std::vector<std::vector<std::string>> commands = {
      {"render", state, "-o", out},
      {"slice", state, "-o", out},
      {"resample", state, "-o", m_folder / "out.nrrd"},
      {"deform", state, "--grab", "8,8,4", "--by", "0,1,0", "-o", m_folder / "out.vdb"},
      {"convert", state, m_folder / "out.vdb"},
      {"probe", state, "--at", "8,8,8"}};
  for (const auto& words : commands) {
    const std::string line = refusal(words);
    EXPECT_NE(line.find("d.vdb: source " + (m_folder / "bar.nhdr") + ": found no such file"),
              std::string::npos)
        << line;
  }
  EXPECT_EQ(m_folder.entries(),
            (std::vector<std::string>{"d.vdb", "gone_bar.nhdr", "gone_bar.raw", "soft.toml"}));
}

TEST_F(UnitLostSource, OffsetsAreExportedAndMeasured) {
  const auto run = [&](const std::string& suffix) {
    std::string all;
    for (const std::string words : {"resample w", "material u"}) {
      const std::string direction = words.substr(0, words.find(' '));
      const std::string name = m_folder / (words.substr(words.find(' ') + 1) + suffix + ".nrrd");
      const Outcome outcome = run_supple({"export", m_folder / "d.vdb", "--void", "nearest",
                                          "--direction", direction, "-o", name});
      EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
      all += outcome.err + read_text(name);
    }
    return all;
  };
  const auto metrics = [&] {
    const Outcome outcome = run_supple({"metrics", m_folder / "d.vdb", "--json"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return nlohmann::json::parse(outcome.out, nullptr, false);
  };
  const auto described = info(), measured = metrics();
  EXPECT_EQ(described["source_is_there"], true);
  EXPECT_EQ(described["source_path"], m_folder / "bar.nhdr");
  run("_there");
  lose();
  const std::string warned = run("_lost");
  EXPECT_NE(warned.find("are read alone, beyond which nothing moved"), std::string::npos);
  for (const std::string name : {"w", "u"}) {
    EXPECT_TRUE(values_of(name + "_lost.nrrd") == values_of(name + "_there.nrrd")) << name;
  }
  const Outcome outside =
      run_supple({"export", m_folder / "d.vdb", "--void", "outside", "-o", m_folder / "o.nrrd"});
  EXPECT_EQ(outside.exit_code, 3);
  EXPECT_NE(outside.err.find("--void: found a state without the volume"), std::string::npos);
  const auto lost = info(), measured_lost = metrics();
  EXPECT_EQ(lost["source_is_there"], false);
  EXPECT_EQ(lost["source_sha256"], described["source_sha256"]);
  EXPECT_EQ(lost["largest_offset_voxels"], described["largest_offset_voxels"]);
  EXPECT_LT(lost["active_voxels"], described["active_voxels"]);
  EXPECT_EQ(measured_lost["max_mm"], measured["max_mm"]);
  EXPECT_EQ(measured_lost["moved"], measured["moved"]);
  find();
  EXPECT_EQ(info(), described);
}

TEST_F(UnitLostSource, AnotherVolumeInItsPlaceIsRefused) {
  const std::string digest = info()["source_sha256"];
  write_bar("1 1 1.5", 201);
  const std::string line = refusal({"render", m_folder / "d.vdb", "-o", m_folder / "out.png"});
  EXPECT_NE(
      line.find("d.vdb: source " + (m_folder / "bar.nhdr") + ": found densities with SHA-256"),
      std::string::npos)
      << line;
  EXPECT_NE(line.find("expected SHA-256 " + digest.substr(0, 16)), std::string::npos) << line;
  write_bar("1 1 1.6", 200);
  EXPECT_NE(refusal({"render", m_folder / "d.vdb", "-o", m_folder / "out.png"})
                .find("found spacing 1,1,1.6, expected spacing 1,1,1.5"),
            std::string::npos);
  write_bar("1 1 1.5", 200);
  EXPECT_EQ(
      run_supple({"render", m_folder / "d.vdb", "--size", "32x32", "-o", m_folder / "out.png"})
          .exit_code,
      0);
}

}  // namespace
