// convert, invert and metrics on the command line.
#include <algorithm>
#include <cmath>
#include <filesystem>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"
#include "tests/support/sanitized.h"
#include "volumes/io/volume_writer.h"
#include "volumes/io/warp_file.h"

using namespace supple;
using namespace supple::test;

namespace {

using Json = nlohmann::json;

const Geometry kOblique({21, 18, 15}, {5, -3, 2}, {Vec3d(0, 1.5, 0.3), {-2, 0, 0}, {0, -0.5, 2.5}});

/// Up to 3 mm long.
Vec3d smooth(const Vec3d& x) {
  return {1.5 * std::sin(x.y / 15), 2 * std::cos(x.z / 20), std::sin((x.x + x.y) / 18)};
}

class Files : public testing::Test {
 protected:
  Json info(const std::string& name) const {
    const Outcome outcome = run_supple({"info", "--json", m_folder / name});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return Json::parse(outcome.out, nullptr, false);
  }
  Outcome run(const std::string& command, const std::string& from, const std::string& to,
              const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments = {command, m_folder / from};
    if (command != "convert") arguments.push_back("-o");
    arguments.push_back(m_folder / to);
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_supple(arguments);
  }
  void expect_done(const std::string& command, const std::string& from, const std::string& to,
                   const std::vector<std::string>& more = {}) const {
    const Outcome outcome = run(command, from, to, more);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  void write_ramp(const std::string& name, ValueType type) const {
    write_volume(m_folder / name, kOblique, type, [](int k, float* out) {
      for (int n = 0; n < 21 * 18; ++n) out[n] = float(n * 7 % 1000 - 300 + k);
    });
  }
  void write_smooth_warp(const std::string& name) const {
    write_warp(m_folder / name, {kOblique, WarpDirection::resample}, [](int k, Vec3f* out) {
      for (int j = 0; j < 18; ++j) {
        for (int i = 0; i < 21; ++i) {
          *out++ = Vec3f(smooth(kOblique.world_from_index(Vec3d(i, j, k))));
        }
      }
    });
  }

  const TemporaryFolder m_folder;
};

class UnitConvert : public Files {};
class UnitInvert : public Files {};
class UnitMetrics : public Files {};
class FaultConvert : public Files {};

}  // namespace

TEST_F(UnitConvert, EveryFormatKeepsValuesAndTypeAndMostTheGeometry) {
  write_ramp("a.nrrd", ValueType::int16);
  const Json source = info("a.nrrd");
  for (const char* name :
       {"b.nhdr", "b.mha", "c.mhd", "b.nii", "b.nii.gz", "b.tif", "b.h5", "b.vdb", "b.vti"}) {
    expect_done("convert", "a.nrrd", name);
    const Json copy = info(name);
    EXPECT_EQ(copy["sha256"], source["sha256"]) << name;
    EXPECT_EQ(copy["type"], "int16") << name;
    EXPECT_EQ(copy["dims"], source["dims"]) << name;
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 4; ++column) {
        EXPECT_NEAR(copy["affine_lps"][row][column].get<double>(),
                    source["affine_lps"][row][column].get<double>(), 1e-5)
            << name;
      }
    }
  }
}

TEST_F(UnitConvert, CompressionChangesTheBytesAndNotTheValues) {
  write_ramp("a.nrrd", ValueType::float32);
  for (const char* name : {"b.nrrd", "b.mha", "b.tif", "b.h5"}) {
    expect_done("convert", "a.nrrd", name, {"--compress"});
    EXPECT_EQ(info(name)["sha256"], info("a.nrrd")["sha256"]) << name;
    EXPECT_LT(std::filesystem::file_size(m_folder / name),
              std::filesystem::file_size(m_folder / "a.nrrd"))
        << name;
  }
}

