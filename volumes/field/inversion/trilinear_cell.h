// Displacements at the corners of one lattice cell, trilinear between them.
#pragma once

#include "volumes/field/columns.h"
#include "volumes/field/inversion/cell_corners.h"
#include "volumes/grid/cell.h"

namespace supple {

/// Value and derivatives at a place.
struct CellPlace {
  Vec3d u{0, 0, 0};
  Columns along{Vec3d(0), Vec3d(0), Vec3d(0)};  // du/di, du/dj, du/dk

  /// I + grad u.
  Columns gradient() const {
    Columns F = along;
    for (int a = 0; a < 3; ++a) F[a][a] += 1;
    return F;
  }
};

/// Corner 4 x + 2 y + z.
struct TrilinearCell {
  std::array<Vec3d, 8> u;

  /// `t`: place in the cell, 0 to 1.
  CellPlace at(const Vec3d& t) const {
    CellPlace place;
    for (int n = 0; n < 8; ++n) {
      const bool hx = n & 4, hy = n & 2, hz = n & 1;
      const double wx = hx ? t.x : 1 - t.x, wy = hy ? t.y : 1 - t.y, wz = hz ? t.z : 1 - t.z;
      place.u += u[n] * (wx * wy * wz);
      place.along[0] += u[n] * ((hx ? 1 : -1) * wy * wz);
      place.along[1] += u[n] * (wx * (hy ? 1 : -1) * wz);
      place.along[2] += u[n] * (wx * wy * (hz ? 1 : -1));
    }
    return place;
  }

  /// Present places of the corners, relative to the lowest one at rest.
  CellCorners corners() const {
    CellCorners corners;
    for (int n = 0; n < 8; ++n) {
      const Vec3i step = cell_corner(n);
      for (int a = 0; a < 3; ++a) corners.p[a][n] = step[a] + u[n][a];
    }
    return corners;
  }

  bool is_translated() const {
    for (int n = 1; n < 8; ++n) {
      if (u[n] != u[0]) return false;
    }
    return true;
  }
  bool is_folded() const { return !is_translated() && supple::is_folded(corners()); }
};

}  // namespace supple
