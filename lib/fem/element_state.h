// Strain, stress and turn of an element, and the quantities that are told of it.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <utility>

#include "lib/fem/fem_report.h"
#include "lib/fem/small_matrix.h"
#include "volumes/base/vec.h"

namespace supple {

/// xx, yy, zz, xy, yz, zx in LPS; shear as tensor components.
using SymmetricTensor = std::array<double, 6>;
inline double trace(const SymmetricTensor& t) {
  return t[0] + t[1] + t[2];
}
/// The symmetric part of a gradient.
SymmetricTensor symmetric(const Matrix9& a);
/// Returns the eigenvalues in descending order.
std::array<double, 3> eigenvalues(const SymmetricTensor& tensor);

struct ElementState {
  SymmetricTensor strain, stress_kpa;
  double volume_strain;       // of the element
  double det_f;               // at the centre
  Vec3d rotation_rad;         // half the curl of u, at the centre
  double energy_density_kpa;  // mean of the element, per volume at rest; kPa are mJ/cm^3
};

/// Writes strain, turn and det F of a deformation F of any size, and the stress of neo-Hookean
/// tissue, mu J^(-5/3) dev(F F^T) + mean 1, of which `mean_kpa` is what resists volume.
void set_finite(const Matrix9& f, double shear_kpa, double mean_kpa, ElementState& state);

double value_of(const ElementState& state, FemQuantity quantity);

}  // namespace supple
