// Text transforms of ITK and elastix as warps, against maps that are written down by hand.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/errors.h"
#include "tests/support/io_fixtures.h"
#include "volumes/io/bytes/text_header.h"
#include "volumes/io/transform/transform_chain.h"
#include "volumes/io/warp_file.h"

namespace supple::test {
namespace {

std::string text_of(const std::vector<double>& numbers) {
  std::string text;
  for (const double number : numbers) text += " " + std::to_string(number);
  return text;
}

std::string itk(const std::string& type, const std::vector<double>& parameters,
                const std::vector<double>& fixed) {
  return "Transform: " + type + "\nParameters:" + text_of(parameters) +
         "\nFixedParameters:" + text_of(fixed) + "\n";
}

const std::string kHead = "#Insight Transform File V1.0\n#Transform 0\n";
const std::string kAffine = "AffineTransform_double_3_3";
const std::string kFieldType = "DisplacementFieldTransform_double_3_3";
const std::string kComposite = "Transform: CompositeTransform_double_3_3\n";
const std::vector<double> kMatrix = {1.5, 0.25, 0, -0.5, 1, 0, 0, 0.125, 2, 3, -4, 5};

/// y = M x + t of kMatrix.
Vec3d affine(const Vec3d& x) {
  return {1.5 * x.x + 0.25 * x.y + 3, -0.5 * x.x + x.y - 4, 0.125 * x.y + 2 * x.z + 5};
}

// Grid points at 10 + 2 i along P, 20 - 3 j along R, -30 + 4 k: columns of the direction.
const Vec3d kSpacing(2, 3, 4), kOrigin(20, 10, -30);
Geometry spline_grid(const Vec3i& dims) {
  return {dims, kOrigin, {Vec3d(0, 2, 0), {-3, 0, 0}, {0, 0, 4}}};
}
std::vector<double> fixed_of(const Vec3i& dims) {
  return {double(dims.x),
          double(dims.y),
          double(dims.z),
          20,
          10,
          -30,
          2,
          3,
          4,
          0,
          -1,
          0,
          1,
          0,
          0,
          0,
          0,
          1};
}

/// Displacement of the points of a spline whose coefficients are those of a quadratic function, and
/// what the spline makes of it: h^2 (order + 1) / 12 more per squared coordinate, as order 1 only
/// at its knots.
Vec3d quadratic(const Vec3d& x, double more) {
  const double square = 0.01 * (x.x * x.x + more * 9);
  return {0.1 * x.x - 0.2 * x.z + 1, square, 0.05 * x.y};
}

std::vector<double> coefficients(const Vec3i& dims) {
  const Geometry grid = spline_grid(dims);
  std::vector<double> values;
  for (int c = 0; c < 3; ++c) {
    for (int k = 0; k < dims.z; ++k) {
      for (int j = 0; j < dims.y; ++j) {
        for (int i = 0; i < dims.x; ++i) {
          values.push_back(quadratic(grid.world_from_index(Vec3d(i, j, k)), 0)[c]);
        }
      }
    }
  }
  return values;
}

TEST(UnitTransforms, ALinearTransformIsEvaluatedOnTheGridThatIsGiven) {
  const TemporaryFolder folder;
  const std::string path = folder.write("a.tfm", kHead + itk(kAffine, kMatrix, {0, 0, 0}));
  const Geometry grid = spline_grid({3, 2, 2});
  const Warp warp = read_warp(path, nullptr, &grid);
  EXPECT_TRUE(warp.geometry == grid);
  EXPECT_FALSE(warp.direction.has_value());
  for (int n = 0; n < 12; ++n) {
    const Vec3d x = grid.world_from_index(Vec3d(n % 3, n / 3 % 2, n / 6));
    EXPECT_LT((x + Vec3d(warp.vectors[std::size_t(n)]) - affine(x)).length(), 1e-5) << n;
  }
  EXPECT_NE(input_error([&] {
              read_warp(path);
            }).find("a.tfm: grid: found a transform of all space, expected a grid to evaluate"),
            std::string::npos);
}

TEST(UnitTransforms, TheLastTransformOfACompositeIsAppliedFirst) {
  const TemporaryFolder folder;
  const TransformChain chain = read_itk_transform(
      folder.write("a.tfm", kHead + kComposite + itk(kAffine, kMatrix, {0, 0, 0}) +
                                itk("TranslationTransform_double_3_3", {0, 0, 10}, {}) +
                                itk("IdentityTransform_double_3_3", {}, {})));
  const Vec3d x(7, -2, 3);
  EXPECT_LT((chain.at(x) - affine(x + Vec3d(0, 0, 10))).length(), 1e-12);
}

TEST(UnitTransforms, SplinesOfEveryOrderHaveTheirMomentsAndEndWithTheirGrid) {
  const TemporaryFolder folder;
  const Vec3i dims(6, 7, 6);
  const Geometry grid = spline_grid(dims);
  for (int order = 1; order <= 3; ++order) {
    const std::string type =
        "BSplineTransform_double_3_3" + (order == 3 ? std::string() : "_" + std::to_string(order));
    const TransformChain chain = read_itk_transform(
        folder.write("a.tfm", kHead + itk(type, coefficients(dims), fixed_of(dims))));
    EXPECT_FALSE(chain.grid);
    const double more = order == 1 ? 0 : (order + 1) / 12.0;
    for (const Vec3d& index : {Vec3d(2.3, 3, 2.9), {1, 1, 1}, {4, 5, 4}, {3.5, 4, 1.25}}) {
      const Vec3d x = grid.world_from_index(index);
      EXPECT_LT((chain.at(x) - x - quadratic(x, more)).length(), 1e-5) << order;
    }
    const double rim = 0.5 * (order - 1);
    for (int a = 0; a < 3; ++a) {
      Vec3d low(2.5), high(2.5);
      low[a] = rim - 0.01;
      high[a] = dims[a] - 1 - rim + 0.01;
      EXPECT_EQ(chain.at(grid.world_from_index(low)), grid.world_from_index(low)) << order;
      EXPECT_EQ(chain.at(grid.world_from_index(high)), grid.world_from_index(high)) << order;
    }
  }
}

TEST(UnitTransforms, AFieldAmongLinearTransformsBringsItsGrid) {
  const TemporaryFolder folder;
  const Vec3i dims(3, 2, 2);
  std::vector<double> vectors;
  for (int n = 0; n < 36; ++n) vectors.push_back(0.25 * n - 3);
  const std::string path =
      folder.write("a.tfm", kHead + kComposite + itk(kAffine, kMatrix, {0, 0, 0}) +
                                itk(kFieldType, vectors, fixed_of(dims)) +
                                itk("TranslationTransform_double_3_3", {1, 2, 3}, {}));
  const Warp warp = read_warp(path);
  ASSERT_EQ(warp.geometry.dims(), dims);
  for (int n = 0; n < 12; ++n) {
    const Vec3d index(n % 3, n / 3 % 2, n / 6);
    const Vec3d in_field = spline_grid(dims).world_from_index(index);
    const Vec3d x = warp.geometry.world_from_index(index);
    const Vec3d d(0.75 * n - 3, 0.75 * n - 2.75, 0.75 * n - 2.5);
    EXPECT_LT((x + Vec3d(1, 2, 3) - in_field).length(), 1e-9);
    EXPECT_LT((x + Vec3d(warp.vectors[std::size_t(n)]) - affine(in_field + d)).length(), 2e-5) << n;
  }
  // Half a step beyond the outer points the field ends.
  const TransformChain chain = read_itk_transform(path);
  const Vec3d inside = warp.geometry.world_from_index({-0.4, 0, 0});
  const Vec3d beyond = warp.geometry.world_from_index({-0.6, 0, 0});
  EXPECT_LT((chain.at(inside) - affine(inside + Vec3d(1, 2, 3) + Vec3d(-3, -2.75, -2.5))).length(),
            1e-9);
  EXPECT_LT((chain.at(beyond) - affine(beyond + Vec3d(1, 2, 3))).length(), 1e-9);
}

/// A transform as elastix 5 writes it, shortened.
std::string elastix(const std::string& type, const std::string& values, const std::string& more,
                    const std::string& initial = "NoInitialTransform",
                    const std::string& combine = "Compose") {
  return "(Transform \"" + type + "\")\n(NumberOfParameters 6)\n(TransformParameters " + values +
         ")\n(InitialTransformParametersFileName \"" + initial +
         "\")\n(UseBinaryFormatForTransformationParameters \"false\")\n(HowToCombineTransforms \"" +
         combine +
         "\")\n\n// Image specific\n(FixedImageDimension 3)\n(MovingImageDimension 3)\n"
         "(Size 3 2 2)\n(Index 1 0 2)\n(Spacing 2.0000000000 3 4)\n(Origin 20 10 -30)\n"
         "(Direction 0 1 0 -1 0 0 0 0 1)\n(UseDirectionCosines \"true\")\n" +
         more;
}
const std::string kCentre = "(CenterOfRotationPoint 0 0 0)\n(ComputeZYX \"false\")\n";

TEST(UnitTransforms, InitialTransformsOfElastixAreComposedOrAdded) {
  const TemporaryFolder folder;
  folder.write("t.0.txt", elastix("AffineTransform", text_of(kMatrix), kCentre));
  // The folder that elastix wrote to is another one by now.
  const std::string composed = folder.write(
      "t.1.txt", elastix("TranslationTransform", "1 2 3", "", "/elsewhere/out/t.0.txt"));
  const Vec3d x(7, -2, 3), shift(1, 2, 3);
  EXPECT_LT((read_elastix_transform(composed).at(x) - affine(x) - shift).length(), 1e-12);
  folder.write("t.1.txt", elastix("TranslationTransform", "1 2 3", ""));
  const std::string second = elastix("AffineTransform", text_of(kMatrix), kCentre, "t.1.txt");
  const std::string added = elastix("AffineTransform", text_of(kMatrix), kCentre, "t.1.txt", "Add");
  EXPECT_LT(
      (read_elastix_transform(folder.write("t.2.txt", second)).at(x) - affine(x + shift)).length(),
      1e-12);
  EXPECT_LT(
      (read_elastix_transform(folder.write("t.2.txt", added)).at(x) - affine(x) - shift).length(),
      1e-12);
  // The grid is that of the fixed image, from its own first index.
  const Warp warp = read_warp(folder / "t.2.txt");
  const Geometry whole = spline_grid({9, 9, 9});
  EXPECT_EQ(warp.geometry.dims(), Vec3i(3, 2, 2));
  EXPECT_LT((warp.geometry.origin_lps_mm() - whole.world_from_index({1, 0, 2})).length(), 1e-12);
  EXPECT_LT((warp.geometry.axes_mm()[1] - Vec3d(-3, 0, 0)).length(), 1e-12);
}

TEST(UnitTransforms, ASplineOfElastixLiesOnItsOwnGrid) {
  const TemporaryFolder folder;
  const Vec3i dims(6, 7, 6);
  const std::string path = folder.write(
      "t.txt", elastix("BSplineTransform", text_of(coefficients(dims)),
                       "(GridSize 6 7 6)\n(GridIndex 0 0 0)\n(GridSpacing 2 3 4)\n"
                       "(GridOrigin 20 10 -30)\n(GridDirection 0 1 0 -1 0 0 0 0 1)\n"
                       "(BSplineTransformSplineOrder 2)\n(UseCyclicTransform \"false\")\n"));
  const Vec3d x = spline_grid(dims).world_from_index({2.3, 3, 2.9});
  EXPECT_LT((read_elastix_transform(path).at(x) - x - quadratic(x, 0.25)).length(), 1e-5);
}

/// The error without the folder.
std::string error_of_transform(const std::string& text) {
  const TemporaryFolder folder;
  const std::string path = folder.write("t.txt", text);
  const Geometry grid;
  const std::string line = input_error([&] { read_warp(path, nullptr, &grid); });
  const std::size_t at = line.find("t.txt");
  return at == std::string::npos ? line : line.substr(at);
}

TEST(FaultTransforms, WhatIsWrongInTransformsOfItkIsNamedWithItsLine) {
  EXPECT_EQ(error_of_transform(kHead), "t.txt: Transform: found none, expected one at least");
  EXPECT_EQ(error_of_transform(kHead + itk("AffineTransform_double_2_2", {1}, {})),
            "t.txt:3: Transform: found AffineTransform_double_2_2, expected a transform from 3 to "
            "3 dimensions");
  EXPECT_NE(error_of_transform(kHead + itk("ScaleSkewVersor3DTransform_double_3_3", {1}, {}))
                .find("t.txt:3: TransformType: found ScaleSkewVersor3DTransform, expected a"),
            std::string::npos);
  EXPECT_NE(error_of_transform(kHead + itk(kAffine, {1, 2}, {}))
                .find("t.txt:3: TransformParameters: found 2 numbers, expected 12"),
            std::string::npos);
  EXPECT_EQ(error_of_transform(kHead + itk(kAffine, kMatrix, {0, 0, 0}) +
                               itk(kAffine, kMatrix, {0, 0, 0})),
            "t.txt:6: Transform: found AffineTransform_double_3_3, expected one transform, or a "
            "CompositeTransform first");
  EXPECT_EQ(error_of_transform(kHead + kComposite),
            "t.txt:3: Transform: found CompositeTransform_double_3_3, expected transforms behind "
            "it");
  EXPECT_EQ(error_of_transform(kHead + itk(kFieldType, {1, 2, 3}, fixed_of({3, 2, 2}))),
            "t.txt:4: Parameters: found fewer numbers, expected 36 numbers");
  EXPECT_EQ(error_of_transform(kHead + itk(kFieldType, {1, 2, 3}, fixed_of({1 << 20, 1 << 10, 9}))),
            "t.txt:4: Parameters: found fewer numbers, expected 2.8991e+10 numbers");
  EXPECT_EQ(error_of_transform(kHead + itk("BSplineTransform_double_3_3_4", {1}, {})),
            "t.txt:3: Transform: found BSplineTransform_double_3_3_4, expected order 1, 2 or 3");
  EXPECT_EQ(error_of_transform(kHead + "Parameters: 3\n"),
            "t.txt:3: line: found Parameters: 3, expected Transform, Parameters or "
            "FixedParameters");
  EXPECT_EQ(error_of_transform(kHead + "Transform: " + kAffine + "\nParameters: 1 two\n"),
            "t.txt:4: Parameters: found 1 two, expected numbers");
}

TEST(FaultTransforms, WhatIsWrongInTransformsOfElastixIsNamed) {
  EXPECT_EQ(error_of_transform(elastix("SplineKernelTransform", "1 2 3", "")),
            "t.txt: Transform: found SplineKernelTransform, expected TranslationTransform, "
            "EulerTransform, SimilarityTransform, AffineTransform or BSplineTransform");
  EXPECT_EQ(error_of_transform(elastix("TranslationTransform", "1 2 3", "", "other.txt")),
            "t.txt: InitialTransformParametersFileName: found other.txt, expected the file of that "
            "name beside it");
  EXPECT_EQ(error_of_transform(elastix("TranslationTransform", "1 2 3", "", "t.txt")),
            "t.txt: InitialTransformParametersFileName: found t.txt, expected at most 16 initial "
            "transforms");
  EXPECT_EQ(error_of_transform(
                elastix("TranslationTransform", "1 2 3", "", "NoInitialTransform", "Multiply")),
            "t.txt: HowToCombineTransforms: found Multiply, expected Compose or Add");
  EXPECT_EQ(error_of_transform(elastix("EulerTransform", "1 2 3 4 5 6", "")),
            "t.txt: CenterOfRotationPoint: found nothing, expected 3 numbers");
  EXPECT_EQ(error_of_transform(elastix("TranslationTransform", "1 2 nan", "")),
            "t.txt: TransformParameters: found 3 numbers, not all finite, expected 3 finite "
            "numbers");
  std::string huge = elastix("TranslationTransform", "1 2 3", "");
  huge.replace(huge.find("(Size 3 2 2)"), 12, "(Size 4096 4096 17)");
  EXPECT_EQ(error_of_transform(huge),
            "t.txt: grid: found 285212672 points, expected at most 268435456");
  EXPECT_EQ(error_of_transform("(Transform \"TranslationTransform\")\n(Size 3\n"),
            "t.txt:2: line: found (Size 3, expected (Key values)");
  EXPECT_EQ(error_of_transform("(Transform \"TranslationTransform\")\n(FixedImageDimension 2)\n"),
            "t.txt: FixedImageDimension: found 2, expected 3");
}

}  // namespace
}  // namespace supple::test
