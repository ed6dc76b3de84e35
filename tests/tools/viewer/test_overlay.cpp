// Energies and colours of what is painted over pictures, against analytic ones.
#include <cmath>

#include <gtest/gtest.h>

#include "tools/viewer/slice_panes.h"

using namespace supple;
using namespace supple::tools;

namespace {

constexpr double kYoung = 12, kPoisson = 0.3;
const double kLambda = kYoung * kPoisson / ((1 + kPoisson) * (1 - 2 * kPoisson));
const double kMu = kYoung / (2 * (1 + kPoisson));

/// Voxels of unequal sides along axes that are turned by 30 degrees.
Geometry oblique() {
  const double c = std::cos(0.5235987755982988), s = std::sin(0.5235987755982988);
  return Geometry({9, 9, 9}, {5, -3, 2},
                  {Vec3d(0.5 * c, 0.5 * s, 0), {-2 * s, 2 * c, 0}, {0, 0, 3}});
}

/// Columns on the grid of a gradient that is given by its columns in mm.
GridGradient on_grid(const Geometry& geometry, const Vec3d& x, const Vec3d& y, const Vec3d& z) {
  GridGradient f;
  for (int a = 0; a < 3; ++a) {
    Vec3d step(0);
    step[a] = 1;
    const Vec3d mm = geometry.world_vector_from_index(step);
    f[std::size_t(a)] = geometry.index_vector_from_world(x * mm.x + y * mm.y + z * mm.z);
  }
  return f;
}

}  // namespace

TEST(UnitOverlay, ATurnHasNoStrainEnergy) {
  const Geometry geometry = oblique();
  const double c = std::cos(1.1), s = std::sin(1.1);
  const GridGradient turn = on_grid(geometry, {c, 0, s}, {0, 1, 0}, {-s, 0, c});
  EXPECT_NEAR(strain_energy_kpa(turn, geometry, kYoung, kPoisson), 0, 1e-12);
}

TEST(UnitOverlay, AStretchAndAShearHaveTheEnergyOfASaintVenantKirchhoffSolid) {
  const Geometry geometry = oblique();
  const GridGradient stretch = on_grid(geometry, {1.2, 0, 0}, {0, 1, 0}, {0, 0, 1});
  const double strain = (1.2 * 1.2 - 1) / 2;
  EXPECT_NEAR(strain_energy_kpa(stretch, geometry, kYoung, kPoisson),
              (kLambda / 2 + kMu) * strain * strain, 1e-12);
  // F = 1 + g e_x e_z: E_xz = g/2, E_zz = g²/2.
  const double g = 0.4;
  const GridGradient shear = on_grid(geometry, {1, 0, 0}, {0, 1, 0}, {g, 0, 1});
  EXPECT_NEAR(strain_energy_kpa(shear, geometry, kYoung, kPoisson),
              kLambda / 2 * std::pow(g * g / 2, 2) + kMu * (g * g / 2 + std::pow(g * g / 2, 2)),
              1e-12);
}

TEST(UnitOverlay, StressIsThatOfTheSolidWhicheverWayItTurns) {
  const Geometry geometry = oblique();
  const double c = std::cos(0.7), s = std::sin(0.7);
  // F = R diag(a, b, b): S is diagonal, and Cauchy's stress has a^2 S1 / J and b^2 S2 / J.
  const double a = 1.3, b = 0.9, e1 = (a * a - 1) / 2, e2 = (b * b - 1) / 2;
  const double all = kLambda * (e1 + 2 * e2), volume = a * b * b;
  const double along = a * a * (all + 2 * kMu * e1) / volume;
  const double across = b * b * (all + 2 * kMu * e2) / volume;
  const GridGradient f = on_grid(geometry, {a * c, a * s, 0}, {-b * s, b * c, 0}, {0, 0, b});
  EXPECT_NEAR(von_mises_kpa(f, geometry, kYoung, kPoisson), along - across, 1e-12);
  // A pull of little strain: Young's modulus times it.
  const double e = 1e-6;
  const GridGradient pull =
      on_grid(geometry, {1 + e, 0, 0}, {0, 1 - kPoisson * e, 0}, {0, 0, 1 - kPoisson * e});
  EXPECT_NEAR(von_mises_kpa(pull, geometry, kYoung, kPoisson) / (kYoung * e), 1, 1e-4);
}

TEST(UnitOverlay, NothingIsPaintedWhereNothingHasChanged) {
  const auto paint = [](ScalarRange range, std::optional<double> clear) {
    return ValuePaint{{}, range, ValueColours::ascending, clear};
  };
  const ValuePaint ratio = paint(kVolumeRatios, 1);
  EXPECT_EQ(ratio.share(1), 0);
  EXPECT_GT(ratio.share(1.02), 0);
  EXPECT_LT(ratio.share(1.02), ratio.share(0.9));
  EXPECT_DOUBLE_EQ(ratio.share(0.9), ratio.share(0.5));
  EXPECT_EQ(paint({0, 10}, 0).share(0), 0);
  EXPECT_EQ(paint({0, 10}, 0).share(1), paint({0, 10}, {}).share(0));
}
