// What a solution says of its elements: displacement of centres, strain and stress.
//
// Strain is the symmetric gradient at the element's centre, which is also the mean gradient; there
// the stresses of a trilinear element are most accurate. Under mean dilatation the pressure of
// single elements may alternate near nu = 1/2 (the checkerboard of Q1-P0), its mean over
// neighbours does not.
//
// At finite strain, with F = R U: stress is Cauchy's at the centre, on the axes of LPS; strain is
// V - 1 (F = V R), whose principal values are stretches less 1; rotation is that of R.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "lib/fem/cell_classes.h"
#include "lib/fem/fem_loads.h"
#include "lib/fem/hex_mesh.h"

namespace supple {

/// xx, yy, zz, xy, yz, zx in LPS; shear as tensor components.
using SymmetricTensor = std::array<double, 6>;
/// Descending.
std::array<double, 3> eigenvalues(const SymmetricTensor& tensor);

struct ElementState {
  SymmetricTensor strain, stress_kpa;
  double volume_strain;       // of the element
  Vec3d rotation_rad;         // half the curl of u, at the centre
  double energy_density_kpa;  // mean of the element, per volume at rest; kPa are mJ/cm^3
};
ElementState element_state(const HexMesh& voxels, const VoxelMaterial& material,
                           const std::vector<double>& u_mm, std::int32_t element,
                           StrainTheory theory = StrainTheory::linear);

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

/// One value per element, in the order of the mesh, which is that of the body's bricks.
std::vector<float> element_values(const HexMesh& voxels, const VoxelMaterial& material,
                                  const std::vector<double>& u_mm, FemQuantity quantity,
                                  StrainTheory theory = StrainTheory::linear);

/// Angles of rotation, and principal strains by their amount.
struct MotionLimits {
  double rotation_deg = 5, strain = 0.05;
};
/// The largest of all elements, where they are, and how many elements are beyond the limits.
struct LargestMotion {
  double rotation_deg = 0, strain = 0;
  Vec3i turned{0, 0, 0}, strained{0, 0, 0};  // voxels of the mesh
  std::int64_t beyond = 0;

  /// Over both sets of elements, or both times; of equal ones the first.
  void take(const LargestMotion& other);
};
LargestMotion largest_motion(const HexMesh& voxels, const VoxelMaterial& material,
                             const std::vector<double>& u_mm,
                             StrainTheory theory = StrainTheory::linear,
                             const MotionLimits& limits = {});

/// Displacement of an element's centre in mm, LPS: the mean of its eight corners.
Vec3d centre_displacement(const HexMesh& voxels, const std::vector<double>& u_mm,
                          std::int32_t element);

}  // namespace supple
