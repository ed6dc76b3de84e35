// Ways out of refusals, on the command line: frames, grids, names of segments.
#include <filesystem>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/io_fixtures.h"
#include "tests/support/program.h"
#include "volumes/io/volume_writer.h"

using namespace supple;
using namespace supple::test;

namespace {

class WaysOut : public testing::Test {
 protected:
  /// Three frames of 4 x 3 x 2 voxels that hold 1, 2 and 3.
  void write_series() {
    std::string values;
    for (const int frame : {1, 2, 3}) {
      values += bytes_of_values(std::vector<std::int16_t>(24, std::int16_t(frame)));
    }
    m_folder.write("series.nrrd",
                   "NRRD0004\ntype: int16\ndimension: 4\nsizes: 4 3 2 3\nendian: little\n"
                   "encoding: raw\nkinds: domain domain domain time\nspace: LPS\n"
                   "space directions: (1,0,0) (0,1,0) (0,0,1) none\n\n" +
                       values);
  }
  nlohmann::json info(const std::string& name) const {
    const Outcome outcome = run_supple({"info", "--json", m_folder / name});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return nlohmann::json::parse(outcome.out, nullptr, false);
  }

  TemporaryFolder m_folder;
};

using UnitWaysOut = WaysOut;

TEST_F(UnitWaysOut, AFrameThatIsNotThereNamesTheOption) {
  write_series();
  const std::string series = m_folder / "series.nrrd";
  const Outcome beyond = run_supple({"info", series, "--frame", "7"});
  EXPECT_EQ(beyond.exit_code, 3);
  EXPECT_NE(beyond.err.find("--frame: found 7, expected 0 to 2"), std::string::npos) << beyond.err;
  const Outcome none = run_supple({"convert", series, m_folder / "a.nrrd"});
  EXPECT_NE(none.err.find("expected --frame 0 to 2"), std::string::npos) << none.err;
}

TEST_F(UnitWaysOut, AllFramesOfASeriesAreWrittenInOneCall) {
  write_series();
  const std::string series = m_folder / "series.nrrd", names = m_folder / "phase_%02d.nrrd";
  const Outcome outcome = run_supple({"convert", series, names});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  for (int frame = 0; frame < 3; ++frame) {
    const auto json = info("phase_0" + std::to_string(frame) + ".nrrd");
    EXPECT_EQ(json["min"], frame + 1);
    EXPECT_EQ(json["max"], frame + 1);
  }
  EXPECT_EQ(run_supple({"convert", series, names}).exit_code, 2);  // they are there
  const Outcome one = run_supple({"convert", series, m_folder / "50%.nrrd", "--frame", "1"});
  EXPECT_EQ(one.exit_code, 0) << one.err;
  EXPECT_TRUE(std::filesystem::exists(m_folder / "50%.nrrd"));
}

TEST_F(UnitWaysOut, AVolumeIsResampledOnAnotherGrid) {
  write_series();
  const std::string series = m_folder / "series.nrrd", out = m_folder / "out.nrrd";
  const Geometry grid({3, 3, 3}, {1.5, 0.5, 0.5}, {Vec3d(1, 0, 0), {0, 1, 0}, {0, 0, 4}});
  write_volume(m_folder / "grid.nrrd", grid, ValueType::uint8,
               [](int, float* values) { std::fill_n(values, 9, 0.0f); });
  const Outcome outcome =
      run_supple({"resample", series, "--frame", "1", "--grid", m_folder / "grid.nrrd", "-o", out});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto json = info("out.nrrd");
  EXPECT_EQ(json["dims"], (std::vector<int>{3, 3, 3}));
  EXPECT_EQ(json["max"], 2);
  const Outcome both = run_supple({"resample", series, "--frame", "1", "--spacing", "1,1,1",
                                   "--grid", m_folder / "grid.nrrd", "-o", out, "--force"});
  EXPECT_EQ(both.exit_code, 2) << both.err;
}

TEST_F(UnitWaysOut, SegmentsKeepTheirNames) {
  std::vector<std::uint8_t> labels(24, 0);
  labels[5] = labels[6] = 3;
  labels[20] = 7;
  m_folder.write("a.seg.nrrd",
                 "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 4 3 2\nencoding: raw\nspace: LPS\n"
                 "space directions: (1,0,0) (0,1,0) (0,0,1)\nSegment0_Name:=Left ventricle\n"
                 "Segment0_LabelValue:=3\nSegment1_Name:=Aorta\nSegment1_LabelValue:=7\n\n" +
                     bytes_of_values(labels));
  const Geometry grid({4, 3, 2}, {0, 0, 0}, {Vec3d(1, 0, 0), {0, 1, 0}, {0, 0, 1}});
  write_warp(m_folder / "warp.nrrd", {grid, WarpDirection::resample},
             [](int, Vec3f* out) { std::fill_n(out, 12, Vec3f(0, 0, 0)); });
  const Outcome applied = run_supple({"apply", m_folder / "warp.nrrd", "--labels",
                                      m_folder / "a.seg.nrrd", "-o", m_folder / "b.seg.nrrd"});
  EXPECT_EQ(applied.exit_code, 0) << applied.err;
  const Outcome converted =
      run_supple({"convert", m_folder / "a.seg.nrrd", m_folder / "c.seg.nrrd"});
  EXPECT_EQ(converted.exit_code, 0) << converted.err;
  for (const char* name : {"b.seg.nrrd", "c.seg.nrrd"}) {
    const auto segments = info(name)["segments"];
    ASSERT_EQ(segments.size(), 2u) << name;
    EXPECT_EQ(segments[0]["name"], "Left ventricle");
    EXPECT_EQ(segments[0]["label"], 3);
    EXPECT_EQ(segments[1]["name"], "Aorta");
    EXPECT_EQ(segments[1]["label"], 7);
  }
}

}  // namespace
