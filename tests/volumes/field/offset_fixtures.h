// Warps, oblique grids and comparisons that the tests of this folder share.
#pragma once

#include <cmath>
#include <functional>
#include <optional>

#include <gtest/gtest.h>

#include "tests/support/field_fixtures.h"
#include "volumes/field/dense/warp.h"
#include "volumes/field/offset_field.h"

namespace supple::test {

/// Fails the test unless offsets and certificates are the same.
inline void expect_equal(const OffsetField& a, const OffsetField& b) {
  ASSERT_TRUE(a.o.topology == b.o.topology);
  EXPECT_EQ(a.o.vectors, b.o.vectors);
  EXPECT_EQ(a.certificate.residual_max, b.certificate.residual_max);
  EXPECT_EQ(a.certificate.residual_p999, b.certificate.residual_p999);
  EXPECT_EQ(a.certificate.cells, b.certificate.cells);
  EXPECT_EQ(a.certificate.folded_cells, b.certificate.folded_cells);
  EXPECT_EQ(a.certificate.folded_air_cells, b.certificate.folded_air_cells);
  EXPECT_EQ(a.certificate.overlapped_voxels, b.certificate.overlapped_voxels);
  EXPECT_EQ(a.certificate.min_det, b.certificate.min_det);
  EXPECT_EQ(a.certificate.unresolved_voxels, b.certificate.unresolved_voxels);
  EXPECT_EQ(a.certificate.unresolved, b.certificate.unresolved);
}

inline Vec3d random_place(std::mt19937& random, double lo, double hi) {
  std::uniform_real_distribution<double> coordinate(lo, hi);
  return {coordinate(random), coordinate(random), coordinate(random)};
}

/// Anisotropic, rotated about two axes, off the origin.
inline Geometry oblique_geometry(const Vec3i& dims, const Vec3d& origin, const Vec3d& spacing,
                                 double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {dims,
          origin,
          {Vec3d(c, s, 0) * spacing.x, Vec3d(-s * c, c * c, s) * spacing.y,
           Vec3d(s * s, -s * c, c) * spacing.z}};
}

/// Vectors by LPS places.
inline Warp warp_of(const Geometry& geometry, const std::optional<WarpDirection>& direction,
                    const std::function<Vec3d(const Vec3d&)>& vector) {
  std::vector<Vec3f> vectors;
  const Vec3i& dims = geometry.dims();
  for (int k = 0; k < dims.z; ++k) {
    for (int j = 0; j < dims.y; ++j) {
      for (int i = 0; i < dims.x; ++i) {
        vectors.push_back(Vec3f(vector(geometry.world_from_index(Vec3d(i, j, k)))));
      }
    }
  }
  return {"w.nrrd", geometry, direction, vectors};
}

}  // namespace supple::test
