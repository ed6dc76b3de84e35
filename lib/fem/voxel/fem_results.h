// Results at the voxels of a solution (element_state.h): displacement of centres, strain, stress.
//
// Strain is the symmetric gradient at the element's centre, which is also the mean gradient; there
// the stresses of a trilinear element are most accurate. Under mean dilatation the pressure of
// single elements may alternate near nu = 1/2 (the checkerboard of Q1-P0), its mean over
// neighbours does not.
//
// At finite strain, with F = R U: stress is Cauchy's at the centre, on the axes of LPS; strain is
// V - 1 (F = V R), whose principal values are stretches less 1; rotation is that of R.
//
// Stress is that which neighbours feel: of an element that swells the pressure within is part of it
// (`swelling_kpa`, per element, or empty). Its energy is that of the strain alone.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/fem/element_state.h"
#include "lib/fem/voxel/fem_loads.h"

namespace supple {

ElementState element_state(const HexMesh& voxels, const VoxelMaterial& material,
                           const std::vector<double>& u_mm, std::int32_t element,
                           StrainTheory theory = StrainTheory::linear,
                           const std::vector<double>& swelling_kpa = {});

/// Returns a value per element, in the order of the mesh, which is that of the body's bricks.
std::vector<float> element_values(const HexMesh& voxels, const VoxelMaterial& material,
                                  const std::vector<double>& u_mm, FemQuantity quantity,
                                  StrainTheory theory = StrainTheory::linear,
                                  const std::vector<double>& swelling_kpa = {});

LargestMotion largest_motion(const HexMesh& voxels, const VoxelMaterial& material,
                             const std::vector<double>& u_mm,
                             StrainTheory theory = StrainTheory::linear,
                             const MotionLimits& limits = {});

/// The growth of all elements' volumes; in linear theory the sum of their volume strains, which is
/// the volume that passes through the surface at rest.
double volume_change_mm3(const HexMesh& voxels, const VoxelMaterial& material,
                         const std::vector<double>& u_mm,
                         StrainTheory theory = StrainTheory::linear);

/// Displacement of an element's centre in mm, LPS: the mean of its eight corners.
Vec3d centre_displacement(const HexMesh& voxels, const std::vector<double>& u_mm,
                          std::int32_t element);
Vec3d centre_displacement(const Corners& corners, const std::vector<double>& u_mm);

}  // namespace supple
