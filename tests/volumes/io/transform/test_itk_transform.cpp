// ITK transform files, written by the HDF5 library as itk::HDF5TransformIO writes them; the maps of
// the linear transforms are written down by hand.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/io_fixtures.h"
#include "tests/volumes/io/hdf5_fixtures.h"
#include "volumes/base/error.h"
#include "volumes/io/warp_file.h"

namespace supple::test {
namespace {

const std::string kField = "DisplacementFieldTransform_double_3_3";
// 3 x 2 x 2 voxels of 2 x 3 x 4 mm; i along P, j along R, k along S: columns of the matrix.
const std::vector<double> kGrid = {3, 2, 2, 10, 20, -30, 2, 3, 4, 0, -1, 0, 1, 0, 0, 0, 0, 1};
const Geometry kGeometry({3, 2, 2}, {10, 20, -30}, {Vec3d(0, 2, 0), {-3, 0, 0}, {0, 0, 4}});

std::vector<double> displacements() {
  std::vector<double> values;
  for (int n = 0; n < 36; ++n) values.push_back(0.25 * n - 3);
  return values;
}

/// A CompositeTransform of these transforms in this order; the field where the type is `kField`.
struct Part {
  std::string type;
  std::vector<double> fixed, parameters;
};
std::string composite(const TemporaryFolder& folder, const std::vector<Part>& parts) {
  Hdf5Fixture file(folder / "c.h5");
  put_itk_transform(file, 0, "CompositeTransform_double_3_3");
  for (std::size_t n = 0; n < parts.size(); ++n) {
    const bool is_field = parts[n].type == kField;
    put_itk_transform(file, int(n) + 1, parts[n].type, is_field ? kGrid : parts[n].fixed,
                      is_field ? displacements() : parts[n].parameters);
  }
  return folder / "c.h5";
}

using Map = Vec3d (*)(const Vec3d&);
Vec3d same(const Vec3d& p) {
  return p;
}

/// The warp must take the point that `before` puts on voxel n of the field to
/// after(voxel + displacement).
void expect_map(const std::string& path, Map before, Map after) {
  const Warp warp = read_warp(path);
  const std::vector<double> d = displacements();
  ASSERT_EQ(warp.geometry.dims(), kGeometry.dims());
  for (int n = 0; n < 12; ++n) {
    const Vec3d index(n % 3, n / 3 % 2, n / 6), in_field = kGeometry.world_from_index(index);
    const Vec3d x = warp.geometry.world_from_index(index);
    EXPECT_LT((before(x) - in_field).length(), 1e-9);
    const Vec3d moved = after(in_field + Vec3d(d[3 * n], d[3 * n + 1], d[3 * n + 2]));
    EXPECT_LT((x + Vec3d(warp.vectors[n]) - moved).length(), 1e-4) << n;
  }
}

TEST(UnitItkTransform, AFieldIsReadUnchangedInEitherPrecision) {
  const TemporaryFolder folder;
  {
    Hdf5Fixture file(folder / "a.h5");
    put_itk_transform(file, 0, kField, kGrid, displacements());
  }
  const Warp warp = read_warp(folder / "a.h5");
  EXPECT_TRUE(warp.geometry == kGeometry);
  EXPECT_FALSE(warp.direction.has_value());
  for (int n = 0; n < 36; ++n) EXPECT_EQ(warp.vectors[n / 3][n % 3], float(displacements()[n]));
  {
    Hdf5Fixture file(folder / "b.h5");
    file.text("/TransformGroup/0/TransformType", "DisplacementFieldTransform_float_3_3", false);
    file.numbers("/TransformGroup/0/TranformFixedParameters", kGrid);  // as old ITK spells it
    std::vector<float> values;
    for (const double value : displacements()) values.push_back(float(value));
    Hdf5Storage storage{H5T_IEEE_F32BE, {7}};
    storage.deflate = true;
    file.dataset("/TransformGroup/0/TranformParameters", {36}, values, storage);
  }
  EXPECT_EQ(read_warp(folder / "b.h5").vectors, warp.vectors);
  EXPECT_TRUE(read_warp(folder / "b.h5").geometry == kGeometry);
}

TEST(UnitItkTransform, TheLastTransformOfACompositeIsAppliedFirst) {
  const TemporaryFolder folder;
  const Part turn = {
      "AffineTransform_double_3_3", {1, 2, 3}, {0, -2, 0, 1, 0, 0, 0, 0, 1, 5, 6, 7}};
  const Map turned = [](const Vec3d& p) {  // about (1, 2, 3)
    return Vec3d(-2 * (p.y - 2) + 1 + 5, (p.x - 1) + 2 + 6, (p.z - 3) + 3 + 7);
  };
  const Part shift = {"TranslationTransform_double_3_3", {}, {1, -2, 4}};
  const Map shifted = [](const Vec3d& p) { return p + Vec3d(1, -2, 4); };
  expect_map(composite(folder, {{kField, {}, {}}}), same, same);
  expect_map(composite(folder, {turn, {kField, {}, {}}}), same, turned);
  expect_map(composite(folder, {{kField, {}, {}}, turn}), turned, same);
  expect_map(composite(folder, {turn, {kField, {}, {}}, shift}), shifted, turned);
  expect_map(composite(folder, {shift, turn, {kField, {}, {}}}), same, [](const Vec3d& p) {
    return Vec3d(-2 * (p.y - 2) + 6, p.x + 7, p.z + 7) + Vec3d(1, -2, 4);
  });
  expect_map(
      composite(folder, {{kField, {}, {}}, shift, turn}),
      [](const Vec3d& p) { return Vec3d(-2 * (p.y - 2) + 6, p.x + 7, p.z + 7) + Vec3d(1, -2, 4); },
      same);
}

TEST(UnitItkTransform, EveryLinearTransformHasItsParametersInItksOrder) {
  const TemporaryFolder folder;
  const double right = 1.5707963267948966, root = std::sqrt(0.5);
  const auto after = [&](const std::string& name, const std::vector<double>& fixed,
                         const std::vector<double>& parameters, Map map) {
    SCOPED_TRACE(name);
    expect_map(composite(folder, {{name + "_double_3_3", fixed, parameters}, {kField, {}, {}}}),
               same, map);
  };
  after("IdentityTransform", {}, {}, same);
  after("MatrixOffsetTransformBase", {0, 0, 0}, {1, 2, 3, 0, 1, 4, 0, 0, 1, 0, 0, 1},
        [](const Vec3d& p) { return Vec3d(p.x + 2 * p.y + 3 * p.z, p.y + 4 * p.z, p.z + 1); });
  // Quarter turns about x, then y, then z: Rz Rx Ry, or Rz Ry Rx where the fourth number says so.
  after("Euler3DTransform", {0, 0, 1}, {right, right, 0, 0, 0, 5},
        [](const Vec3d& p) { return Vec3d(p.z - 1, p.x, p.y + 6); });
  after("Euler3DTransform", {0, 0, 1, 1}, {right, right, 0, 0, 0, 5},
        [](const Vec3d& p) { return Vec3d(p.y, 1 - p.z, 6 - p.x); });
  after("Euler3DTransform", {0, 0, 0}, {0, 0, right, 1, 2, 3},
        [](const Vec3d& p) { return Vec3d(1 - p.y, p.x + 2, p.z + 3); });
  after("VersorRigid3DTransform", {1, 0, 0}, {0, 0, root, 1, 2, 3},
        [](const Vec3d& p) { return Vec3d(2 - p.y, p.x + 1, p.z + 3); });
  after("Similarity3DTransform", {0, 0, 0}, {root, 0, 0, 1, 2, 3, 2},
        [](const Vec3d& p) { return Vec3d(2 * p.x + 1, 2 - 2 * p.z, 2 * p.y + 3); });
}

TEST(FaultItkTransform, OtherTransformsAreRefusedByName) {
  const TemporaryFolder folder;
  const auto expect = [](const std::string& path, const std::string& part) {
    const std::string line = failure_of_warp(path);
    EXPECT_NE(line.find(part), std::string::npos) << line;
  };
  const Part field = {kField, {}, {}};
  expect(composite(folder, {field, {"BSplineTransform_double_3_3", {}, {}}}),
         "TransformType: found BSplineTransform");
  expect(composite(folder, {field, field}), "/2: found a second displacement field");
  expect(composite(folder, {{"IdentityTransform_double_3_3", {}, {}}}), "no displacement field");
  expect(composite(folder, {{"AffineTransform_double_2_2", {}, {}}, field}),
         "from 3 to 3 dimensions");
  expect(composite(folder, {{"AffineTransform_double_3_3", {0, 0, 0}, {1, 2}}, field}),
         "found 2 numbers, expected 12");
  expect(composite(folder,
                   {{"AffineTransform_double_3_3", {0, 0, 0}, std::vector<double>(12)}, field}),
         "direction");
  expect(composite(folder,
                   {{"VersorRigid3DTransform_double_3_3", {0, 0, 0}, {1, 1, 0, 0, 0, 0}}, field}),
         "no versor");
  {
    Hdf5Fixture file(folder / "two.h5");
    put_itk_transform(file, 0, kField, kGrid, displacements());
    put_itk_transform(file, 1, "IdentityTransform_double_3_3");
  }
  expect(folder / "two.h5", "without a CompositeTransform");
}

TEST(FaultItkTransform, AGridThatIsNoneIsRefused) {
  const TemporaryFolder folder;
  const auto expect = [&](std::size_t at, double value, const std::string& part) {
    std::vector<double> grid = kGrid;
    if (at < 18) grid[at] = value;
    if (at == 18) grid.push_back(value);
    std::vector<double> values = displacements();
    if (at == 19) values.pop_back();
    {
      Hdf5Fixture file(folder / "a.h5");
      put_itk_transform(file, 0, kField, grid, values);
    }
    const std::string line = failure_of_warp(folder / "a.h5");
    EXPECT_NE(line.find(part), std::string::npos) << line;
  };
  const double nan = std::nan("");
  expect(0, 2.5, "size 2.5");
  expect(0, 0, "size 0");
  expect(1, nan, "size nan");
  expect(2, 3e9, "size 3e+09");
  expect(0, 4, "another count of numbers");
  expect(3, nan, "origin");
  expect(6, 0, "spacing 0");
  expect(7, -1, "spacing -1");
  expect(12, 0, "direction");
  expect(18, 1, "19 numbers");
  expect(19, 0, "another count of numbers");
}

}  // namespace
}  // namespace supple::test
