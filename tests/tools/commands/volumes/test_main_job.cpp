// The way through the house, from file to picture and warp, as the program offers it.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"
#include "tests/support/sanitized.h"
#include "volumes/io/volume_writer.h"
#include "volumes/io/warp_file.h"

using namespace supple;
using namespace supple::test;

namespace {

class PropertyMainJob : public ::testing::Test {
 protected:
  void SetUp() override {
    write_ball(m_folder, "ball", 24);
    write_soft_material(m_folder / "soft.toml");
  }

  Outcome deform(const std::string& input, const std::string& by, const std::string& output,
                 const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments = {
        "deform", m_folder / input,  "--grab", "12,12,12", "--by", by,
        "-o",     m_folder / output, "--json"};
    if (input == "ball.nhdr")
      arguments.insert(arguments.end(), {"--material", m_folder / "soft.toml"});
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = run_supple(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome;
  }

  void render(const std::string& input, const std::string& output,
              const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments = {"render",     m_folder / input, "--preset",
                                          "MR-Default", "--size",         "120,100",
                                          "-o",         m_folder / output};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = run_supple(arguments);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }

  int compare_equal(const std::string& a, const std::string& b) {
    return run_supple({"compare", m_folder / a, m_folder / b, "--max-diff", "0", "--quiet"})
        .exit_code;
  }

  TemporaryFolder m_folder;
};

}  // namespace

TEST_F(PropertyMainJob, AZeroDisplacementRendersTheUndeformedPictureBitForBit) {
  deform("ball.nhdr", "0,0,0", "zero.vdb");
  render("zero.vdb", "zero.png");
  render("zero.vdb", "rest.png", {"--undeformed"});
  render("ball.nhdr", "volume.png");
  EXPECT_EQ(compare_equal("zero.png", "rest.png"), 0);
  EXPECT_EQ(compare_equal("zero.png", "volume.png"), 0);
  deform("ball.nhdr", "4,0,0", "moved.vdb");
  render("moved.vdb", "moved.png");
  EXPECT_EQ(compare_equal("zero.png", "moved.png"), 1);
}

TEST_F(PropertyMainJob, StateAndPictureDoNotDependOnTheNumberOfThreads) {
  for (const char* threads : {"1", "2", "5"}) {
    deform("ball.nhdr", "6,3,-2", std::string("t") + threads + ".vdb", {"--threads", threads});
    render(std::string("t") + threads + ".vdb", std::string("t") + threads + ".png",
           {"--threads", threads});
  }
  EXPECT_EQ(read_text(m_folder / "t1.vdb"), read_text(m_folder / "t2.vdb"));
  EXPECT_EQ(read_text(m_folder / "t1.vdb"), read_text(m_folder / "t5.vdb"));
  EXPECT_EQ(read_text(m_folder / "t1.png"), read_text(m_folder / "t2.png"));
  EXPECT_EQ(read_text(m_folder / "t1.png"), read_text(m_folder / "t5.png"));
}

TEST_F(PropertyMainJob, AsManyThreadsWorkAsWereAskedForOnFewerCoresToo) {
  RunOptions counted;
  counted.count_threads = true;
  const Outcome outcome = run_supple({"render", m_folder / "ball.nhdr", "-o", m_folder / "ball.png",
                                      "--size", "1000,1000", "--threads", "24"},
                                     counted);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_GE(outcome.threads, 24);  // those of libraries are counted, too
}

TEST_F(PropertyMainJob, AContinuedStateGoesOnFromWhereItWas) {
  RUN_WHEN_SANITIZED();
  deform("ball.nhdr", "6,0,0", "one.vdb");
  deform("one.vdb", "-6,0,0", "back.vdb");
  const Outcome info = run_supple({"info", "--json", m_folder / "back.vdb"});
  const auto json = nlohmann::json::parse(info.out);
  EXPECT_EQ(json["configuration"]["steps"].size(), 2u);
  EXPECT_GT(json["largest_offset_voxels"], 0.0);  // neighbours keep what slack allows
}

TEST_F(PropertyMainJob, AnAnchorStopsTheDragAndTheFractionIsReported) {
  RUN_WHEN_SANITIZED();
  const Outcome outcome = deform("ball.nhdr", "40,0,0", "stopped.vdb", {"--fix", "8,8,8:8,16,16"});
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_GT(json["fraction"], 0.0);
  EXPECT_LT(json["fraction"], 1.0);
  EXPECT_NE(outcome.err.find("anchors stopped the drag"), std::string::npos) << outcome.err;
}

TEST_F(PropertyMainJob, AResampledRestStateIsTheSourceVolume) {
  deform("ball.nhdr", "0,0,0", "zero.vdb");
  ASSERT_EQ(run_supple({"resample", m_folder / "zero.vdb", "-o", m_folder / "same.nrrd"}).exit_code,
            0);
  const auto source =
      nlohmann::json::parse(run_supple({"info", "--json", m_folder / "ball.nhdr"}).out);
  const auto same =
      nlohmann::json::parse(run_supple({"info", "--json", m_folder / "same.nrrd"}).out);
  for (const char* key : {"sha256", "type", "dims", "affine_lps", "min", "max"}) {
    EXPECT_EQ(source[key], same[key]) << key;
  }
}

TEST_F(PropertyMainJob, AMarginKeepsMaterialThatLeavesTheSourceBox) {
  deform("ball.nhdr", "15,0,0", "out.vdb");
  const Outcome tight = run_supple({"export", m_folder / "out.vdb", "-o", m_folder / "tight.nrrd"});
  EXPECT_EQ(tight.exit_code, 0);
  EXPECT_NE(tight.err.find("outside the grid"), std::string::npos) << tight.err;
  const Outcome wide =
      run_supple({"export", m_folder / "out.vdb", "--margin", "20", "-o", m_folder / "wide.nrrd"});
  EXPECT_EQ(wide.exit_code, 0);
  EXPECT_EQ(wide.err.find("outside the grid"), std::string::npos) << wide.err;
}

TEST_F(PropertyMainJob, AVolumeThroughItsExportedWarpIsThePictureOfTheState) {
  deform("ball.nhdr", "5,2,-3", "moved.vdb");
  render("moved.vdb", "state.png");
  const auto ssim_through = [&](const std::string& warp) {
    render("ball.nhdr", warp + ".png", {"--offsets", m_folder / warp});
    const Outcome outcome =
        run_supple({"compare", m_folder / "state.png", m_folder / (warp + ".png"), "--mask",
                    "foreground", "--json"});
    const double ssim = nlohmann::json::parse(outcome.out)["ssim"];
    RecordProperty(warp, std::to_string(ssim));
    return ssim;
  };
  const auto write = [&](const std::string& warp, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"export", m_folder / "moved.vdb", "-o", m_folder / warp};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = run_supple(arguments);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  };
  write("warp.nrrd", {"--void", "outside"});
  write("warp.mha", {"--void", "outside"});
  write("wide.nrrd", {"--void", "outside", "--margin", "5"});
  for (const char* warp : {"warp.nrrd", "warp.mha", "wide.nrrd"}) {
    EXPECT_GE(ssim_through(warp), 0.99) << warp;
  }

