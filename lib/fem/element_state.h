// Strain, stress and turn of an element, and the quantities that are told of it.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <utility>

#include "volumes/base/vec.h"

namespace supple {

/// xx, yy, zz, xy, yz, zx in LPS; shear as tensor components.
using SymmetricTensor = std::array<double, 6>;
inline double trace(const SymmetricTensor& t) {
  return t[0] + t[1] + t[2];
}
/// Returns the eigenvalues in descending order.
std::array<double, 3> eigenvalues(const SymmetricTensor& tensor);

struct ElementState {
  SymmetricTensor strain, stress_kpa;
  double volume_strain;       // of the element
  Vec3d rotation_rad;         // half the curl of u, at the centre
  double energy_density_kpa;  // mean of the element, per volume at rest; kPa are mJ/cm^3
};

enum class FemQuantity {
  von_mises,    // kPa
  pressure,     // kPa, positive where it is compressed
  principal_1,  // kPa, the largest principal stress
  principal_2,
  principal_3,
  energy_density,  // kPa
  strain_1,        // the largest principal strain
  strain_3,        // the smallest
  volume_strain
};
constexpr std::array<std::pair<FemQuantity, std::string_view>, 9> kFemQuantities{
    {{FemQuantity::von_mises, "von_mises"},
     {FemQuantity::pressure, "pressure"},
     {FemQuantity::principal_1, "principal_1"},
     {FemQuantity::principal_2, "principal_2"},
     {FemQuantity::principal_3, "principal_3"},
     {FemQuantity::energy_density, "energy_density"},
     {FemQuantity::strain_1, "strain_1"},
     {FemQuantity::strain_3, "strain_3"},
     {FemQuantity::volume_strain, "volume_strain"}}};
double value_of(const ElementState& state, FemQuantity quantity);

/// Angles of rotation, and principal strains by their amount.
struct MotionLimits {
  double rotation_deg = 5, strain = 0.05;
};
/// The largest of all elements, where they are, and how many elements are beyond the limits.
struct LargestMotion {
  double rotation_deg = 0, strain = 0;
  Vec3i turned{0, 0, 0}, strained{0, 0, 0};  // voxels of the mesh
  std::int64_t beyond = 0;

  /// Takes the larger one of two sets of elements, or of two times; of equal ones the first.
  void take(const LargestMotion& other);
};

}  // namespace supple
