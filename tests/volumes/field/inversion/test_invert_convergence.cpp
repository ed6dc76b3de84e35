#include <gtest/gtest.h>

#include "tests/support/field_fixtures.h"
#include "volumes/field/inversion/invert.h"
#include "volumes/field/procedural.h"
#include "volumes/grid/cell.h"

using namespace supple;
using namespace supple::test;

namespace {

/// Slope of log(error) over log(1 / n) by least squares.
double fitted_order(const std::vector<std::pair<int, double>>& errors) {
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (const auto& [n, error] : errors) {
    const double x = -std::log(double(n)), y = std::log(error);
    sx += x;
    sy += y;
    sxx += x * x;
    sxy += x * y;
  }
  const double count = double(errors.size());
  return (count * sxy - sx * sy) / (count * sxx - sx * sx);
}

/// A raised-cosine bump along a direction oblique to the lattice. Its shift depends only on the two
/// coordinates across that direction, which it leaves alone, so that -u is the exact offset; along
/// a lattice axis the samples themselves would already be exact.
AnalyticWarp oblique_bump(const Vec3d& center, double radius, double height) {
  const Vec3d along = Vec3d(1, 2, 0.5).normalized();
  const Vec3d e1 = along.cross(Vec3d(0, 0, 1)).normalized(), e2 = along.cross(e1);
  const auto shift = [=](const Vec3d& p) {
    const AnalyticWarp bump = bump_warp(Vec3d(0), radius, height);
    return bump.displacement_voxels({e1.dot(p - center), 0, e2.dot(p - center)}).y;
  };
  return {[=](const Vec3d& p) { return along * shift(p); },
          [=](const Vec3d& p) { return along * -shift(p); }};
}

/// Largest error of the offset, relative to the box, when the box is n voxels long.
double bump_error(int n) {
  const AnalyticWarp bump = oblique_bump(Vec3d(0.5 * n), 0.4 * n, 0.3 * n);
  const OffsetField field = invert(
      sample_displacement(bump, unit_geometry(Vec3i(n + 1)), box_topology(Vec3i(0), Vec3i(n))));
  EXPECT_LE(field.certificate.residual_max, 1e-4);
  EXPECT_EQ(field.certificate.folded_cells, 0);
  double worst = 0;
  for_each_slot(field.o.topology, [&](const Vec3i& x, std::size_t slot) {
    const Vec3d offset(field.o.vectors.at(slot)), place = Vec3d(x) + offset;
    if (within_border(place, Vec3i(n + 1)) != place) return;  // extrapolated
    const Vec3d error = offset - bump.offset_voxels(Vec3d(x));
    worst = std::max(worst, error.length() / n);
  });
  return worst;
}

}  // namespace

TEST(ConvergenceInvert, ASmoothObliqueBumpIsInvertedWithSecondOrder) {
  std::vector<std::pair<int, double>> errors;
  for (const int n : {16, 24, 32, 48, 64}) errors.emplace_back(n, bump_error(n));
  EXPECT_NEAR(fitted_order(errors), 2, 0.25);
}
