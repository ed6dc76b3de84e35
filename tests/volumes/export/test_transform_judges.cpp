// ITK and elastix evaluate the transform files that supple reads as warps; each judge is skipped
// where it is not installed (tools/setup.sh --with-judges).
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <sstream>

#include <gtest/gtest.h>

#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"
#include "volumes/io/format/dense_writer.h"
#include "volumes/io/warp_file.h"

namespace supple::test {
namespace {

constexpr double kTolerance = 1e-4;  // mm

/// Oblique, 20 x 18 x 16 voxels.
Geometry fixed_grid() {
  const double c = std::cos(0.5), s = std::sin(0.5), d = std::cos(-0.35), t = std::sin(-0.35);
  return {{20, 18, 16},
          {-20, 15, -33},
          {Vec3d(c, s, 0) * 1.5, Vec3d(-s * d, c * d, t) * 1.25, Vec3d(s * t, -c * t, d) * 2}};
}

/// Both warps have the same grid and vectors, which are not all alike.
void expect_same(const Warp& ours, const Warp& judge, const std::string& name) {
  ASSERT_EQ(ours.geometry.dims(), judge.geometry.dims()) << name;
  EXPECT_LT((ours.geometry.origin_lps_mm() - judge.geometry.origin_lps_mm()).length(), 1e-6);
  double apart = 0, longest = 0;
  for (std::size_t n = 0; n < ours.vectors.size(); ++n) {
    apart = std::max(apart, double((ours.vectors[n] - judge.vectors[n]).length()));
    longest = std::max(longest, double((judge.vectors[n] - judge.vectors[0]).length()));
  }
  EXPECT_LT(apart, kTolerance) << name;
  EXPECT_GT(longest, 1) << name;
}

/// Path of ITK's program that writes transforms and fields; empty where there is none.
std::string itk_judge() {
  const char* binary = std::getenv("SUPPLE_BINARY");
  const std::filesystem::path judge =
      std::filesystem::path(binary != nullptr ? binary : "").parent_path() / "supple-itk-fields";
  return std::filesystem::exists(judge) ? judge.string() : "";
}

void write_grid(const std::string& path, const Geometry& grid) {
  DenseImage image;
  image.geometry = grid;
  image.type = ValueType::float32;
  const auto writer = create_dense(path, image);
  const std::vector<float> slice(20 * 18);
  for (int k = 0; k < 16; ++k) writer->write_slice(slice.data());
  writer->commit();
}

TEST(InteropTransforms, ItkTakesPointsWhereItsTextTransformsTakeOurs) {
  const std::string judge = itk_judge();
  if (judge.empty()) GTEST_SKIP() << "libinsighttoolkit5-dev is not installed";
  const TemporaryFolder folder;
  const Geometry grid = fixed_grid();
  write_grid(folder / "grid.mha", grid);
  for (const char* name : {"affine", "euler", "similarity", "bspline", "composite"}) {
    ASSERT_TRUE(runs(judge + " " + name + " " + (folder / "grid.mha") + " " + (folder / "t.tfm") +
                     " " + (folder / "field.mha")))
        << name;
    expect_same(read_warp(folder / "t.tfm", nullptr, &grid), read_warp(folder / "field.mha"), name);
  }
}

TEST(InteropTransforms, ComposeGivesTheFieldOfItksComposite) {
  const std::string judge = itk_judge();
  if (judge.empty()) GTEST_SKIP() << "libinsighttoolkit5-dev is not installed";
  const TemporaryFolder folder;
  const std::string grid = folder / "grid.mha";
  write_grid(grid, fixed_grid());
  std::string parts;
  for (const char* name : {"euler", "bspline", "affine", "composite"}) {
    const std::string path = folder / (std::string(name) + ".tfm");
    ASSERT_TRUE(runs(judge + " " + name + " " + grid + " " + path + " " +
                     (folder / (std::string(name) + ".mha"))));
    if (name != std::string("composite")) parts += path + " ";
  }
  const std::string compose = std::string(std::getenv("SUPPLE_BINARY")) + " compose ";
  const Warp expected = read_warp(folder / "composite.mha");
  for (const char* output : {"all.mha", "all.nrrd", "all.nii.gz", "all.h5"}) {
    ASSERT_TRUE(runs(compose + parts + "--grid " + grid + " -o " + (folder / output))) << output;
    expect_same(read_warp(folder / output), expected, output);
  }
  // A field of ITK that the affine map takes points into: that of the two, between grid points.
  ASSERT_TRUE(runs(compose + (folder / "euler.mha") + " " + (folder / "affine.tfm") + " --grid " +
                   grid + " -o " + (folder / "two.mha")));
  ASSERT_TRUE(runs(compose + (folder / "euler.tfm") + " " + (folder / "affine.tfm") + " --grid " +
                   grid + " -o " + (folder / "both.mha")));
  const Warp two = read_warp(folder / "two.mha"), both = read_warp(folder / "both.mha");
  std::size_t same = 0;
  for (std::size_t n = 0; n < two.vectors.size(); ++n) {
    same += (two.vectors[n] - both.vectors[n]).length() < kTolerance;
  }
  EXPECT_GT(same, two.vectors.size() / 8);  // inside of the field; beyond it stands for nothing
}

std::string words(const Vec3d& v) {
  std::ostringstream text;
  text.precision(12);
  text << " " << v.x << " " << v.y << " " << v.z;
  return text.str();
}

std::string words(const std::array<Vec3d, 3>& columns) {
  return words(columns[0]) + words(columns[1]) + words(columns[2]);
}

/// A transform file of elastix on the fixed grid.
std::string parameters(const std::string& type, const std::vector<double>& values,
                       const std::string& initial, const std::string& more) {
  const Geometry grid = fixed_grid();
  std::ostringstream text;
  text.precision(12);
  text << "(Transform \"" << type << "\")\n(NumberOfParameters " << values.size()
       << ")\n(TransformParameters";
  for (const double value : values) text << " " << value;
  text
      << ")\n(InitialTransformParametersFileName \"" << initial
      << "\")\n(HowToCombineTransforms \"Compose\")\n(FixedImageDimension 3)\n"
      << "(MovingImageDimension 3)\n(FixedInternalImagePixelType \"float\")\n"
      << "(MovingInternalImagePixelType \"float\")\n(Size 20 18 16)\n(Index 2 0 1)\n(Spacing"
      << words(grid.spacing_mm()) << ")\n(Origin" << words(grid.origin_lps_mm()) << ")\n(Direction"
      << words(grid.direction()) << ")\n(UseDirectionCosines \"true\")\n"
      << "(ResampleInterpolator \"FinalBSplineInterpolator\")\n(FinalBSplineInterpolationOrder 1)\n"
      << "(Resampler \"DefaultResampler\")\n(DefaultPixelValue 0)\n(ResultImageFormat \"mha\")\n"
      << "(ResultImagePixelType \"float\")\n"
      << more;
  return text.str();
}

TEST(InteropTransforms, TransformixTakesPointsWhereItsParametersTakeOurs) {
  if (!runs("transformix --version")) GTEST_SKIP() << "transformix (elastix) is not installed";
  const Geometry grid = fixed_grid();
  for (int order = 1; order <= 3; ++order) {
    const TemporaryFolder folder;
    const std::string centre = "(CenterOfRotationPoint 1 -2 3)\n(ComputeZYX \"" +
                               std::string(order == 2 ? "true" : "false") + "\")\n";
    const std::string initial = folder.write(
        "t.0.txt",
        order == 3 ? parameters("AffineTransform", {1.1, 0.1, 0, 0, 0.9, -0.1, 0.2, 0, 1, 3, 2, 1},
                                "NoInitialTransform", centre)
                   : parameters("EulerTransform", {0.2, -0.3, 0.1, 1, -2, 3}, "NoInitialTransform",
                                centre));
    std::vector<double> values;
    for (int n = 0; n < 3 * 6 * 5 * 4; ++n) values.push_back(5 * std::sin(12.9 * n + 1));
    // Smaller than the image, so that some points lie outside.
    const std::string path = folder.write(
        "t.1.txt",
        parameters("BSplineTransform", values, initial,
                   "(GridSize 6 5 4)\n(GridIndex 0 0 0)\n(GridSpacing 5 6 8)\n(GridOrigin" +
                       words(grid.world_from_index({-1, 1, 0})) + ")\n(GridDirection" +
                       words(grid.direction()) + ")\n(BSplineTransformSplineOrder " +
                       std::to_string(order) + ")\n(UseCyclicTransform \"false\")\n"));
    ASSERT_TRUE(runs("transformix -threads 1 -def all -tp " + path + " -out " + folder.path()));
    expect_same(read_warp(path), read_warp(folder / "deformationField.mha"),
                "order " + std::to_string(order));
  }
}

}  // namespace
}  // namespace supple::test
