// The deformed corners of one lattice cell: folds, and the tetrahedra between the corners.
#pragma once

#include "volumes/base/vec.h"

namespace supple {

/// Pose corners of a cell relative to its lowest lattice corner; corner 4 x + 2 y + z.
struct CellCorners {
  double p[3][8];  // [component][corner]

  Vec3d corner(int n) const { return {p[0][n], p[1][n], p[2][n]}; }
};

/// Smallest det(I + grad u) over the eight corners.
double min_corner_det(const CellCorners& corners);

/// True if det(I + grad u) is 0 or below anywhere in the cell, though it may be positive at all
/// corners: its 27 coefficients in Bernstein's basis bound it, and halves of the cell bound it more
/// closely, down to 1/64 of an edge. Parts that are still undecided there count as folded.
bool is_folded(const CellCorners& corners);

/// True when `x` lies in one of the six tetrahedra around the cell's diagonal (Kuhn's split),
/// borders included.
bool covered_by_tetrahedra(const CellCorners& corners, const Vec3d& x);

}  // namespace supple
