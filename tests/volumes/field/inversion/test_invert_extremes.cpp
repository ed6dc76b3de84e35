#include <gtest/gtest.h>

#include "tests/support/field_fixtures.h"
#include "volumes/field/inversion/invert.h"
#include "volumes/field/offset_field.h"

using namespace supple;
using namespace supple::test;

TEST(ExtremesInvert, NoVoxelsGiveNoOffsets) {
  const OffsetField field = invert(Displacement{});
  EXPECT_TRUE(field.o.topology.empty());
  EXPECT_EQ(field.certificate.cells, 0);
  EXPECT_TRUE(extrapolate_into_bricks(field.o, 3).topology.empty());
}

TEST(ExtremesInvert, OneVoxelHasNoCellUntilItIsExtended) {
  const Displacement lone{
      unit_geometry({20, 20, 20}),
      field_on(box_topology(Vec3i(8), Vec3i(8)), [](const Vec3i&) { return Vec3f(2.5f, 0, -1); })};
  const OffsetField nothing = invert(lone);
  EXPECT_TRUE(nothing.o.topology.empty());
  EXPECT_EQ(nothing.certificate.cells, 0);

  const OffsetField extended = invert(extend(lone, dilate(lone.u.topology, 1)));
  EXPECT_EQ(extended.certificate.cells, 8);
  EXPECT_TRUE(extended.o.topology == box_topology({10, 7, 6}, {11, 9, 8}));
  for_each_slot(extended.o.topology, [&](const Vec3i&, std::size_t slot) {
    EXPECT_EQ(extended.o.vectors.at(slot), Vec3f(-2.5f, 0, 1));
  });
}

TEST(ExtremesInvert, ASheetOneVoxelThickHasNoCellsUntilItIsExtended) {
  Displacement sheet{unit_geometry({30, 30, 30}),
                     field_on(box_topology({2, 2, 15}, {25, 25, 15}), [](const Vec3i& v) {
                       return Vec3f(0, 0, 0.02f * float(v.x * v.x) / 25);
                     })};
  EXPECT_EQ(invert(sheet).certificate.cells, 0);
  const Displacement thick = extend(sheet, dilate(sheet.u.topology, 1));
  const OffsetField field = invert(thick);
  EXPECT_GT(field.o.topology.active_count(), 24 * 24 * 2);
  EXPECT_LE(max_residual(thick.u, field.o), 1e-4);
}

TEST(ExtremesInvert, ADisplacementOfTenThousandVoxelsKeepsTheResidual) {
  // Floats of this size resolve 2^-10 voxel; smooth variation on top of the shift.
  const BrickTopology where = box_topology(Vec3i(0), Vec3i(20));
  const Displacement far = displacement_on(where, [](const Vec3i& v) {
    return Vec3f(10000 + 0.25f * float(v.y), -10000 + 0.125f * float(v.x), 9999.5f);
  });
  const OffsetField field = invert(far);
  EXPECT_GT(field.o.topology.active_count(), 20 * 20 * 18);
  EXPECT_LE(field.certificate.residual_max, 1e-3);
  EXPECT_LE(max_residual(far.u, field.o), 1e-3);
}

TEST(ExtremesInvert, FlatAndCollapsedCellsAreFoldsNotFailures) {
  // Everything lands in one plane, then on one line, then in one point, all through the lattice.
  for (int collapsed = 1; collapsed <= 3; ++collapsed) {
    const Displacement squashed =
        displacement_on(box_topology(Vec3i(0), Vec3i(6)), [&](const Vec3i& v) {
          return Vec3f(float(3 - v.x), collapsed > 1 ? float(3 - v.y) : 0,
                       collapsed > 2 ? float(3 - v.z) : 0);
        });
    const OffsetField field = invert(squashed);
    EXPECT_EQ(field.certificate.folded_cells, 6 * 6 * 6);
    EXPECT_EQ(field.certificate.min_det, 0);
    Vec3f o;
    ASSERT_TRUE(field.o.at({3, 3, 3}, o)) << collapsed;
    EXPECT_LE(max_residual(squashed.u, field.o), 1e-3);
  }
}

TEST(ExtremesInvert, NearlyFlatCellsAreStillInverted) {
  for (const float height : {1e-2f, 1e-4f, 1e-6f}) {
    const Displacement thin =
        displacement_on(box_topology(Vec3i(0), Vec3i(12)), [&](const Vec3i& v) {
          return Vec3f(0.25f * float(v.y), 0, (height - 1) * (float(v.z) - 6));
        });
    const OffsetField field = invert(thin);
    EXPECT_GT(field.certificate.min_det, 0);
    EXPECT_LT(field.certificate.min_det, 2 * height);
    EXPECT_EQ(field.o.topology.active_bounds().lo.z, 6);
    EXPECT_EQ(field.o.topology.active_bounds().hi.z, 6);
    EXPECT_LE(max_residual(thin.u, field.o), 1e-4) << height;
  }
}

TEST(ExtremesInvert, AMirroredBodyIsFoldedEverywhereAndStillSolved) {
  const Displacement mirrored =
      displacement_on(box_topology(Vec3i(0), Vec3i(8)),
                      [](const Vec3i& v) { return Vec3f(8 - 2 * float(v.x), 0, 0); });
  const OffsetField field = invert(mirrored);
  EXPECT_EQ(field.certificate.folded_cells, 512);
  EXPECT_EQ(field.certificate.min_det, -1);
  Vec3f o;
  ASSERT_TRUE(field.o.at({1, 4, 4}, o));
  EXPECT_NEAR(o.x, 6, 1e-5);
}
