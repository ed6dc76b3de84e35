// A 3 x 3 matrix by its columns, as gradients of motions are kept.
#pragma once

#include <array>

#include "volumes/geometry/geometry.h"

namespace supple {

using Columns = std::array<Vec3d, 3>;

constexpr double kFlatDet = 1e-9;

inline Columns identity_columns() {
  return {Vec3d(1, 0, 0), Vec3d(0, 1, 0), Vec3d(0, 0, 1)};
}

inline Vec3d product(const Columns& F, const Vec3d& v) {
  return F[0] * v.x + F[1] * v.y + F[2] * v.z;
}

/// det F F^-T, which turns the normals of surfaces that F moves, areas included.
inline Columns cofactor(const Columns& F) {
  return {F[1].cross(F[2]), F[2].cross(F[0]), F[0].cross(F[1])};
}

inline double determinant(const Columns& F) {
  return F[0].dot(F[1].cross(F[2]));
}

/// Inverts F; false where F is flat.
inline bool invert(const Columns& F, Columns& inverse) {
  const Columns rows = cofactor(F);
  const double det = F[0].dot(rows[0]);
  if (!(det > kFlatDet || det < -kFlatDet)) return false;
  for (int c = 0; c < 3; ++c) inverse[c] = Vec3d(rows[0][c], rows[1][c], rows[2][c]) / det;
  return true;
}

/// The LPS form of a matrix in index space.
inline Columns in_world(const Geometry& geometry, const Columns& F) {
  Columns world;
  for (int a = 0; a < 3; ++a) {
    Vec3d unit(0);
    unit[a] = 1;
    world[a] = geometry.world_vector_from_index(product(F, geometry.index_vector_from_world(unit)));
  }
  return world;
}

}  // namespace supple
