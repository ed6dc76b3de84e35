// Warps and segmentations judged against each other (volumes/compare), by brute force.
#include <gtest/gtest.h>

#include "tests/support/errors.h"
#include "tests/volumes/field/offset_fixtures.h"
#include "volumes/compare/compare_warps.h"

using namespace supple;
using namespace supple::test;

namespace {

const Geometry kFixed{{9, 8, 7}, {-4, 6, 2}, {Vec3d(0, 2, 0), {-1.5, 0, 0.25}, {0, 0, 3}}};

Vec3d bow(const Vec3d& x) {
  return {0.02 * x.y * x.y, 0.3 * std::sin(x.z), 1 - 0.1 * x.x};
}
Vec3d tilt(const Vec3d& x) {
  return {0.1 * x.y, 0.5, 0.2 * x.z - 1};
}

}  // namespace

TEST(UnitCompareWarps, OnOneGridEachErrorIsTheDistanceOfTwoVectors) {
  const Warp a = warp_of(kFixed, WarpDirection::resample, bow);
  const Warp b = warp_of(kFixed, {}, tilt);
  const EndpointErrors errors = compare_warps(a, b);
  ASSERT_EQ(errors.errors_mm.size(), 9u * 8 * 7);
  std::vector<double> sorted;
  double sum = 0, squares = 0;
  for (std::size_t n = 0; n < errors.errors_mm.size(); ++n) {
    const double error = (Vec3d(a.vectors[n]) - Vec3d(b.vectors[n])).length();
    EXPECT_NEAR(errors.errors_mm[n], error, 1e-5);
    sorted.push_back(error);
    sum += error;
    squares += error * error;
  }
  std::sort(sorted.begin(), sorted.end());
  const LengthStatistics& s = errors.statistics;
  EXPECT_EQ(s.count, 504);
  EXPECT_EQ(errors.outside, 0);
  EXPECT_NEAR(s.mean_mm, sum / 504, 1e-5);
  EXPECT_NEAR(s.rms_mm, std::sqrt(squares / 504), 1e-5);
  EXPECT_NEAR(s.median_mm, sorted[251], 1e-5);
  EXPECT_NEAR(s.p95_mm, sorted[478], 1e-5);  // the 479th of 504
  EXPECT_NEAR(s.max_mm, sorted[503], 1e-5);
  EXPECT_EQ(compare_warps(a, a).statistics.max_mm, 0);
}

TEST(UnitCompareWarps, AnotherGridIsReadBetweenItsPointsAndLeftOutBeyondThem) {
  // Affine vectors are the same between grid points; the second grid is finer, turned and smaller.
  const Geometry finer =
      oblique_geometry({30, 30, 12}, kFixed.world_from_index({1, 2, 3}), {0.7, 0.8, 0.9}, 0.3);
  const Warp a = warp_of(kFixed, WarpDirection::material, tilt);
  const Warp b = warp_of(finer, WarpDirection::material, tilt);
  const EndpointErrors errors = compare_warps(a, b);
  EXPECT_GT(errors.statistics.count, 10);
  EXPECT_GT(errors.outside, 10);
  EXPECT_EQ(errors.statistics.count + errors.outside, 504);
  std::int64_t inside = 0;
  for (std::size_t n = 0; n < errors.errors_mm.size(); ++n) {
    const Vec3i voxel(int(n % 9), int(n / 9 % 8), int(n / 72));
    const Vec3d x = finer.index_from_world(kFixed.world_from_index(Vec3d(voxel)));
    bool is_inside = true, is_in_border = false;
    for (int c = 0; c < 3; ++c) {
      is_inside = is_inside && x[c] >= -0.5 && x[c] <= finer.dims()[c] - 0.5;
      is_in_border = is_in_border || x[c] < 0 || x[c] > finer.dims()[c] - 1;
    }
    inside += is_inside;
    EXPECT_EQ(std::isnan(errors.errors_mm[n]), !is_inside) << voxel;
    if (!is_inside || is_in_border) continue;
    EXPECT_LT(errors.errors_mm[n], 1e-5) << voxel;
  }
  EXPECT_EQ(errors.statistics.count, inside);
}

TEST(UnitCompareWarps, AtPointsVectorsAreReadBetweenGridPoints) {
  const Warp a = warp_of(kFixed, WarpDirection::resample, tilt);
  const Warp b = warp_of(kFixed, WarpDirection::resample, [](const Vec3d&) { return Vec3d(0.5); });
  const std::vector<Vec3d> points = {kFixed.world_from_index({2.25, 3.5, 1.75}),
                                     kFixed.world_from_index({0, 0, 40})};
  const EndpointErrors errors = compare_warps_at(points, a, b);
  EXPECT_NEAR(errors.errors_mm[0], (tilt(points[0]) - Vec3d(0.5)).length(), 1e-5);
  EXPECT_TRUE(std::isnan(errors.errors_mm[1]));
  EXPECT_EQ(errors.outside, 1);
  EXPECT_EQ(errors.statistics.count, 1);
}

TEST(UnitCompareWarps, AMaskCountsOnlyWhereItIsNotZero) {
  const Warp a = warp_of(kFixed, WarpDirection::resample, bow);
  const Warp b = warp_of(kFixed, WarpDirection::resample, tilt);
  const LabelLookup upper = [](const Vec3d& x) {
    return kFixed.index_from_world(x).z > 3.5 ? 2.0 : 0.0;
  };
  const EndpointErrors errors = compare_warps(a, b, upper);
  EXPECT_EQ(errors.statistics.count, 9 * 8 * 3);
  EXPECT_TRUE(std::isnan(errors.errors_mm[0]));
}

TEST(FaultCompareWarps, OppositeDirectionsAreRefused) {
  const Warp a = warp_of(kFixed, {}, bow);
  const Warp b = warp_of(kFixed, WarpDirection::material, bow);
  EXPECT_THROW(compare_warps(a, b), InputError);
  EXPECT_THROW(compare_warps_at({Vec3d(0)}, a, b), InputError);
}

TEST(UnitCompareLabels, DiceCountsVoxelsOfEitherAndOfBoth) {
  const Geometry grid = unit_geometry({10, 4, 3});
  const auto stripes = [](double from) {
    return [from](const Vec3d& x) { return x.x < from ? 0.0 : x.x < from + 4 ? 1.0 : 7.0; };
  };
  const LabelOverlaps overlaps = compare_labels(grid, stripes(1), stripes(2));
  ASSERT_EQ(overlaps.size(), 2u);
  const LabelOverlap one = overlaps.at(1), seven = overlaps.at(7);
  EXPECT_EQ(one.in_a, 4 * 12);
  EXPECT_EQ(one.in_b, 4 * 12);
  EXPECT_EQ(one.in_both, 3 * 12);
  EXPECT_DOUBLE_EQ(one.dice(), 0.75);
  EXPECT_DOUBLE_EQ(seven.dice(), 2 * 4.0 / (5 + 4));
  EXPECT_DOUBLE_EQ(*mean_dice(overlaps), (0.75 + 8.0 / 9) / 2);
  const LabelLookup nowhere = [](const Vec3d&) { return 0.0; };
  EXPECT_FALSE(mean_dice(compare_labels(grid, stripes(1), stripes(2), nowhere)));
}
