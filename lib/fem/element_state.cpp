#include "lib/fem/element_state.h"

#include <algorithm>
#include <cmath>

#include "volumes/base/units.h"

namespace supple {

/// Solves the cubic by the angle of its trigonometric solution (Smith 1961).
std::array<double, 3> eigenvalues(const SymmetricTensor& t) {
  const double mean = trace(t) / 3;
  const double a = t[0] - mean, b = t[1] - mean, c = t[2] - mean;
  const double off = t[3] * t[3] + t[4] * t[4] + t[5] * t[5];
  const double p = std::sqrt((a * a + b * b + c * c + 2 * off) / 6);
  if (p == 0) return {mean, mean, mean};
  const double determinant =
      a * (b * c - t[4] * t[4]) - t[3] * (t[3] * c - t[4] * t[5]) + t[5] * (t[3] * t[4] - b * t[5]);
  const double angle = std::acos(std::clamp(determinant / (2 * p * p * p), -1.0, 1.0)) / 3;
  const double largest = mean + 2 * p * std::cos(angle);
  const double smallest = mean + 2 * p * std::cos(angle + 2 * kPi / 3);
  return {largest, 3 * mean - largest - smallest, smallest};
}

SymmetricTensor symmetric(const Matrix9& a) {
  return {a[0], a[4], a[8], (a[1] + a[3]) / 2, (a[5] + a[7]) / 2, (a[6] + a[2]) / 2};
}

void set_finite(const Matrix9& f, double shear_kpa, double mean_kpa, ElementState& state) {
  const Matrix9 rotation = rotation_of(f);
  state.strain = symmetric(times_transposed(f, rotation));
  for (std::size_t n = 0; n < 3; ++n) state.strain[n] -= 1;
  const Vec3d sine = axial(rotation);
  const double angle = std::atan2(sine.length(), (rotation[0] + rotation[4] + rotation[8] - 1) / 2);
  state.rotation_rad = sine.length() > 0 ? sine * (angle / sine.length()) : Vec3d(0);
  const double J = state.det_f = determinant_of(f, cofactors(f));
  const double shear = shear_kpa * std::pow(J, -5.0 / 3);
  const SymmetricTensor b = symmetric(times_transposed(f, f));
  for (std::size_t n = 0; n < 6; ++n) state.stress_kpa[n] = shear * b[n];
  const double volumetric = mean_kpa - shear * trace(b) / 3;
  for (std::size_t n = 0; n < 3; ++n) state.stress_kpa[n] += volumetric;
}

double value_of(const ElementState& state, FemQuantity quantity) {
  const SymmetricTensor& s = state.stress_kpa;
  switch (quantity) {
    case FemQuantity::von_mises: {
      const double a = s[0] - s[1], b = s[1] - s[2], c = s[2] - s[0];
      const double off = s[3] * s[3] + s[4] * s[4] + s[5] * s[5];
      return std::sqrt((a * a + b * b + c * c) / 2 + 3 * off);
    }
    case FemQuantity::pressure:
      return -trace(s) / 3;
    case FemQuantity::principal_1:
      return eigenvalues(s)[0];
    case FemQuantity::principal_2:
      return eigenvalues(s)[1];
    case FemQuantity::principal_3:
      return eigenvalues(s)[2];
    case FemQuantity::energy_density:
      return state.energy_density_kpa;
    case FemQuantity::strain_1:
      return eigenvalues(state.strain)[0];
    case FemQuantity::strain_3:
      return eigenvalues(state.strain)[2];
    case FemQuantity::volume_strain:
      break;
  }
  return state.volume_strain;
}

void LargestMotion::take(const LargestMotion& other) {
  if (other.rotation_deg > rotation_deg) {
    rotation_deg = other.rotation_deg;
    turned = other.turned;
  }
  if (other.strain > strain) {
    strain = other.strain;
    strained = other.strained;
  }
  beyond += other.beyond;
  smallest_det_f = std::min(smallest_det_f, other.smallest_det_f);
}

}  // namespace supple
