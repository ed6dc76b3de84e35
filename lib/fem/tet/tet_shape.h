// The tetrahedron with four nodes, in which displacements are linear (thesis, B.10 and B.11).
//
// B.11 writes u_i = a_i0 + a_i1 x + a_i2 y + a_i3 z at the four corners and inverts that for the
// coefficients; rows 1 to 3 of what it inverts to are the gradients g_a of the four shape functions
// N_a. The energy of B.10 is then the sum over corners a, b of u_a K_ab u_b / 2 with
//
//   K_ab = V (lambda g_a g_b^T + mu g_b g_a^T + mu (g_a . g_b) 1).
//
// Misprints of B.10 and B.11: the entries of shear in S are 1/2 - nu and not 1/8 - nu/4, against
// 1 - nu for stretch; S lacks the factor V; its columns are ordered by component, while A takes
// unknowns by corner; the coordinate in the sixth row of A^-1 is z_2, not z_3.
#pragma once

#include <array>
#include <cstddef>

#include "lib/fem/small_matrix.h"
#include "volumes/base/vec.h"

namespace supple {

/// Gradients of the shape functions in 1/mm, and the volume, which is below 0 for a tetrahedron
/// that is inside out.
struct TetShape {
  std::array<Vec3d, 4> gradient;
  double volume_mm3 = 0;
};

inline TetShape tet_shape(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  const Vec3d ab = b - a, ac = c - a, ad = d - a;
  const Vec3d by_b = ac.cross(ad), by_c = ad.cross(ab), by_d = ab.cross(ac);
  const double six_volumes = ab.dot(by_b);
  TetShape shape;
  shape.gradient[1] = by_b / six_volumes;
  shape.gradient[2] = by_c / six_volumes;
  shape.gradient[3] = by_d / six_volumes;
  shape.gradient[0] = -(shape.gradient[1] + shape.gradient[2] + shape.gradient[3]);
  shape.volume_mm3 = six_volumes / 6;
  return shape;
}

/// Adds weight (lambda g h^T + mu h g^T + mu (g . h) 1), which is the stiffness between two nodes
/// with these gradients where lambda and mu have that weight as volume.
inline void add_stiffness(double lambda, double mu, const Vec3d& g, const Vec3d& h,
                          Matrix9& block) {
  const double along = mu * g.dot(h);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      block[3 * std::size_t(i) + std::size_t(j)] += lambda * (g[i] * h[j]) + mu * (g[j] * h[i]);
    }
    block[4 * std::size_t(i)] += along;
  }
}

}  // namespace supple
