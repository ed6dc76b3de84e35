// Curves through points, their frames (centreline.h), and straight boxes around them
// (straight_grid.h): arcs and helices, whose lengths, frames and det F are known.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/errors.h"
#include "volumes/base/error.h"
#include "volumes/field/centreline/straight_grid.h"
#include "volumes/field/dense/invert_warp.h"
#include "volumes/field/points/point_motion.h"

using namespace supple;
using namespace supple::test;

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kRadius = 40;
const Vec3d kCentre(5, -8, 30);

/// Points on an arc about kCentre in the axial plane, over `angle` radians.
std::vector<Vec3d> arc(int count, double angle) {
  std::vector<Vec3d> points;
  for (int n = 0; n < count; ++n) {
    const double at = angle * (double(n) / (count - 1) - 0.5);
    points.push_back(kCentre + Vec3d(std::sin(at), -std::cos(at), 0) * kRadius);
  }
  return points;
}

constexpr double kHelixRadius = 20, kClimb = 6;  // mm, mm per radian
const double kHelixSpeed = std::hypot(kHelixRadius, kClimb);

Vec3d on_helix(double angle) {
  return {kHelixRadius * std::cos(angle), kHelixRadius * std::sin(angle), kClimb * angle};
}

std::vector<Vec3d> helix(int count, double angle) {
  std::vector<Vec3d> points;
  for (int n = 0; n < count; ++n) points.push_back(on_helix(angle * n / (count - 1)));
  return points;
}

/// The angle about the curve from Frenet's normal to `up`.
double turn_from_normal(const CurveFrame& frame, double angle) {
  const Vec3d normal(-std::cos(angle), -std::sin(angle), 0);
  const Vec3d binormal = frame.along.cross(normal);
  return std::atan2(frame.up.dot(binormal), frame.up.dot(normal));
}

/// A box of voxels of 1 mm around an arc of 2 radians.
StraightGrid box_around_arc(const Straightening& settings) {
  return {arc(41, 2), settings, 1};
}

Warp warp_of(const StraightGrid& straight) {
  const Vec3i& dims = straight.grid().dims();
  const std::size_t size = std::size_t(dims.x) * std::size_t(dims.y);
  std::vector<Vec3f> vectors(size * std::size_t(dims.z));
  const VectorSliceSource slices = straight.slices();
  for (int k = 0; k < dims.z; ++k) slices(k, &vectors[size * std::size_t(k)]);
  return {"", straight.grid(), WarpDirection::resample, vectors};
}

}  // namespace

TEST(UnitCentreline, AnArcHasItsLengthCurvatureAndFrames) {
  const Centreline curve(arc(41, 2), std::nullopt);
  EXPECT_NEAR(curve.length_mm(), 2 * kRadius, 1e-4);
  for (const double part : {0.0, 0.13, 0.5, 0.77, 1.0}) {
    const double length = part * curve.length_mm(), at = length / kRadius - 1;
    const CurveFrame frame = curve.frame(length);
    const Vec3d out(std::sin(at), -std::cos(at), 0);
    EXPECT_LT((frame.at - kCentre - out * kRadius).length(), 1e-4);
    EXPECT_LT((frame.along - Vec3d(std::cos(at), std::sin(at), 0)).length(), 1e-3);
    EXPECT_LT((frame.up - Vec3d(0, 0, 1)).length(), 1e-12) << "superior, without roll";
    EXPECT_LT((frame.beside + out).length(), 1e-3) << "right-handed";
    EXPECT_LT((curve.curvature(length) + out / kRadius).length(), 0.02 / kRadius) << part;
  }
  const CurveFrame end = curve.frame(curve.length_mm()),
                   beyond = curve.frame(curve.length_mm() + 7);
  EXPECT_LT((beyond.at - end.at - end.along * 7).length(), 1e-12) << "straight on";
  EXPECT_EQ(curve.curvature(curve.length_mm() + 7), Vec3d(0));
}

