// `supple straighten`: a torus becomes a cylinder; its warp leads points, labels and the inverse.
#include <cmath>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"
#include "volumes/io/load/load.h"
#include "volumes/io/volume_writer.h"
#include "volumes/io/warp_file.h"

using namespace supple;
using namespace supple::test;

namespace {

using Json = nlohmann::json;

constexpr double kTorusRadius = 25;
const Geometry kTorusGrid({70, 70, 24}, {-34.5, -34.5, -11.5},
                          {Vec3d(1, 0, 0), {0, 1, 0}, {0, 0, 1}});

/// The way from the circle in the plane z = 0: inwards, and up.
std::pair<double, double> from_circle(const Vec3d& at) {
  return {kTorusRadius - std::hypot(at.x, at.y), at.z};
}

/// A density around a circle that falls off on its inner side more slowly than on its outer side.
double density(double inwards, double up) {
  return 1000 * std::exp(-(inwards * inwards + up * up) / 36) * (1 + inwards / 20);
}

/// A torus in torus.nrrd, and three radians of its middle in curve.csv.
class Straightened : public testing::Test {
 protected:
  void SetUp() override {
    std::ostringstream curve;
    curve.precision(17);
    curve << "x,y,z\n";
    for (int n = 0; n <= 36; ++n) {
      const double angle = 3.0 * n / 36 - 1.5;
      curve << kTorusRadius * std::sin(angle) << "," << -kTorusRadius * std::cos(angle) << ",0\n";
    }
    write_text(path("curve.csv"), curve.str());
    write_volume(path("torus.nrrd"), kTorusGrid, ValueType::float32, [](int k, float* out) {
      for (int n = 0; n < 70 * 70; ++n) {
        const auto [inwards, up] =
            from_circle(kTorusGrid.world_from_index(Vec3d(Vec3i(n % 70, n / 70, k))));
        out[n] = float(density(inwards, up));
      }
    });
  }
  std::string path(const std::string& name) const { return m_folder / name; }
  std::vector<std::string> straighten(const std::vector<std::string>& more) const {
    std::vector<std::string> all{"straighten", path("torus.nrrd"), "--along", path("curve.csv")};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  Json json_of(std::vector<std::string> arguments) const {
    arguments.push_back("--json");
    const Outcome outcome = run_supple(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return Json::parse(outcome.out, nullptr, false);
  }

  TemporaryFolder m_folder;
};

using UnitStraighten = Straightened;
using FaultStraighten = Straightened;
using InteropStraighten = Straightened;

}  // namespace

TEST_F(UnitStraighten, ATorusBecomesACylinder) {
  const Json report =
      json_of(straighten({"--radius", "9", "--height", "7", "-o", path("straight.nrrd")}));
  EXPECT_NEAR(double(report["length_mm"]), 3 * kTorusRadius, 1e-3);
  EXPECT_NEAR(double(report["curve_radius_mm"]), kTorusRadius, 0.3);
  EXPECT_EQ(report["folded_cells"], 0);
  EXPECT_NEAR(double(report["smallest_det_f"]), 1 - 9 / kTorusRadius, 0.01);
  const Volume straight = load_volume(path("straight.nrrd"));
  const Vec3i dims = straight.geometry.dims();
  EXPECT_EQ(dims, Vec3i(75, 19, 15));
  double worst = 0;
  for (int n = 0; n < dims.x * dims.y * dims.z; ++n) {
    const Vec3i at(n % dims.x, n / dims.x % dims.y, n / dims.x / dims.y);
    worst = std::max(worst,
                     std::abs(double(straight.density.at(at)) - density(at.y - 9.0, at.z - 7.0)));
  }
  EXPECT_LT(worst, 20) << "linear between voxels of 1 mm: 1000 / 36 / 4 along each axis, twice";
}

TEST_F(UnitStraighten, TheWarpLeadsPointsLabelsAndItsInverse) {
  const std::string warp = path("warp.h5");
  json_of(straighten({"--radius", "9", "--warp", warp, "-o", path("straight.nrrd")}));
  write_text(path("points.csv"), "x,y,z\n-20,-30,2\n3,-24,-5\n31,-27.5,0.25\n");
  ASSERT_EQ(
      run_supple({"apply", warp, "--back", "--points", path("points.csv"), "-o", path("bent.csv")})
          .exit_code,
      0);
  ASSERT_EQ(
      run_supple({"apply", warp, "--points", path("bent.csv"), "-o", path("back.csv")}).exit_code,
      0);
  EXPECT_LT(json_of({"compare", path("back.csv"), path("points.csv")})["points"]["max_mm"], 1e-4);
  EXPECT_GT(json_of({"compare", path("bent.csv"), path("points.csv")})["points"]["max_mm"], 5);

  const Json certificate = json_of({"invert", warp, "--grid", path("torus.nrrd"), "--void",
                                    "outside", "-o", path("bend.nrrd")})["certificate"];
  EXPECT_EQ(certificate["folded_cells"], 0);
  EXPECT_LT(certificate["residual_max_voxels"], 1e-4);

  // A bar of 9 x 9 mm along the box becomes a bent one.
  const Geometry grid = read_warp(warp).geometry;
  write_volume(path("bar.nrrd"), grid, ValueType::uint8, [&](int k, float* out) {
    for (int n = 0; n < grid.dims().x * grid.dims().y; ++n) {
      const int j = n / grid.dims().x;
      out[n] = std::abs(j - 9) <= 4 && std::abs(k - 9) <= 4 ? 1.0f : 0.0f;
    }
  });
  ASSERT_EQ(run_supple({"apply", warp, "--back", "--labels", path("bar.nrrd"), "--grid",
                        path("torus.nrrd"), "-o", path("bent.nrrd")})
                .exit_code,
            0);
  const Volume bent = load_volume(path("bent.nrrd"));
  int inside = 0, wrong = 0;
  for (int n = 0; n < 70 * 70 * 24; ++n) {
    const Vec3i at(n % 70, n / 70 % 70, n / 4900);
    const Vec3d place = kTorusGrid.world_from_index(Vec3d(at));
    if (std::abs(std::atan2(place.x, -place.y)) > 1.4) continue;
    const auto [inwards, up] = from_circle(place);
    const double rim = std::max(std::abs(inwards), std::abs(up)) - 4.5;
    inside += rim < 0;
    wrong += std::abs(rim) > 0.01 && (bent.density.at(at) > 0.5f) != (rim < 0);
  }
  EXPECT_GT(inside, 4000);
  EXPECT_LT(wrong, 0.01 * inside);
}

TEST_F(UnitStraighten, FoldsAreCountedAndAvoided) {
  const Outcome folded =
      run_supple(straighten({"--radius", "32", "--height", "3", "-o", path("folded.nrrd")}));
  EXPECT_EQ(folded.exit_code, 0);
  EXPECT_NE(folded.err.find("a radius below 24.8"), std::string::npos) << folded.err;
  const Json report = json_of(
      straighten({"--radius", "32", "--height", "3", "--no-folds", "-o", path("narrow.nrrd")}));
  EXPECT_EQ(report["folded_cells"], 0);
  EXPECT_NEAR(double(report["radius_mm"]), 0.95 * kTorusRadius, 0.3);
}

TEST_F(FaultStraighten, WrongCommandLinesAndFilesAreOneLine) {
  const auto refused = [&](const std::vector<std::string>& arguments, int code,
                           const std::string& part) {
    const Outcome outcome = run_supple(arguments);
    EXPECT_EQ(outcome.exit_code, code) << outcome.err;
    EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  };
  const std::string torus = path("torus.nrrd"), out = path("out.nrrd");
  EXPECT_EQ(run_supple({"straighten", torus, "-o", out}).exit_code, 2);
  refused({"straighten", torus, "--along", path("none.csv"), "-o", out}, 3, "none.csv");
  write_text(path("one.csv"), "x,y,z\n0,0,0\n");
  refused({"straighten", torus, "--along", path("one.csv"), "-o", out}, 3, "one.csv");
  write_text(path("away.csv"), "x,y,z\n500,0,0\n540,0,0\n");
  refused({"straighten", torus, "--along", path("away.csv"), "-o", out}, 3, "out of the volume");
  refused(straighten({"--radius", "-2", "-o", out}), 3, "radius");
  refused(straighten({"-o", torus}), 3, "torus.nrrd");
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST_F(InteropStraighten, ScipyHasTheSameCurve) {
  if (!runs_python("-c 'import scipy, numpy' 2>&1")) GTEST_SKIP() << "scipy is not installed";
  write_text(path("curve.csv"),
             "x,y,z\n-20,-12,-3\n-17,2,1\n-6,14,4\n2,8,7\n9,-6,2\n21,-4,-5\n24,9,-4\n");
  json_of(straighten({"--radius", "2", "--spacing", "0.5", "--warp", path("warp.nhdr"), "-o",
                      path("straight.nrrd")}));
  const Geometry grid = read_warp(path("warp.nhdr")).geometry;
  const Vec3i& dims = grid.dims();
  const Vec3d begin = grid.world_from_index(Vec3d(Vec3i(0, dims.y / 2, dims.z / 2)));
  const Vec3d along = grid.axes_mm()[0];
  write_text(path("judge.py"), R"(
import sys, numpy as np
from scipy.interpolate import CubicSpline
folder = sys.argv[1]
nx, ny, nz = map(int, sys.argv[2:5])
begin, along = np.array(sys.argv[5:8], float), np.array(sys.argv[8:11], float)
points = np.loadtxt(folder + "/curve.csv", delimiter=",", skiprows=1)
chords = np.r_[0, np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))]
curve = CubicSpline(chords, points)
t = np.linspace(0, chords[-1], 200001)
speed = np.linalg.norm(curve(t, 1), axis=1)
length = np.r_[0, np.cumsum((speed[1:] + speed[:-1]) / 2 * (t[1] - t[0]))]
at = length[-1] / 2 + (np.arange(nx) - nx // 2) * 0.5
theirs = curve(np.interp(at, length, t))
vectors = np.fromfile(folder + "/warp.raw", "<f4").reshape(nz, ny, nx, 3)
ours = begin + np.arange(nx)[:, None] * along + vectors[nz // 2, ny // 2]
sys.exit(int(np.abs(ours - theirs).max() > 1e-4 or np.ptp(theirs) < 30))
)");
  std::ostringstream command;
  command.precision(17);
  command << path("judge.py") << " " << m_folder.path();
  for (int a = 0; a < 3; ++a) command << " " << dims[a];
  for (const Vec3d& v : {begin, along}) command << " " << v.x << " " << v.y << " " << v.z;
  EXPECT_TRUE(runs_python(command.str()));
}