  // The bar tells a warp from none and from its mirror image.
  const Warp warp = read_warp(m_folder / "warp.nrrd");
  for (const float factor : {0.0f, -1.0f}) {
    const std::string name = factor == 0 ? "zero.nrrd" : "mirrored.nrrd";
    const Vec3i& dims = warp.geometry.dims();
    const auto slices = [&](int k, Vec3f* out) {
      const std::size_t count = std::size_t(dims.x) * dims.y;
      for (std::size_t n = 0; n < count; ++n) out[n] = warp.vectors[k * count + n] * factor;
    };
    write_warp(m_folder / name, {warp.geometry, WarpDirection::resample}, slices);
    EXPECT_LT(ssim_through(name), 0.95) << name;
  }
}

TEST_F(PropertyMainJob, ScaledVolumesAreResampledInFloat) {
  write_text(m_folder / "scaled.mhd",
             "ObjectType = Image\nNDims = 3\nDimSize = 24 24 24\nElementType = MET_UCHAR\n"
             "ElementSpacing = 1 1 1.5\nElementToIntensityFunctionSlope = 0.5\n"
             "ElementToIntensityFunctionOffset = -50\nElementDataFile = ball.raw\n");
  ASSERT_EQ(run_supple({"deform", m_folder / "scaled.mhd", "--grab", "12,12,12", "--by", "0,0,0",
                        "--quiet", "-o", m_folder / "zero.vdb"})
                .exit_code,
            0);
  ASSERT_EQ(run_supple({"resample", m_folder / "zero.vdb", "-o", m_folder / "same.nrrd"}).exit_code,
            0);
  const auto json =
      nlohmann::json::parse(run_supple({"info", "--json", m_folder / "same.nrrd"}).out);
  EXPECT_EQ(json["type"], "float32");
  EXPECT_EQ(json["min"], -50.0);
  EXPECT_EQ(json["max"], 50.0);
}

TEST_F(PropertyMainJob, ExportAndResampleReportAsJson) {
  RUN_WHEN_SANITIZED();
  deform("ball.nhdr", "15,0,0", "out.vdb");
  for (const char* command : {"export", "resample"}) {
    const Outcome outcome = run_supple({command, m_folder / "out.vdb", "--json", "-o",
                                        m_folder / (std::string(command) + ".nrrd")});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const auto json = nlohmann::json::parse(outcome.out);
    EXPECT_GT(json["lost_voxels"], 0) << command;
    EXPECT_EQ(json["dims"], nlohmann::json({24, 24, 24}));
  }
}