TEST(UnitCentreline, FramesOfAHelixTurnAgainstItsTorsion) {
  // Frenet's normal turns by the torsion, a frame of least rotation does not (Bishop 1975).
  const double angle = 4 * kPi;
  const Centreline curve(helix(201, angle), Vec3d(1, 2, 0.5));
  const double torsion = kClimb / (kHelixSpeed * kHelixSpeed);
  const double half = curve.length_mm() / 2;
  const double begin = turn_from_normal(curve.frame(half), angle / 2);
  double worst = 0;
  for (int n = 1; n < 40; ++n) {
    const double length = n * curve.length_mm() / 40;
    const double turned = turn_from_normal(curve.frame(length), length / kHelixSpeed) - begin;
    worst = std::max(worst, std::abs(std::remainder(turned + torsion * (length - half), 2 * kPi)));
  }
  EXPECT_LT(worst, 2e-4);
  EXPECT_GT(torsion * half, 1.5) << "Frenet's frames would turn by a quarter and more";
}

TEST(PropertyCentreline, NothingFlipsWhereACurveIsStraightOrChangesSides) {
  std::vector<Vec3d> points;
  for (int n = 0; n <= 40; ++n) {
    const double x = 3.0 * n, wave = n < 20 ? std::sin(x / 10) * 12 : 0;
    points.push_back({x, wave, 0.3 * x});
  }
  const Centreline curve(points, std::nullopt);
  CurveFrame last = curve.frame(0);
  for (double length = 0.5; length < curve.length_mm(); length += 0.5) {
    const CurveFrame frame = curve.frame(length);
    EXPECT_GT(frame.up.dot(last.up), 0.99) << length;
    EXPECT_NEAR(frame.along.cross(frame.beside).dot(frame.up), 1, 1e-12);
    last = frame;
  }
}

TEST(ConvergenceCentreline, PlacesOnAHelixAreOfFourthOrder) {
  std::vector<double> errors;
  for (const int count : {17, 33, 65}) {
    const Centreline curve(helix(count, 2 * kPi), std::nullopt);
    double worst = 0;
    for (int n = 0; n <= 50; ++n) {
      const double part = n / 50.0;
      const Vec3d at = curve.frame(part * curve.length_mm()).at;
      worst = std::max(worst, (at - on_helix(part * 2 * kPi)).length());
    }
    errors.push_back(worst);
  }
  EXPECT_GT(std::log2(errors[0] / errors[1]), 3.5);
  EXPECT_GT(std::log2(errors[1] / errors[2]), 3.5);
}

TEST(UnitStraightGrid, DetOfAnArcIsOneLessCurvatureTimesTheWay) {
  Straightening settings;
  settings.radius_mm = 15;
  settings.height_mm = 6;
  const StraightGrid straight = box_around_arc(settings);
  const Warp warp = warp_of(straight);
  const Geometry& grid = straight.grid();
  EXPECT_EQ(grid.dims(), Vec3i(79, 31, 13)) << "an odd number, within the curve";
  const auto place = [&](int i, int j, int k) {
    const std::size_t n = (std::size_t(k) * 31 + std::size_t(j)) * 79 + std::size_t(i);
    return grid.world_from_index(Vec3d(i, j, k)) + Vec3d(warp.vectors[n]);
  };
  for (int n = 0; n < 200; ++n) {
    const int i = 1 + n * 7 % 77, j = 1 + n * 5 % 29, k = 1 + n * 3 % 11;
    const double inwards = j - 15;  // mm; `beside` points to the centre
    const double at = (i - 39.0) / kRadius;
    const Vec3d known = kCentre + Vec3d(std::sin(at), -std::cos(at), 0) * (kRadius - inwards) +
                        Vec3d(0, 0, k - 6.0);
    EXPECT_LT((place(i, j, k) - known).length(), 1e-3);
    const Vec3d along = (place(i + 1, j, k) - place(i - 1, j, k)) / 2;
    const Vec3d beside = (place(i, j + 1, k) - place(i, j - 1, k)) / 2;
    const Vec3d up = (place(i, j, k + 1) - place(i, j, k - 1)) / 2;
    EXPECT_NEAR(along.cross(beside).dot(up), 1 - inwards / kRadius, 1e-3);
  }
  const GridFolds folds = folds_of(grid, straight.slices(), nullptr);
  EXPECT_EQ(folds.folded_cells(), 0);
  EXPECT_NEAR(folds.smallest_det(), 1 - 15 / kRadius, 2e-3);
  EXPECT_LT((place(39, 15, 6) - grid.world_from_index({39, 15, 6})).length(), 1e-5)
      << "the middle rests";
}

