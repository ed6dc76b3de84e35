// `supple fit`: warps through landmarks on the command line, judged by scipy.
#include <cmath>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"
#include "volumes/io/volume_writer.h"
#include "volumes/io/warp_file.h"

using namespace supple;
using namespace supple::test;

namespace {

using Json = nlohmann::json;

const Geometry kFitGrid({14, 12, 10}, {5, -3, 2}, {Vec3d(0, 1.5, 0), {-2, 0, 0}, {0, 0, 2.5}});

/// Pairs of points on the grid, the second a wave away from the first; a label in one half.
class Fitted : public testing::Test {
 protected:
  void SetUp() override {
    std::ostringstream from, to, both;
    from << "x,y,z\n";
    to << "x,y,z\n";
    both << "x,y,z,dx,dy,dz\n";
    for (std::ostringstream* file : {&from, &to, &both}) file->precision(17);
    for (int n = 0; n < 16; ++n) {
      const Vec3d a = kFitGrid.world_from_index(
          {double(n * 5 % 13), double(n * 7 % 11), double(n * 3 % 9) + 0.5});
      const Vec3d by(std::sin(a.y / 4), 0.5 * std::cos(a.z / 5), std::sin(a.x / 3));
      const Vec3d b = a + by;
      from << a.x << "," << a.y << "," << a.z << "\n";
      to << b.x << "," << b.y << "," << b.z << "\n";
      both << a.x << "," << a.y << "," << a.z << "," << by.x << "," << by.y << "," << by.z << "\n";
    }
    write_text(path("from.csv"), from.str());
    write_text(path("to.csv"), to.str());
    write_text(path("both.csv"), both.str());
    write_volume(path("grid.nrrd"), kFitGrid, ValueType::uint8, [](int, float* out) {
      for (int n = 0; n < 14 * 12; ++n) out[n] = n % 14 < 5 ? 3.0f : 0.0f;
    });
  }
  std::string path(const std::string& name) const { return m_folder / name; }
  std::vector<std::string> fit(const std::vector<std::string>& more) const {
    std::vector<std::string> all{"fit", "--grid", path("grid.nrrd")};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  Json json_of(std::vector<std::string> arguments) const {
    arguments.push_back("--json");
    const Outcome outcome = run_supple(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return Json::parse(outcome.out, nullptr, false);
  }
  void expect_refused(const std::vector<std::string>& more, int code,
                      const std::string& part) const {
    const Outcome outcome = run_supple(fit(more));
    EXPECT_EQ(outcome.exit_code, code) << outcome.err;
    EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  }

  TemporaryFolder m_folder;
};

using UnitFit = Fitted;
using FaultFit = Fitted;
using InteropFit = Fitted;

}  // namespace

TEST_F(UnitFit, PointsGoWhereTheirPartnersAre) {
  for (const std::string direction : {"resample", "material"}) {
    const std::string warp = path(direction + ".nrrd"), moved = path(direction + ".csv");
    const Json report = json_of(
        fit({"--points", path("from.csv"), path("to.csv"), "--direction", direction, "-o", warp}));
    EXPECT_LT(report["misfit_max_mm"], 1e-9);
    EXPECT_EQ(report["folded_cells"], 0);
    EXPECT_EQ(read_warp(warp).direction,
              direction == "resample" ? WarpDirection::resample : WarpDirection::material);
    ASSERT_EQ(run_supple({"apply", warp, "--points", path("from.csv"), "-o", moved}).exit_code, 0);
    const Json apart = json_of({"compare", moved, path("to.csv")})["points"];
    EXPECT_LT(apart["max_mm"], 0.3) << "linear between grid points of 2.5 mm";
  }
  json_of(fit({"--points", path("both.csv"), "-o", path("one.nrrd")}));
  EXPECT_EQ(read_text(path("one.nrrd")).substr(400), read_text(path("resample.nrrd")).substr(400));
}

TEST_F(UnitFit, RigidLabelsAreRigid) {
  const Json report =
      json_of(fit({"--points", path("from.csv"), path("to.csv"), "--direction", "material",
                   "--labels", path("grid.nrrd"), "--rigid", "3", "-o", path("rigid.nrrd")}));
  EXPECT_GT(report["misfit_max_mm"], 0.1) << "no rigid motion meets these";
  const Json metrics =
      json_of({"metrics", path("rigid.nrrd"), "--labels", path("grid.nrrd")})["labels"];
  EXPECT_LT(std::abs(double(metrics["3"]["volume_change_percent"])), 1.5) << "its border stretches";
  const Warp warp = read_warp(path("rigid.nrrd"));
  const auto place = [&](int i, int j, int k) {
    return kFitGrid.world_from_index(Vec3d(i, j, k)) +
           Vec3d(warp.vectors[(std::size_t(k) * 12 + std::size_t(j)) * 14 + std::size_t(i)]);
  };
  for (int n = 0; n < 40; ++n) {
    const Vec3i a(n % 5, n * 3 % 12, n % 10), b(n * 2 % 5, n * 5 % 12, n * 7 % 10);
    const double length = kFitGrid.world_vector_from_index(Vec3d(a - b)).length();
    EXPECT_NEAR((place(a.x, a.y, a.z) - place(b.x, b.y, b.z)).length(), length, 1e-5);
  }
}

TEST_F(UnitFit, NoFoldsRaisesStiffness) {
  write_text(
      path("crossed.csv"),
      "x,y,z,dx,dy,dz\n0,2,10,4,0,0\n2,2,10,-4,0,0\n-6,12,20,0,0,0\n3,1,3,0,0,0\n-9,5,18,0,0,"
      "0\n");
  const Outcome outcome =
      run_supple(fit({"--points", path("crossed.csv"), "-o", path("crossed.nrrd")}));
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_NE(outcome.err.find("folded"), std::string::npos) << outcome.err;
  const Json report =
      json_of(fit({"--points", path("crossed.csv"), "--no-folds", "-o", path("unfolded.nrrd")}));
  EXPECT_EQ(report["folded_cells"], 0);
  EXPECT_GT(report["stiffness_mm"], 0);
  EXPECT_EQ(json_of({"metrics", path("unfolded.nrrd")})["folded_cells"], 0);
  EXPECT_GT(json_of({"metrics", path("crossed.nrrd")})["folded_cells"], 0);
  EXPECT_EQ(json_of({"invert", path("unfolded.nrrd"), "-o",
                     path("back.nrrd")})["certificate"]["folded_cells"],
            0);
}

TEST_F(FaultFit, WrongCommandLinesAndFilesAreOneLine) {
  const std::string from = path("from.csv");
  EXPECT_EQ(run_supple({"fit", "--points", from, from, "-o", path("w.nrrd")}).exit_code, 2);
  expect_refused({"--points", from, "-o", path("w.nrrd")}, 3, "dx, dy, dz");
  write_text(path("three.csv"), "x,y,z\n0,0,0\n1,0,0\n0,1,0\n");
  expect_refused({"--points", from, path("three.csv"), "-o", path("w.nrrd")}, 3,
                 "found 3, expected 16");
  expect_refused({"--points", from, path("absent.csv"), "-o", path("w.nrrd")}, 3, "absent.csv");
  expect_refused({"--points", from, path("to.csv"), "--rigid", "1", "-o", path("w.nrrd")}, 2,
                 "rigid and labels");
  expect_refused({"--points", from, path("to.csv"), "--labels", path("grid.nrrd"), "--rigid", "9",
                  "-o", path("w.nrrd")},
                 3, "label 9");
  expect_refused({"--points", from, path("to.csv"), "-o", path("to.csv")}, 3, "to.csv");
  EXPECT_FALSE(std::filesystem::exists(path("w.nrrd")));
}

TEST_F(InteropFit, ScipyHasTheSameSplines) {
  if (!runs_python("-c 'import scipy, numpy' 2>&1")) GTEST_SKIP() << "scipy is not installed";
  write_text(path("judge.py"), R"(
import sys, numpy as np
from scipy.interpolate import RBFInterpolator
folder, stiffness = sys.argv[1], float(sys.argv[2])
a, b = (np.loadtxt(f"{folder}/{name}.csv", delimiter=",", skiprows=1) for name in ("from", "to"))
spline = RBFInterpolator(a, b - a, kernel="linear", degree=1, smoothing=stiffness)
i, j, k = np.meshgrid(*map(np.arange, (14, 12, 10)), indexing="ij")
at = np.stack([5 - 2.0 * j, -3 + 1.5 * i, 2 + 2.5 * k], -1).transpose(2, 1, 0, 3).reshape(-1, 3)
theirs = spline(at)
ours = np.fromfile(f"{folder}/warp.raw", "<f4").reshape(-1, 3)
worst = np.abs(ours - theirs).max()
sys.exit(int(worst > 1e-6 or np.abs(theirs).max() < 0.5))
)");
  for (const std::string stiffness : {"0", "2.5"}) {
    ASSERT_EQ(
        run_supple(fit({"--points", path("from.csv"), path("to.csv"), "--direction", "material",
                        "--stiffness", stiffness, "-o", path("warp.nhdr"), "--force"}))
            .exit_code,
        0);
    EXPECT_TRUE(runs_python(path("judge.py") + " " + m_folder.path() + " " + stiffness));
  }
}