TEST_F(UnitConvert, SlopeAndInterceptAreAppliedWhereTheFormatHasNone) {
  write_text(m_folder / "s.mha",
             "ObjectType = Image\nNDims = 3\nDimSize = 2 2 1\nElementSpacing = 1 1 1\n"
             "ElementToIntensityFunctionSlope = 2\nElementToIntensityFunctionOffset = -1000\n"
             "ElementType = MET_UCHAR\nElementDataFile = LOCAL\n" +
                 std::string("\x0a\x14\x1e\x28", 4));
  expect_done("convert", "s.mha", "s.nrrd");
  const Json applied = info("s.nrrd");
  EXPECT_EQ(applied["type"], "int16");
  EXPECT_EQ(applied["min"], -980);
  EXPECT_EQ(applied["max"], -920);
  expect_done("convert", "s.mha", "s.nii");
  const Json kept = info("s.nii");
  EXPECT_EQ(kept["type"], "uint8");
  EXPECT_EQ(kept["min"], -980);
  EXPECT_EQ(kept["sha256"], info("s.mha")["sha256"]);
}

TEST_F(UnitConvert, WarpsKeepVectorsDirectionAndCertificateThroughEveryFormat) {
  RUN_WHEN_SANITIZED();
  write_smooth_warp("w.nrrd");
  expect_done("invert", "w.nrrd", "a.nrrd", {"--direction", "material"});
  const Json source = info("a.nrrd");
  std::string last = "a.nrrd";
  for (const char* name : {"b.mha", "b.h5", "b.vdb", "b.vti", "b.nii.gz", "b.nrrd"}) {
    expect_done("convert", last, name);
    const Json copy = info(name);
    EXPECT_EQ(copy["direction_of_vectors"], "material") << name;
    EXPECT_EQ(copy["certificate"], source["certificate"]) << name;
    last = name;
  }
  EXPECT_EQ(info("b.nrrd")["sha256"], source["sha256"]);
}

TEST_F(UnitInvert, AWarpAndItsInverseLeadBack) {
  RUN_WHEN_SANITIZED();
  write_smooth_warp("w.nrrd");
  expect_done("invert", "w.nrrd", "i.nrrd");
  const Warp warp = read_warp(m_folder / "w.nrrd"), inverse = read_warp(m_folder / "i.nrrd");
  EXPECT_EQ(inverse.direction, WarpDirection::resample);
  for (int k = 4; k < 11; ++k) {
    for (int j = 4; j < 14; ++j) {
      for (int i = 4; i < 17; ++i) {
        const Vec3d start = kOblique.world_from_index(Vec3d(i, j, k));
        const Vec3d there = start + Vec3d(inverse.vectors[(std::size_t(k) * 18 + j) * 21 + i]);
        EXPECT_LE((there + smooth(there) - start).length(), 0.05);
      }
    }
  }
  const Json certificate = info("i.nrrd")["certificate"];
  EXPECT_LE(certificate["residual_max_voxels"].get<double>(), 1e-3);
  EXPECT_EQ(certificate["folded_cells"], 0);
}

