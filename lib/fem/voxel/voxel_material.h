// Material of the voxels of a mesh.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/body/body.h"
#include "lib/fem/elastic_law.h"
#include "lib/fem/nodal_loads.h"
#include "lib/fem/voxel/element_matrix.h"

namespace supple {

struct HexMesh;

struct VoxelMaterial {
  ElementMatrix matrix;
  ModuliTable<double> moduli;
  ModuliTable<float> moduli_single;
  std::vector<std::uint8_t> classes;  // per element
};

/// Makes the material of a body's elements. Throws InputError as ElasticTable::validate().
VoxelMaterial voxel_material(const Body& body, const ElasticTable& elastic, Dilatation dilatation);

/// The same elements with the moduli of a sum of stiffness and mass. Throws InputError.
VoxelMaterial weighted_material(const VoxelMaterial& material, const ElementWeights& weights);

/// Returns the contrast of the elements that can move, which are not held as wholes: the largest
/// shear modulus by the smallest, 1 where none can.
double free_contrast(const HexMesh& mesh, const VoxelMaterial& material, const HeldBits& held);

}  // namespace supple
