// Stiffness of one voxel as a hexahedron, in parts that hold for all voxels of a geometry:
//
//   K = mu M + kappa A,     mu = E / (2 (1 + nu)),  kappa = E / (3 (1 - 2 nu))
//   M = integral 2 dev(e):dev(e),   A = integral (tr e)^2
//
// with trilinear shape functions. The Jacobian of a voxel is constant, also where the geometry is
// sheared, so gradients are polynomials and the integrals are exact by 2 x 2 x 2 Gauss points.
//
// Dilatation::mean replaces tr e by its mean over the element (mean dilatation, B-bar; Hughes 1980,
// Simo, Taylor and Pister 1985; the displacement of the mixed element Q1-P0 with the pressure
// condensed): A = V b b^T. It does not lock for nu -> 1/2 and is used for all nu.
// Dilatation::pointwise is the plain hexahedron with full integration; it locks from nu = 0.45 on
// and is there to compare with other programs.
//
// In Hadamard modes (values at corners times signs of 1, xi, eta, zeta, xi eta, ...) the matrix
// falls into blocks: 3 x 3 of zeros, 9 x 9 of linear, 9 x 9 of bilinear and 3 x 3 of trilinear
// modes, since gradients of different modes are orthogonal monomials. That is a third of the work.
//
// The consistent mass, integral N N, is diagonal in these modes: V times 1, 1/3, 1/9 and 1/27.
// Galerkin's product of eight alike voxels is that of the cell, whose functions are theirs, too.
#pragma once

#include <array>

#include "lib/fem/elastic_law.h"
#include "volumes/base/vec.h"

namespace supple {

/// Row and column 3 * corner + component; corner 4 di + 2 dj + dk of the voxel, components LPS.
using Matrix24 = std::array<std::array<double, 24>, 24>;
using Vector24 = std::array<double, 24>;

/// Modes in the order of the blocks: 1 | xi eta zeta | xi eta, xi zeta, eta zeta | xi eta zeta.
/// They are corner numbers: the bits are the coordinates that the mode's monomial has.
constexpr std::array<int, 8> kModes{0, 4, 2, 1, 6, 5, 3, 7};

/// Parts in mm (per kPa and mm of displacement: mN).
struct ElementMatrix {
  Matrix24 shear;     // M
  Matrix24 bulk;      // A
  Matrix24 mass;      // integral N N, in mm^3
  Vector24 gradient;  // b: the mean of tr e is b . u, in 1/mm
  double volume_mm3;
  Dilatation dilatation;
};
ElementMatrix element_matrix(const std::array<Vec3d, 3>& axes_mm, Dilatation dilatation);

/// Gradients du_a/dx_d in LPS at a point of the reference cube -1 ... 1 per unit of a corner's
/// displacement: [corner][d], in 1/mm.
std::array<Vec3d, 8> shape_gradients(const std::array<Vec3d, 3>& axes_mm, const Vec3d& reference);

/// H K H^T / 64, H the Hadamard matrix [mode][corner] in the order of kModes, of which H^T H = 8:
/// K = H^T (H K H^T / 64) H.
Matrix24 in_modes(const Matrix24& matrix);

/// P^T K P of a coarse element for the child at place `child` (bits as of corners), whose corners
/// are the parent's by trilinear interpolation.
Matrix24 on_parent(const Matrix24& child_matrix, int child);

/// Weights of a parent's corners at point (i, j, k) of 0 ... 2 or 0 ... 4 steps along each edge.
std::array<double, 8> corner_weights(const Vec3d& fraction);

/// Geometry that the Gauss points of all voxels share (finite_kernel.h).
struct GaussGeometry {
  double slope[3][3];  // [axis][direction]: gradients of modes along the axes to LPS, 1/mm
  double volume_mm3;
  bool is_pointwise;

  GaussGeometry(const std::array<Vec3d, 3>& axes_mm, Dilatation dilatation);
};

}  // namespace supple