TEST_F(UnitMetrics, ADraggedBallTellsHowFarItMovedPerLabelAndInMaps) {
  RUN_WHEN_SANITIZED();
  write_ball(m_folder, "ball", 24);
  write_soft_material(m_folder / "soft.toml");
  const Outcome drag =
      run_supple({"deform", m_folder / "ball.nhdr", "--material", m_folder / "soft.toml", "--grab",
                  "12,12,4", "--by", "3,0,0", "-o", m_folder / "d.vdb"});
  ASSERT_EQ(drag.exit_code, 0) << drag.err;
  const Outcome outcome =
      run_supple({"metrics", m_folder / "d.vdb", "--json", "--jacobian", m_folder / "j.nrrd",
                  "--displacement", m_folder / "u.nrrd", "--folds", m_folder / "f.nrrd"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Json json = Json::parse(outcome.out);
  EXPECT_NEAR(json["max_mm"].get<double>(), 3, 1e-4);
  EXPECT_GT(json["moved"].get<int>(), 10);
  EXPECT_LT(json["min_jacobian"].get<double>(), 1);
  EXPECT_NEAR(info("u.nrrd")["max"].get<double>(), 3, 1e-4);
  EXPECT_NEAR(info("j.nrrd")["min"].get<double>(), json["min_jacobian"].get<double>(), 1e-6);
  EXPECT_EQ(info("f.nrrd")["max"], json["folded_cells"].get<int>() > 0 ? 1 : 0);
  EXPECT_EQ(json["folded_voxels"], json["folded_cells"]) << "the former name, for one release";
}

TEST_F(FaultConvert, WrongNamesAndExistingOutputsAreToldInOneLine) {
  write_ramp("a.nrrd", ValueType::int16);
  write_text(m_folder / "there.mha", "old");
  const auto expect = [&](const Outcome& outcome, int code, const std::string& part) {
    EXPECT_EQ(outcome.exit_code, code) << outcome.err;
    EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err;
  };
  expect(run("convert", "a.nrrd", "there.mha"), 2, "--force");
  EXPECT_EQ(read_text(m_folder / "there.mha"), "old");
  expect(run("convert", "a.nrrd", "a.xyz"), 3, "extension: found .xyz");
  expect(run("convert", "none.nrrd", "b.nrrd"), 3, "no such file");
  expect(run("convert", "a.nrrd", "a.nrrd", {"--force"}), 3, "a.nrrd");
  expect(run("convert", "a.nrrd", "b.nhdr", {"--compress"}), 3, "compress: found .nhdr");
  expect(run("convert", "a.nrrd", "b.mha", {"--frame", "3"}), 3, "frame: found 3");
  expect(run("invert", "a.nrrd", "b.nrrd"), 3, "three components per voxel");
  expect(run_supple({"metrics", m_folder / "a.nrrd"}), 3, "three components per voxel");
}

TEST_F(FaultConvert, ForceSparesEveryFileThatTheInputIsReadFrom) {
  write_ball(m_folder, "scan", 8);
  const std::string values = read_text(m_folder / "scan.raw");
  std::filesystem::rename(m_folder / "scan.nhdr", m_folder / "be.nhdr");
  write_text(m_folder / "be.mhd",
             "ObjectType = Image\nNDims = 3\nDimSize = 8 8 8\nElementType = MET_UCHAR\n"
             "ElementSpacing = 1 1 1\nElementDataFile = scan.raw\n");
  write_volume(m_folder / "s0.tif", Geometry({8, 8, 1}, {}, {Vec3d(1, 0, 0), {0, 1, 0}, {0, 0, 1}}),
               ValueType::uint8, [](int, float* out) { std::fill(out, out + 64, 7.0f); });
  const std::string slice = read_text(m_folder / "s0.tif");
  const auto expect_refused = [&](const std::string& from, const std::string& to) {
    const Outcome outcome = run("convert", from, to, {"--force"});
    EXPECT_EQ(outcome.exit_code, 3) << from << " " << outcome.err;
    EXPECT_NE(outcome.err.find("the name of an input"), std::string::npos) << outcome.err;
  };
  expect_refused("be.nhdr", "scan.nhdr");
  expect_refused("be.mhd", "scan.mhd");
  expect_refused("s%d.tif", "s0.tif");
  EXPECT_EQ(read_text(m_folder / "scan.raw"), values);
  EXPECT_EQ(read_text(m_folder / "s0.tif"), slice);
  EXPECT_FALSE(std::filesystem::exists(m_folder / "scan.nhdr"));
  // A name that nothing is read from may be replaced.
  write_text(m_folder / "other.raw", "old");
  EXPECT_EQ(run("convert", "be.nhdr", "other.nhdr", {"--force"}).exit_code, 0);
  EXPECT_EQ(read_text(m_folder / "other.raw"), values);
}

TEST_F(FaultConvert, ForceSparesTheStateThatAnOutputComesFrom) {
  RUN_WHEN_SANITIZED();
  write_ball(m_folder, "ball", 16);
  const std::string state = m_folder / "d.vdb";
  ASSERT_EQ(run_supple(
                {"deform", m_folder / "ball.nhdr", "--grab", "8,8,8", "--by", "2,0,0", "-o", state})
                .exit_code,
            0);
  const std::string before = read_text(state);
  for (const char* command : {"resample", "export"}) {
    EXPECT_EQ(run(command, "d.vdb", "d.vdb", {"--force"}).exit_code, 3) << command;
  }
  EXPECT_EQ(read_text(state), before);
}

TEST_F(UnitConvert, FiltersMakeAVolumeFitForAScene) {
  write_ball(m_folder, "ball", 16);
  EXPECT_EQ(run_supple({"crop", m_folder / "ball.nhdr", "--range", "100,255", "--margin", "1", "-o",
                        m_folder / "body.nrrd"})
                .exit_code,
            0);
  EXPECT_EQ(run("resample", "body.nrrd", "cubes.nii.gz", {"--spacing", "1,1,1"}).exit_code, 0);
  EXPECT_EQ(run("smooth", "cubes.nii.gz", "smooth.mha", {"--sigma", "1"}).exit_code, 0);
  EXPECT_EQ(run("threshold", "smooth.mha", "mask.vdb", {"--keep", "100,255", "--mask"}).exit_code,
            0);
  // Voxels 3 to 12 are at 100 or more, and one on every side.
  const Json body = info("body.nrrd"), mask = info("mask.vdb");
  EXPECT_EQ(body["dims"], (Json{12, 12, 12}));
  EXPECT_EQ(body["origin_lps_mm"], (Json{2, 2, 3}));
  EXPECT_EQ(mask["dims"], (Json{12, 12, 18}));
  EXPECT_EQ(mask["spacing_mm"], (Json{1, 1, 1}));
  EXPECT_EQ(mask["origin_lps_mm"], (Json{2, 2, 2.75}));
  // A ball of radius 5.08 around 7.5 is at 100 or more; smoothing takes a little of it.
  EXPECT_NEAR(mask["active_voxels"].get<double>(), 4.189 * std::pow(5.08, 3) * 1.5, 80);
}

TEST_F(FaultConvert, FiltersNameWhatTheyCannotDo) {
  write_ball(m_folder, "ball", 8);
  const auto expect = [&](const std::vector<std::string>& arguments, int code,
                          const std::string& line) {
    const Outcome outcome = run_supple(arguments);
    EXPECT_EQ(outcome.exit_code, code) << outcome.err;
    EXPECT_NE(outcome.err.find(line), std::string::npos) << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(m_folder / "z.nrrd"));
  };
  const std::string ball = m_folder / "ball.nhdr", out = m_folder / "z.nrrd";
  expect({"crop", ball, "-o", out}, 2, "neither --box nor --range");
  expect({"crop", ball, "--box", "0,0,0:1,1,1", "--range", "1,2", "-o", out}, 2,
         "--box and --range");
  expect({"crop", ball, "--box", "0,0,0:1,1,1", "--margin", "2", "-o", out}, 2, "--margin beside");
  expect({"crop", ball, "--box", "0,0,0:8,1,1", "-o", out}, 3, "expected a box within 0,0,0:7,7,7");
  expect({"smooth", ball, "--sigma", "-1", "-o", out}, 3, "--sigma: found -1");
  expect({"threshold", ball, "--keep", "1,2", "-o", m_folder / "z.txt"}, 3, "z.txt");
  expect({"resample", ball, "-o", out}, 2, "expected --spacing or --grid, or a state");
  expect({"resample", ball, "--spacing", "1,1,1", "--margin", "2", "-o", out}, 2,
         "--spacing beside --grid or --margin");
  expect({"resample", ball, "--margin", "2", "--interpolation", "cubic", "-o", out}, 3,
         "interpolation: found cubic on another grid");
}