TEST(UnitStraightGrid, FoldsBeginAtTheRadiusOfCurvature) {
  Straightening settings;
  settings.radius_mm = 50;
  settings.height_mm = 3;
  const StraightGrid wide = box_around_arc(settings);
  EXPECT_NEAR(wide.curve_radius_mm(), kRadius, 0.5);
  EXPECT_NEAR(wide.unfolded_radius_mm(), kRadius, 0.5);
  const GridFolds folds = folds_of(wide.grid(), wide.slices(), nullptr);
  // 10 rows of cells beyond 40 mm, 80 along and 6 up; those at 40 mm may be either.
  EXPECT_NEAR(double(folds.folded_cells()), 10.5 * 80 * 6, 0.6 * 80 * 6);
  EXPECT_NEAR(folds.smallest_det(), 1 - 50 / kRadius, 0.01);
  EXPECT_NE(folds_text(wide, folds).find("folded"), std::string::npos);

  settings.has_no_folds = true;
  const StraightGrid narrow = box_around_arc(settings);
  EXPECT_NEAR(narrow.radius_mm(), 0.95 * kRadius, 0.5);
  EXPECT_EQ(folds_of(narrow.grid(), narrow.slices(), nullptr).folded_cells(), 0);
  settings.radius_mm = 12;
  EXPECT_EQ(box_around_arc(settings).radius_mm(), 12) << "a radius without folds stays";
}

TEST(UnitStraightGrid, PointsReturnAndTheInverseIsCertified) {
  Straightening settings;
  settings.radius_mm = 20;
  settings.height_mm = 8;
  const StraightGrid straight(helix(61, 1.5), settings, 1);
  const Warp warp = warp_of(straight);
  const OffsetField inverse = invert(displacement_of_warp(warp));
  EXPECT_EQ(inverse.certificate.folded_cells, 0);
  EXPECT_LT(inverse.certificate.residual_max, 1e-4);
  EXPECT_EQ(inverse.certificate.overlapped_voxels, 0);

  const auto to_curve = motion_through(warp, true), to_straight = motion_through(warp, false);
  const Vec3i& dims = straight.grid().dims();
  for (int n = 0; n < 60; ++n) {
    const Vec3d index(1 + n * 7 % (dims.x - 2) + 0.3, 1 + n * 11 % (dims.y - 2) + 0.6,
                      1 + n * 5 % (dims.z - 2) + 0.1);
    const Vec3d begin = straight.grid().world_from_index(index);
    const MovedPoint bent = to_curve->move(begin);
    const MovedPoint back = to_straight->move(bent.to_lps_mm);
    EXPECT_EQ(back.kind, PlaceKind::inside);
    EXPECT_LT((back.to_lps_mm - begin).length(), 1e-4);
  }
}

TEST(ExtremesStraightGrid, ALineMovesNothingAndHasNoRadius) {
  for (const int count : {2, 3, 4, 9}) {
    std::vector<Vec3d> points;
    for (int n = 0; n < count; ++n) points.push_back(Vec3d(1, 2, 3) + Vec3d(3, -2, 6) * n);
    const StraightGrid straight(points, {}, 2);
    EXPECT_EQ(straight.unfolded_radius_mm(), std::numeric_limits<double>::infinity()) << count;
    for (const Vec3f& vector : warp_of(straight).vectors.all()) {
      ASSERT_LT(vector.length(), 1e-4f);
    }
  }
}

TEST(FaultStraightGrid, PointsAndLengthsThatGiveNoBoxAreRefused) {
  const auto refused = [](const std::vector<Vec3d>& points, const Straightening& settings,
                          const std::string& part) {
    const std::string found = input_error([&] { StraightGrid(points, settings, 1); });
    EXPECT_NE(found.find(part), std::string::npos) << found;
  };
  refused({{0, 0, 0}}, {}, "1 point");
  refused({{0, 0, 0}, {4, 0, 0}, {4, 0, 0}}, {}, "numbers 2 and 3");
  Straightening along;
  along.up = Vec3d(2, 0, 0);
  refused({{0, 0, 0}, {4, 0, 0}}, along, "up");
  Straightening tight;
  tight.has_no_folds = true;
  tight.height_mm = 50;
  tight.up = Vec3d(0, -1, 0);  // the arc lies in the plane of up
  refused(arc(41, 2), tight, "no_folds");
  Straightening fine;
  fine.spacing_mm = 1e-5;
  refused(arc(9, 2), fine, "spacing");
}
