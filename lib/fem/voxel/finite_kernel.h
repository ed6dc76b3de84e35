// Forces and tangent products of eight elements at finite strain, one per vector lane: the inner
// loop of finite_strain.h, which has the equations.
//
// Gradients of trilinear functions over the reference cube -1 ... 1 do not vary along their own
// axis, so that 2 x 2 x 2 Gauss points share four values per axis, and these are sums of Hadamard
// modes (element_matrix.h). Some 2000 multiply-adds per element for forces, 3500 for a product.
#pragma once

#include <cstdint>

#include "lib/fem/voxel/element_matrix.h"
#include "lib/fem/voxel/group_kernel.h"

namespace supple {

using DoubleLanes = ElementLanes<double>;

struct LaneModuli {
  DoubleLanes shear, bulk;  // kPa; 0 in lanes without an element
  DoubleLanes swelling{};   // kPa, outwards
};

/// Row a of a matrix per lane is component a, column d direction d.
struct LaneMatrix {
  DoubleLanes at[3][3];
};

inline DoubleLanes contract(const LaneMatrix& a, const LaneMatrix& b) {
  DoubleLanes sum{};
  for (int n = 0; n < 3; ++n) {
    for (int m = 0; m < 3; ++m) sum += a.at[n][m] * b.at[n][m];
  }
  return sum;
}

/// cof(A) with rows that are cross products; the derivative of det A.
inline LaneMatrix cofactor(const LaneMatrix& a) {
  LaneMatrix out;
  for (int n = 0; n < 3; ++n) {
    const DoubleLanes *b = a.at[(n + 1) % 3], *c = a.at[(n + 2) % 3];
    for (int m = 0; m < 3; ++m) {
      out.at[n][m] = b[(m + 1) % 3] * c[(m + 2) % 3] - b[(m + 2) % 3] * c[(m + 1) % 3];
    }
  }
  return out;
}
/// The change of cof(A) as A changes by D.
inline LaneMatrix cofactor_change(const LaneMatrix& a, const LaneMatrix& d) {
  LaneMatrix out;
  for (int n = 0; n < 3; ++n) {
    const int p = (n + 1) % 3, q = (n + 2) % 3;
    for (int m = 0; m < 3; ++m) {
      const int i = (m + 1) % 3, j = (m + 2) % 3;
      out.at[n][m] = d.at[p][i] * a.at[q][j] - d.at[p][j] * a.at[q][i] + a.at[p][i] * d.at[q][j] -
                     a.at[p][j] * d.at[q][i];
    }
  }
  return out;
}

/// det(1 + H) - 1 without the cancellation of small H.
inline DoubleLanes volume_change(const LaneMatrix& h) {
  const DoubleLanes trace = h.at[0][0] + h.at[1][1] + h.at[2][2];
  DoubleLanes minors{};
  for (int n = 0; n < 3; ++n) {
    const int m = (n + 1) % 3;
    minors += h.at[n][n] * h.at[m][m] - h.at[n][m] * h.at[m][n];
  }
  const LaneMatrix cofactors = cofactor(h);
  DoubleLanes determinant{};
  for (int m = 0; m < 3; ++m) determinant += h.at[0][m] * cofactors.at[0][m];
  return trace + minors + determinant;
}

/// (1 + j)^(-1/3) - 1 for j > -1, to rounding also where j is small: Newton's method from a guess
/// by the exponent's third, and a last step in the difference from 1.
inline DoubleLanes inverse_cube_root_less_one(const DoubleLanes& j) {
  using Bits = ElementLanes<std::int64_t>;
  const DoubleLanes J = j + 1;
  const Bits bits = reinterpret_cast<const Bits&>(J);
  const Bits guess = 0x553ef0ff289dd796 - bits / 3;
  DoubleLanes y = reinterpret_cast<const DoubleLanes&>(guess);
  for (int n = 0; n < 4; ++n) y = y * (4 - J * y * y * y) / 3;
  const DoubleLanes d = y - 1;
  const DoubleLanes cube = d * (3 + d * (3 + d));  // y^3 - 1
  return d - (cube + j * (1 + cube)) / (3 * y * y * J);
}

/// Values per axis of the reference cube at the four pairs of the other coordinates.
struct AxisSums {
  DoubleLanes of[3][4][3];  // [axis][pair][component]
};
constexpr int kAxisMode[3] = {4, 2, 1};
constexpr int kOtherModes[3][2] = {{2, 1}, {4, 1}, {4, 2}};
constexpr double kGauss = 0.57735026918962576451;  // 1 / sqrt(3)

constexpr int pair_of(int point, int axis) {
  return ((point & kOtherModes[axis][0]) != 0 ? 2 : 0) +
         ((point & kOtherModes[axis][1]) != 0 ? 1 : 0);
}

/// Gradients along the axes at Gauss points, of modes [3 mode + component].
inline void gradients_of_modes(const DoubleLanes* modes, AxisSums& out) {
  for (int axis = 0; axis < 3; ++axis) {
    const int own = kAxisMode[axis], p = kOtherModes[axis][0], q = kOtherModes[axis][1];
    for (int a = 0; a < 3; ++a) {
      const DoubleLanes along_p = kGauss * modes[3 * (own | p) + a];
      const DoubleLanes along_q = kGauss * modes[3 * (own | q) + a];
      const DoubleLanes both = kGauss * kGauss * modes[3 * 7 + a];
      const DoubleLanes lo = modes[3 * own + a] - along_p, hi = modes[3 * own + a] + along_p;
      out.of[axis][0][a] = lo - (along_q - both);
      out.of[axis][1][a] = lo + (along_q - both);
      out.of[axis][2][a] = hi - (along_q + both);
      out.of[axis][3][a] = hi + (along_q + both);
    }
  }
}
/// Applies the transpose of that.
inline void modes_of_gradients(const AxisSums& sums, DoubleLanes* modes) {
  for (int n = 0; n < 24; ++n) modes[n] = DoubleLanes{};
  for (int axis = 0; axis < 3; ++axis) {
    const int own = kAxisMode[axis], p = kOtherModes[axis][0], q = kOtherModes[axis][1];
    for (int a = 0; a < 3; ++a) {
      const auto& of = sums.of[axis];
      const DoubleLanes lo = of[0][a] + of[1][a], hi = of[2][a] + of[3][a];
      const DoubleLanes lo_q = of[1][a] - of[0][a], hi_q = of[3][a] - of[2][a];
      modes[3 * own + a] += lo + hi;
      modes[3 * (own | p) + a] += kGauss * (hi - lo);
      modes[3 * (own | q) + a] += kGauss * (lo_q + hi_q);
      modes[3 * 7 + a] += kGauss * kGauss * (hi_q - lo_q);
    }
  }
}

inline LaneMatrix gradient_at(const GaussGeometry& geometry, const AxisSums& sums, int point) {
  LaneMatrix out;
  for (int a = 0; a < 3; ++a) {
    for (int d = 0; d < 3; ++d) {
      DoubleLanes sum = geometry.slope[0][d] * sums.of[0][pair_of(point, 0)][a];
      sum += geometry.slope[1][d] * sums.of[1][pair_of(point, 1)][a];
      sum += geometry.slope[2][d] * sums.of[2][pair_of(point, 2)][a];
      out.at[a][d] = sum;
    }
  }
  return out;
}
/// The transpose: adds the forces of a stress P, times the point's volume.
inline void add_stress(const GaussGeometry& geometry, const LaneMatrix& stress, int point,
                       AxisSums& sums) {
  const double weight = geometry.volume_mm3 / 8;
  for (int axis = 0; axis < 3; ++axis) {
    for (int a = 0; a < 3; ++a) {
      DoubleLanes sum = geometry.slope[axis][0] * stress.at[a][0];
      sum += geometry.slope[axis][1] * stress.at[a][1];
      sum += geometry.slope[axis][2] * stress.at[a][2];
      sums.of[axis][pair_of(point, axis)][a] += weight * sum;
    }
  }
}

inline LaneMatrix with_identity(LaneMatrix h) {
  for (int a = 0; a < 3; ++a) h.at[a][a] += 1;
  return h;
}

/// theta - 1 of displacements in modes.
inline DoubleLanes mean_volume_change(const GaussGeometry& geometry, const DoubleLanes* modes) {
  AxisSums sums;
  gradients_of_modes(modes, sums);
  DoubleLanes mean{};
  for (int p = 0; p < 8; ++p) mean += volume_change(gradient_at(geometry, sums, p)) / 8;
  return mean;
}

/// x: displacements of the corners in mm, which become the forces K(u) in mN. `energy`: in uJ;
/// `smallest`: det F at the Gauss points, where it is not above 0 the rest means nothing.
inline void finite_forces(const GaussGeometry& geometry, const LaneModuli& moduli, DoubleLanes* x,
                          DoubleLanes& energy, DoubleLanes& smallest) {
  to_modes(x);
  AxisSums in, out{};
  gradients_of_modes(x, in);
  LaneMatrix h[8];
  DoubleLanes change[8], mean{};
  for (int p = 0; p < 8; ++p) {
    h[p] = gradient_at(geometry, in, p);
    change[p] = volume_change(h[p]);
    mean += change[p] / 8;
    const DoubleLanes J = change[p] + 1;
    if (p == 0) smallest = J;
    smallest = J < smallest ? J : smallest;
  }
  energy = DoubleLanes{};
  for (int p = 0; p < 8; ++p) {
    const LaneMatrix f = with_identity(h[p]), c = cofactor(f);
    const DoubleLanes j = geometry.is_pointwise ? change[p] : mean;
    const DoubleLanes root = inverse_cube_root_less_one(change[p]);
    const DoubleLanes a = moduli.shear * (1 + root) * (1 + root);
    // tr(F^T F) - 3 and J^(-2/3) tr(F^T F) - 3.
    const DoubleLanes excess =
        2 * (h[p].at[0][0] + h[p].at[1][1] + h[p].at[2][2]) + contract(h[p], h[p]);
    const DoubleLanes squared = root * (2 + root);
    const DoubleLanes isochoric = excess * (1 + squared) + 3 * squared;
    energy += moduli.shear * isochoric / 2 + (moduli.bulk * j / 2 - moduli.swelling) * j;
    const DoubleLanes b =
        moduli.bulk * j - moduli.swelling - a * (excess + 3) / (3 * (change[p] + 1));
    LaneMatrix stress;
    for (int n = 0; n < 3; ++n) {
      for (int m = 0; m < 3; ++m) stress.at[n][m] = a * f.at[n][m] + b * c.at[n][m];
    }
    add_stress(geometry, stress, p, out);
  }
  energy *= geometry.volume_mm3 / 8;
  modes_of_gradients(out, x);
  from_modes(x);
}

/// x: changes of the displacements u of the corners, which become the changes of their forces. `u`
/// is used up.
inline void finite_tangent(const GaussGeometry& geometry, const LaneModuli& moduli, DoubleLanes* u,
                           DoubleLanes* x) {
  to_modes(u);
  to_modes(x);
  AxisSums in, in_change, out{};
  gradients_of_modes(u, in);
  gradients_of_modes(x, in_change);
  LaneMatrix f[8], d[8];
  DoubleLanes change[8], slope[8], mean{}, mean_slope{};
  for (int p = 0; p < 8; ++p) {
    const LaneMatrix h = gradient_at(geometry, in, p);
    f[p] = with_identity(h);
    d[p] = gradient_at(geometry, in_change, p);
    change[p] = volume_change(h);
    slope[p] = contract(cofactor(f[p]), d[p]);
    mean += change[p] / 8;
    mean_slope += slope[p] / 8;
  }
  for (int p = 0; p < 8; ++p) {
    const LaneMatrix c = cofactor(f[p]), c_change = cofactor_change(f[p], d[p]);
    const DoubleLanes j = geometry.is_pointwise ? change[p] : mean;
    const DoubleLanes j_slope = geometry.is_pointwise ? slope[p] : mean_slope;
    const DoubleLanes y = 1 + inverse_cube_root_less_one(change[p]);
    const DoubleLanes inverse_J = y * y * y;
    const DoubleLanes a = moduli.shear * y * y;
    const DoubleLanes a_slope = a * slope[p] * inverse_J * (-2.0 / 3);
    const DoubleLanes trace = contract(f[p], f[p]);
    const DoubleLanes q = a * trace * inverse_J / 3;
    const DoubleLanes q_slope =
        (a_slope * trace + 2 * a * contract(f[p], d[p])) * inverse_J / 3 - q * slope[p] * inverse_J;
    const DoubleLanes b = moduli.bulk * j - moduli.swelling - q;
    const DoubleLanes b_slope = moduli.bulk * j_slope - q_slope;
    LaneMatrix stress;
    for (int n = 0; n < 3; ++n) {
      for (int m = 0; m < 3; ++m) {
        stress.at[n][m] = a * d[p].at[n][m] + a_slope * f[p].at[n][m] + b_slope * c.at[n][m] +
                          b * c_change.at[n][m];
      }
    }
    add_stress(geometry, stress, p, out);
  }
  modes_of_gradients(out, x);
  from_modes(x);
}

}  // namespace supple
