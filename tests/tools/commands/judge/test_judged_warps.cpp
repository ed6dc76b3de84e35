// metrics and compare of warps, label volumes and points on the command line.
#include <cmath>
#include <filesystem>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"
#include "volumes/io/volume_writer.h"

using namespace supple;
using namespace supple::test;

namespace {

using Json = nlohmann::json;

const Geometry kJudgedGrid({16, 15, 14}, {5, -3, 2}, {Vec3d(0, 1.5, 0), {-2, 0, 0}, {0, 0, 2.5}});

/// det F = 1.1 * 0.8 * 1 - 0.2 * 0 = 0.88.
Vec3d judged_affine(const Vec3d& x) {
  return {0.1 * x.x + 0.2 * x.y, -0.2 * x.y + 1, 0.5};
}

class JudgedWarps : public testing::Test {
 protected:
  void write(const std::string& name, const std::function<Vec3d(const Vec3d&)>& vector,
             WarpDirection direction = WarpDirection::resample) const {
    write_warp(m_folder / name, {kJudgedGrid, direction}, [&](int k, Vec3f* out) {
      for (int j = 0; j < 15; ++j) {
        for (int i = 0; i < 16; ++i)
          *out++ = Vec3f(vector(kJudgedGrid.world_from_index(Vec3d(i, j, k))));
      }
    });
  }
  /// 1 in the lower half, 2 in a part of the upper one.
  void write_labels(const std::string& name) const {
    write_volume(m_folder / name, kJudgedGrid, ValueType::uint8, [](int k, float* out) {
      for (int n = 0; n < 16 * 15; ++n) out[n] = k < 7 ? 1.0f : n % 16 > 9 ? 2.0f : 0.0f;
    });
  }
  Json json_of(std::vector<std::string> arguments) const {
    arguments.push_back("--json");
    const Outcome outcome = run_supple(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return Json::parse(outcome.out, nullptr, false);
  }
  void expect_refused(const std::vector<std::string>& arguments, int code,
                      const std::string& part) const {
    const Outcome outcome = run_supple(arguments);
    EXPECT_EQ(outcome.exit_code, code) << outcome.err;
    EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  }

  TemporaryFolder m_folder;
};

using UnitJudgedWarps = JudgedWarps;
using FaultJudgedWarps = JudgedWarps;

}  // namespace

TEST_F(UnitJudgedWarps, AnAffineWarpHasItsDeterminantAndNoBendingInEveryFormat) {
  for (const char* name : {"w.nrrd", "w.mha", "w.nii.gz", "w.h5", "w.vdb"}) {
    write(name, judged_affine);
    const Json json = json_of({"metrics", m_folder / name});
    EXPECT_EQ(json["elements"], 16 * 15 * 14) << name;
    EXPECT_NEAR(json["min_jacobian"].get<double>(), 0.88, 1e-5) << name;
    EXPECT_NEAR(json["max_jacobian"].get<double>(), 0.88, 1e-5) << name;
    EXPECT_LT(json["sd_log_jacobian"].get<double>(), 1e-5) << name;
    EXPECT_LT(json["bending_per_mm2"].get<double>(), 1e-11) << name;
    EXPECT_EQ(json["folded_cells"], 0) << name;
    EXPECT_EQ(json["direction"], "resample") << name;
  }
}

TEST_F(UnitJudgedWarps, ATransformIsMeasuredOnTheGridThatIsNamed) {
  write_text(m_folder / "a.tfm",
             "#Insight Transform File V1.0\n#Transform 0\nTransform: AffineTransform_double_3_3\n"
             "Parameters: 1.1 0.2 0 0 0.8 0 0 0 1 0 1 0.5\nFixedParameters: 0 0 0\n");
  write("w.nrrd", judged_affine);
  write_labels("grid.nrrd");
  expect_refused({"metrics", m_folder / "a.tfm"}, 3, "grid");
  const Json json = json_of({"metrics", m_folder / "a.tfm", "--grid", m_folder / "grid.nrrd"});
  EXPECT_NEAR(json["min_jacobian"].get<double>(), 0.88, 1e-5);
  const Json errors = json_of({"compare", m_folder / "w.nrrd", m_folder / "a.tfm"});
  EXPECT_EQ(errors["endpoint_error"]["voxels"], 16 * 15 * 14);
  EXPECT_LT(errors["endpoint_error"]["max_mm"].get<double>(), 1e-5);
}

TEST_F(UnitJudgedWarps, LabelsMaskAndMapsAreThoseOfTheWarpsGrid) {
  write("w.nrrd", judged_affine);
  write_labels("labels.nrrd");
  const Json json = json_of({"metrics", m_folder / "w.nrrd", "--labels", m_folder / "labels.nrrd",
                             "--mask", m_folder / "labels.nrrd", "--bending", m_folder / "b.nrrd",
                             "--jacobian", m_folder / "j.nrrd"});
  EXPECT_EQ(json["elements"], 16 * 15 * 7 + 6 * 15 * 7);
  EXPECT_EQ(json["labels"]["1"]["elements"], 16 * 15 * 7);
  EXPECT_EQ(json["labels"]["2"]["elements"], 6 * 15 * 7);
  EXPECT_EQ(json["labels"].size(), 2u);
  EXPECT_NEAR(json_of({"info", m_folder / "j.nrrd"})["min"].get<double>(), 0.88, 1e-5);
  EXPECT_LT(json_of({"info", m_folder / "b.nrrd"})["max"].get<double>(), 1e-10);
}

TEST_F(UnitJudgedWarps, TwoWarpsTellEndpointErrorErrorAtPointsAndDice) {
  write("a.nrrd", [](const Vec3d&) { return Vec3d(0); });
  write("b.nrrd", [](const Vec3d&) { return Vec3d(0, 1.5, 2.5); });  // one voxel along i and k
  write_labels("labels.nrrd");
  write_text(m_folder / "p.csv", "x,y,z\n0,5,10\n-4,8,20\n");
  const Json json =
      json_of({"compare", m_folder / "a.nrrd", m_folder / "b.nrrd", "--points", m_folder / "p.csv",
               "--labels", m_folder / "labels.nrrd", "--diff", m_folder / "e.nrrd"});
  const double length = std::hypot(1.5, 2.5);
  for (const char* key : {"mean_mm", "rms_mm", "median_mm", "p95_mm", "max_mm"}) {
    EXPECT_NEAR(json["endpoint_error"][key].get<double>(), length, 1e-6) << key;
    EXPECT_NEAR(json["points"][key].get<double>(), length, 1e-6) << key;
  }
  EXPECT_EQ(json["points"]["points"], 2);
  EXPECT_NEAR(json_of({"info", m_folder / "e.nrrd"})["min"].get<double>(), length, 1e-6);
  // A voxel of B shows the label of the next one along i and k; beyond the volume there is none.
  const auto label = [](int i, int k) { return i > 15 || k > 13 ? 0 : k < 7 ? 1 : i > 9 ? 2 : 0; };
  int in_a[3] = {}, in_b[3] = {}, both[3] = {};
  for (int k = 0; k < 14; ++k) {
    for (int i = 0; i < 16; ++i) {
      const int a = label(i, k), b = label(i + 1, k + 1);
      in_a[a] += 15;
      in_b[b] += 15;
      if (a == b) both[a] += 15;
    }
  }
  for (const int n : {1, 2}) {
    const Json& row = json["dice"]["labels"][std::to_string(n)];
    EXPECT_EQ(row["voxels_a"], in_a[n]) << n;
    EXPECT_EQ(row["voxels_b"], in_b[n]) << n;
    EXPECT_EQ(row["voxels_both"], both[n]) << n;
    EXPECT_NEAR(row["dice"].get<double>(), 2.0 * both[n] / (in_a[n] + in_b[n]), 1e-12) << n;
  }
}

TEST_F(UnitJudgedWarps, DiceIsThatOfTheVolumesThatApplyWrites) {
  for (const auto direction : {WarpDirection::resample, WarpDirection::material}) {
    write(
        "a.nrrd", [](const Vec3d& x) { return Vec3d(0.1 * x.y, 0.4, 2); }, direction);
    write(
        "b.nrrd", [](const Vec3d& x) { return Vec3d(1, 0, 0.2 * x.z); }, direction);
    write_labels("labels.nrrd");
    for (const char* name : {"a", "b"}) {
      ASSERT_EQ(run_supple({"apply", m_folder / (name + std::string(".nrrd")), "--labels",
                            m_folder / "labels.nrrd", "--force", "-o",
                            m_folder / (std::string("moved_") + name + ".nrrd")})
                    .exit_code,
                0);
    }
    const Json by_warps = json_of({"compare", m_folder / "a.nrrd", m_folder / "b.nrrd", "--labels",
                                   m_folder / "labels.nrrd"});
    const Json by_files =
        json_of({"compare", m_folder / "moved_a.nrrd", m_folder / "moved_b.nrrd"});
    EXPECT_EQ(by_warps["dice"], by_files["dice"]);
    EXPECT_LT(by_files["dice"]["mean_dice"].get<double>(), 1);
  }
}

TEST_F(UnitJudgedWarps, PointsOfTwoFilesAreComparedOneByOne) {
  write_text(m_folder / "a.csv", "x,y,z\n0,5,10\n-4,8,20\n1,1,1\n");
  write_text(m_folder / "b.csv", "name,x,y,z\na,0,5,13\nb,-4,12,20\nc,1,1,1\n");
  const Json json = json_of({"compare", m_folder / "a.csv", m_folder / "b.csv"});
  EXPECT_NEAR(json["points"]["mean_mm"].get<double>(), 7.0 / 3, 1e-6);
  EXPECT_NEAR(json["points"]["max_mm"].get<double>(), 4, 1e-6);
  EXPECT_NEAR(json["points"]["median_mm"].get<double>(), 3, 1e-6);
}

TEST_F(FaultJudgedWarps, WhatDoesNotFitTogetherIsToldInOneLine) {
  write("a.nrrd", judged_affine);
  write("m.nrrd", judged_affine, WarpDirection::material);
  write_labels("labels.nrrd");
  write_text(m_folder / "p.csv", "x,y,z\n0,5,10\n");
  write_text(m_folder / "q.csv", "x,y,z\n0,5,10\n1,2,3\n");
  write_volume(m_folder / "none.nrrd", kJudgedGrid, ValueType::uint8,
               [](int, float* out) { std::fill(out, out + 16 * 15, 0.0f); });
  const std::string a = m_folder / "a.nrrd", labels = m_folder / "labels.nrrd";
  expect_refused({"compare", a, m_folder / "m.nrrd"}, 3, "direction: found material");
  expect_refused({"compare", a, labels}, 3, "three components per voxel");
  expect_refused({"compare", labels, a}, 3, "expected a scalar volume");
  expect_refused({"compare", a, a, "--max-rmse", "0.1"}, 2, "--max-rmse: found a warp");
  expect_refused({"compare", labels, labels, "--points", m_folder / "p.csv"}, 2, "--points");
  expect_refused({"compare", m_folder / "p.csv", m_folder / "q.csv"}, 3, "2 points");
  expect_refused({"compare", a, a, "--mask", m_folder / "none.nrrd"}, 3, "none.nrrd");
  expect_refused({"metrics", a, "--mask", m_folder / "none.nrrd"}, 3, "none.nrrd");
  expect_refused({"metrics", labels}, 3, "three components per voxel");
  expect_refused({"compare", a, a, "--diff", a}, 3, "the name of an input");
}
