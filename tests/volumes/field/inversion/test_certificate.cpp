// The certificate's figures against counts and quantiles taken one by one: none of them zero, none
// equal to its neighbour.
#include <limits>

#include <gtest/gtest.h>

#include "tests/volumes/field/offset_fixtures.h"
#include "volumes/field/inversion/inversion_certificate.h"
#include "volumes/field/inversion/invert.h"
#include "volumes/grid/cell.h"

namespace supple::test {
namespace {

/// A field that did not move, and offsets that miss it by these lengths.
ResidualHistogram residuals_of(const std::vector<float>& misses) {
  const BrickTopology where = box_topology(Vec3i(0), Vec3i(15));
  const VectorBricks still = field_on(where, [](const Vec3i&) { return Vec3f(0); });
  std::size_t next = 0;
  const BrickTopology nodes =
      topology_where(Vec3i(1), Vec3i(14), [&](const Vec3i&) { return next++ < misses.size(); });
  next = 0;
  const VectorBricks o = field_on(nodes, [&](const Vec3i&) { return Vec3f(misses[next++], 0, 0); });
  EXPECT_EQ(next, misses.size());
  return measure_residuals(still, Vec3i(16), o, FoldedCells());
}

TEST(UnitInversionCertificate, PercentilesAreThoseOfTheResiduals) {
  std::vector<float> misses(900, 0.001f);
  misses.insert(misses.end(), 90, 0.01f);
  misses.insert(misses.end(), 9, 0.1f);
  misses.push_back(0.7f);
  std::shuffle(misses.begin(), misses.end(), std::mt19937(41));
  const ResidualHistogram histogram = residuals_of(misses);
  const auto expect_percentile = [&](double part, double expected) {
    EXPECT_GE(histogram.percentile(part), expected * (1 - 1e-6)) << part;
    EXPECT_LE(histogram.percentile(part), expected * 1.125 * (1 + 1e-6)) << part;
  };
  expect_percentile(0.5, 0.001);
  expect_percentile(0.9, 0.001);
  expect_percentile(0.95, 0.01);
  expect_percentile(0.99, 0.01);
  expect_percentile(0.999, 0.1);
  EXPECT_EQ(histogram.percentile(1), double(0.7f));
  EXPECT_EQ(histogram.max(), 0.7f);
}

TEST(UnitInversionCertificate, SourcesFarApartAreMeasuredOffFoldsAndUnknownOnesAreInfinitelyOff) {
  // Two bodies, both seen from one brick: no window holds both.
  const auto is_body = [](const Vec3i& v) { return v.x < 10 || v.x >= 60; };
  const BrickTopology where = topology_where(Vec3i(0), Vec3i(69), [&](const Vec3i& v) {
    return is_body(v) && v.x / 60 == v.y / 60 && v.x / 60 == v.z / 60 && v.y % 60 < 10 &&
           v.z % 60 < 10;
  });
  const VectorBricks u =
      field_on(where, [](const Vec3i& v) { return v.x < 10 ? Vec3f(0) : Vec3f(-60.5f); });
  const auto max_of = [&](const Vec3f& far, bool folded) {
    const BrickTopology nodes = box_topology({2, 2, 2}, {3, 3, 3});
    const VectorBricks o =
        field_on(nodes, [&](const Vec3i& v) { return v == Vec3i(2) ? far : Vec3f(0.25f, 0, 0); });
    FoldedCells folds;
    const Vec3i cell(62);
    BrickMask mask{};
    mask_set(mask, brick_offset(cell));
    if (folded) folds.add(where.find(cell), mask);
    return measure_residuals(u, Vec3i(70), o, folds).max();
  };
  EXPECT_NEAR(max_of(Vec3f(60), false), 0.5 * std::sqrt(3.0), 1e-6);
  EXPECT_EQ(max_of(Vec3f(60), true), 0.25);
  EXPECT_EQ(max_of(Vec3f(40), false), std::numeric_limits<float>::infinity());
}

TEST(PropertyInversionCertificate, ThePercentileIsThatOfTheNodesAndLiesBetweenMedianAndMaximum) {
  std::mt19937 random(42);
  InvertParams rough;  // leaves residuals that differ
  rough.residual_tolerance_voxels = 0.3;
  const Displacement noisy = displacement_on(box_topology(Vec3i(0), Vec3i(23)), [&](const Vec3i&) {
    return random_vector(random, 0.15f);
  });
  const OffsetField field = invert(noisy, rough);
  ASSERT_EQ(field.certificate.folded_cells, 0);
  std::vector<double> residuals;
  for_each_slot(field.o.topology, [&](const Vec3i& x, std::size_t slot) {
    const Vec3d o(field.o.vectors.at(slot));
    Vec3d moved;
    if (noisy.u.sample(Vec3d(x) + o, moved)) residuals.push_back((o + moved).length());
  });
  std::sort(residuals.begin(), residuals.end());
  const auto exact = [&](double part) {
    return residuals[std::size_t(std::ceil(part * double(residuals.size()))) - 1];
  };
  EXPECT_LT(1.2 * exact(0.5), exact(0.999));
  EXPECT_LT(1.2 * exact(0.99), exact(0.999));
  EXPECT_LT(1.2 * exact(0.999), residuals.back());
  EXPECT_NEAR(field.certificate.residual_max, residuals.back(), 1e-6);
  EXPECT_GE(field.certificate.residual_p999, exact(0.999) * (1 - 1e-3));
  EXPECT_LE(field.certificate.residual_p999, exact(0.999) * 1.125 * (1 + 1e-3));
}

TEST(PropertyInversionCertificate, AFoldReachesIntoAirWithAnyOfItsEightCorners) {
  const BrickTopology where = box_topology(Vec3i(0), Vec3i(8));
  const Displacement mirrored =
      displacement_on(where, [](const Vec3i& v) { return Vec3f(8 - 2 * float(v.x), 0, 0); });
  std::mt19937 random(43);
  for (int n = 0; n < 8; ++n) {
    const BrickTopology material =
        topology_where(Vec3i(0), Vec3i(8), [&](const Vec3i&) { return random() % 16 != 0; });
    std::int64_t expected = 0;
    for_each_slot(box_topology(Vec3i(0), Vec3i(7)), [&](const Vec3i& cell, std::size_t) {
      bool in_air = false;
      for (int c = 0; c < 8; ++c) in_air |= !material.is_active(cell + cell_corner(c));
      expected += in_air;
    });
    InvertParams params;
    params.material = &material;
    const InversionCertificate found = invert(mirrored, params).certificate;
    EXPECT_GT(expected, 0);
    EXPECT_LT(expected, 512);
    EXPECT_EQ(found.folded_air_cells, expected);
    EXPECT_EQ(found.folded_cells, 512);
    EXPECT_EQ(found.cells, 512);
  }
}

}  // namespace
}  // namespace supple::test
