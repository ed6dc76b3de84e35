// Other people's programs send points and labels through our warps, and `supple apply` must agree:
// transformix (elastix) with points, plastimatch with labels. Each is skipped where it is not
// installed (tools/setup.sh --with-judges).
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>
#include <sstream>

#include <gtest/gtest.h>

#include "tests/support/program.h"

using namespace supple;
using namespace supple::test;

namespace {

constexpr int kSize = 24;

/// A dragged ball and its warp, to be compared with what a judge makes of them.
class JudgedApply : public ::testing::Test {
 protected:
  void SetUp() override {
    write_ball(m_folder, "ball", kSize);
    write_soft_material(path("soft.toml"));
    expect_ok({"deform", path("ball.nhdr"), "--material", path("soft.toml"), "--grab", "20,12,12",
               "--by", "3.3,-1.7,0.9", "-o", path("drag.vdb")});
    expect_ok({"export", path("drag.vdb"), "-o", path("warp.mha")});
  }
  std::string path(const std::string& name) const { return m_folder / name; }
  static void expect_ok(const std::vector<std::string>& arguments) {
    const Outcome outcome = run_supple(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  }

  TemporaryFolder m_folder;
};

using InteropApply = JudgedApply;

const char* kTransform =
    "(Transform \"DeformationFieldTransform\")\n(NumberOfParameters 0)\n"
    "(DeformationFieldInterpolationOrder 1)\n"
    "(InitialTransformParametersFileName \"NoInitialTransform\")\n"
    "(HowToCombineTransforms \"Compose\")\n(FixedImageDimension 3)\n(MovingImageDimension 3)\n"
    "(FixedInternalImagePixelType \"float\")\n(MovingInternalImagePixelType \"float\")\n"
    "(Size 24 24 24)\n(Index 0 0 0)\n(Spacing 1 1 1.5)\n(Origin 0 0 0)\n"
    "(Direction 1 0 0 0 1 0 0 0 1)\n(UseDirectionCosines \"true\")\n"
    "(Resampler \"DefaultResampler\")\n(ResampleInterpolator \"FinalBSplineInterpolator\")\n"
    "(FinalBSplineInterpolationOrder 1)\n(DefaultPixelValue 0)\n";

}  // namespace

TEST_F(InteropApply, TransformixSendsPointsThroughAWarpAsTheWayBackDoes) {
  if (!runs("command -v transformix")) GTEST_SKIP() << "transformix is not installed";
  constexpr int kPoints = 200;
  std::mt19937 random(2);
  std::uniform_real_distribution<double> place(0.2, kSize - 0.6);
  std::ostringstream csv, list;
  csv.precision(9);
  list.precision(9);
  csv << "x,y,z\n";
  list << "point\n" << kPoints << "\n";
  for (int n = 0; n < kPoints; ++n) {
    const double x = place(random), y = place(random), z = 1.5 * place(random);
    csv << x << "," << y << "," << z << "\n";
    list << x << " " << y << " " << z << "\n";
  }
  write_text(path("p.csv"), csv.str());
  write_text(path("p.txt"), list.str());
  write_text(path("t.txt"),
             kTransform + ("(DeformationFieldFileName \"" + path("warp.mha") + "\")\n"));
  ASSERT_TRUE(runs("transformix -def " + path("p.txt") + " -tp " + path("t.txt") + " -out " +
                   m_folder.path()));
  expect_ok({"apply", path("warp.mha"), "--back", "--points", path("p.csv"), "-o", path("q.csv")});

  std::istringstream theirs(read_text(path("outputpoints.txt"))), ours(read_text(path("q.csv")));
  std::string line;
  std::getline(ours, line);
  double worst = 0, longest = 0;
  for (int n = 0; n < kPoints; ++n) {
    double a[3], b[3], from[3];
    ASSERT_TRUE(std::getline(ours, line));
    ASSERT_EQ(std::sscanf(line.c_str(), "%lf,%lf,%lf", &a[0], &a[1], &a[2]), 3) << line;
    ASSERT_TRUE(std::getline(theirs, line));
    const auto read = [&](const std::string& key, double* v) {
      const std::size_t at = line.find(key + " = [");
      return at != std::string::npos && std::sscanf(line.c_str() + at + key.size() + 4,
                                                    "%lf %lf %lf", &v[0], &v[1], &v[2]) == 3;
    };
    ASSERT_TRUE(read("OutputPoint", b) && read("InputPoint", from)) << line;
    for (int c = 0; c < 3; ++c) {
      worst = std::max(worst, std::abs(a[c] - b[c]));
      longest = std::max(longest, std::abs(b[c] - from[c]));
    }
  }
  EXPECT_LT(worst, 2e-5) << "transformix prints six decimals";
  EXPECT_GT(longest, 1) << "a warp worth the test";
}

TEST_F(InteropApply, PlastimatchSendsLabelsThroughAWarpAsWeDo) {
  if (!runs("command -v plastimatch")) GTEST_SKIP() << "plastimatch is not installed";
  std::string labels = read_text(path("ball.raw"));
  for (std::size_t n = 0; n < labels.size(); ++n) {
    labels[n] = char(labels[n] == 0 ? 0 : 1 + n % kSize / 4 + n / (kSize * kSize) % 2 * 100);
  }
  write_text(path("labels.raw"), labels);
  write_text(path("labels.nhdr"),
             "NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\n"
             "sizes: 24 24 24\nspace directions: (1,0,0) (0,1,0) (0,0,1.5)\n"
             "space origin: (0,0,0)\nencoding: raw\ndata file: labels.raw\n");
  ASSERT_TRUE(runs("plastimatch warp --input " + path("labels.nhdr") + " --fixed " +
                   path("labels.nhdr") + " --xf " + path("warp.mha") +
                   " --interpolation nn --output-img " + path("theirs.mha")));
  expect_ok({"apply", path("warp.mha"), "--labels", path("labels.nhdr"), "-o", path("ours.nhdr")});
  const std::string ours = read_text(path("ours.raw")), file = read_text(path("theirs.mha"));
  ASSERT_GE(file.size(), ours.size());
  const std::string theirs = file.substr(file.size() - ours.size());
  int differ = 0, moved = 0;
  for (std::size_t n = 0; n < ours.size(); ++n) {
    differ += ours[n] != theirs[n];
    moved += ours[n] != labels[n];
  }
  EXPECT_EQ(differ, 0);
  EXPECT_GT(moved, 150) << "a warp worth the test";
}
