// Stress and strain of the elements, from the displacements of their nodes.
//
//   sigma = 2 mu dev(e) + kappa (tr e) 1     at the middle of the element
//
// where hexahedra of mean dilatation have their superconvergent point (Barlow 1976), with the
// displacement gradient by the eight corners. Energy per volume is the element's own, u.Ku / 2 V.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "lib/fem/fem.h"

namespace supple {

/// Of symmetric tensors: xx, yy, zz, yz, xz, xy, LPS.
using Symmetric6 = std::array<double, 6>;

enum class ElementQuantity {
  von_mises,       // kPa
  principal_max,   // kPa, tension positive
  principal_min,   // kPa
  pressure,        // kPa, compression positive
  energy_density,  // kPa, that is mJ/cm^3
  largest_strain   // largest principal strain by magnitude, with its sign
};
constexpr int kElementQuantities = 6;
const char* name_of(ElementQuantity quantity);
const char* unit_of(ElementQuantity quantity);

/// Elastic constants of all elements of a mesh, by their classes, and its displacements. All of it
/// outlives this.
class ElementStress {
 public:
  ElementStress(const HexMesh& mesh, const std::vector<double>& u_mm,
                const std::vector<std::uint8_t>& classes, const ElasticTable& elastic,
                Dilatation dilatation = Dilatation::mean);

  /// du_a/dx_d, [a][d].
  std::array<Vec3d, 3> gradient(std::int32_t element) const;
  Symmetric6 stress_kpa(std::size_t block, std::int32_t element) const;
  double value(ElementQuantity quantity, std::size_t block, std::int32_t element) const;

 private:
  ElasticModuli moduli(std::size_t block, std::int32_t element) const;
  double energy_density(std::size_t block, std::int32_t element) const;

  const HexMesh& m_mesh;
  const std::vector<double>& m_u_mm;
  const std::vector<std::uint8_t>& m_classes;
  const ElasticTable& m_elastic;
  ElementMatrix m_matrix;
  std::array<Vec3d, 8> m_gradients;  // at the middle
};

/// Ascending. In closed form (Smith, Comm. ACM 4, 168, 1961).
std::array<double, 3> principal_values(const Symmetric6& tensor);
/// sqrt(3/2) of the length of the deviator.
double von_mises(const Symmetric6& tensor);

}  // namespace supple
